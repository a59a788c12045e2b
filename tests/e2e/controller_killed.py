#!/usr/bin/env python3
"""Controller 2 is killed (kill -9) in mid-piece and started again: the cell goes on, the ledger is right
(IMG-5)."""

from cell import Cell, check, run, wait_for


def scenario():
    with Cell(pallets=20) as cell:
        cell.start_all()
        cell.wait_stored(3)
        for kill in range(3):
            wait_for(
                "the sealer is in mid-piece", lambda: cell.stations().get("sealer", {}).get("piece", 0) != 0
            )
            epoch = cell.station("sealer")["epoch"]
            cell.kill("controller2")
            wait_for(
                "the list has the stations that are gone",
                lambda: {row["station"] for row in cell.listed("missing")} == {"sealer", "storage"},
            )
            cell.start_controller("controller2")
            wait_for(
                f"the sealer runs again after kill {kill + 1}",
                lambda: cell.states().get("sealer") == "RUNNING",
            )
            check("its epoch is one more", cell.station("sealer")["epoch"] == epoch + 1)
            cell.wait_stored(6 + 3 * kill)
        cell.wait_stored(20)
        cell.end("plantsim")
        cell.check_ledger(20)


run(scenario)
