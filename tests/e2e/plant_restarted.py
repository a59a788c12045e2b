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
        events = cell.ctl("events").stdout
        check("an event names the device that was lost", '"source":"remote-io-1"' in events, events[-600:])
        faulted = [name for name, state in cell.states().items() if state == "FAULT"]
        refused = cell.ctl("start", faulted[0]).stderr
        for word in ("in FAULT: ST2001", "Cause: ", "Remedy: ", f"stationctl reset {faulted[0]}"):
            check(f'a Start in FAULT is refused with "{word}"', word in refused, refused)
        answer = cell.ctl("reset", "all")
        check("the operator resets all", answer.returncode == 0, answer.stdout + answer.stderr)
        for name in faulted:
            answer = cell.ctl("start", name)
            check(f"the operator starts {name}", answer.returncode == 0, answer.stdout + answer.stderr)
        cell.wait_stored(12)
        cell.end("plantsim")
        cell.check_ledger(12)


run(scenario)
