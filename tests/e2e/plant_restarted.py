#!/usr/bin/env python3
"""The plant's Modbus server is stopped and started again: inputs turn BAD, the cell goes on, the ledger is
right."""

from cell import Cell, check, run, wait_for


def scenario():
    with Cell(pallets=12) as cell:
        cell.start_all()
        cell.wait_stored(3)
        check("plantsim ends with status 0", cell.end("plantsim") == 0)
        wait_for("the loss of the device is in the log", lambda: "lost" in cell.log("controller1"))
        wait_for(
            "a station's FAULT is in the log, with its code",
            lambda: "-> FAULT, ST" in cell.log("controller1"),
        )
        cell.start_plant()
        wait_for("controller 1 has its devices back", lambda: "back after" in cell.log("controller1"))
        wait_for("controller 2 has its devices back", lambda: "back after" in cell.log("controller2"))
        for name, state in cell.states().items():
            if state != "FAULT":
                continue
            answer = cell.ctl("reset", name)
            check(f"the operator resets {name}", answer.returncode == 0, answer.stdout + answer.stderr)
            answer = cell.ctl("start", name)
            check(f"the operator starts {name}", answer.returncode == 0, answer.stdout + answer.stderr)
        cell.wait_stored(12)
        cell.end("plantsim")
        cell.check_ledger(12)


run(scenario)
