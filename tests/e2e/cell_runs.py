#!/usr/bin/env python3
"""Twenty pieces over Modbus and DDS, then an orderly end: every piece once, with its right parts."""

from cell import Cell, check, run, wait_for


def scenario():
    with Cell(pallets=20) as cell:
        cell.start_all()
        wait_for("all four stations run", lambda: list(cell.states().values()).count("RUNNING") == 4)
        cell.wait_stored(20)
        rows = cell.stations()
        check(
            "both controllers are named",
            {r["controller"] for r in rows.values()} == {"controller1", "controller2"},
        )
        stopped = cell.ctl("stop", "all")
        check("stationctl stop all succeeds", stopped.returncode == 0, stopped.stderr)
        check("no station runs", set(cell.states().values()) == {"STOPPED"}, cell.states())
        for name in ("supervisor", "controller1", "controller2", "plantsim"):
            check(f"{name} ends with status 0", cell.end(name) == 0)
        cell.check_ledger(20)


run(scenario)
