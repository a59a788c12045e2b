#!/usr/bin/env python3
"""The supervisor is killed (kill -9) and started again: stations go on without it; it respects an operator's
Stop."""

from cell import Cell, check, run, wait_for


def scenario():
    with Cell(pallets=12) as cell:
        cell.start_all()
        cell.wait_stored(2)
        cell.kill("supervisor")
        cell.wait_stored(4)
        check("robot is stopped by an operator", cell.ctl("stop", "robot").returncode == 0)
        cell.start_supervisor()
        before = cell.station("sealer")["scans"]
        wait_for("500 scans pass", lambda: cell.station("sealer")["scans"] > before + 500)
        check("the supervisor does not start what an operator stopped", cell.states()["robot"] == "STOPPED")
        check("the operator starts it again", cell.ctl("start", "robot").returncode == 0)
        cell.wait_stored(12)
        cell.end("plantsim")
        cell.check_ledger(12)


run(scenario)
