#!/usr/bin/env python3
"""The cell in one daemon at 1 ms: pieces, Stop in mid-piece, questions, refused orders.

Under RealtimeSanitizer (preset rtsan) the same shows that no scan makes a call that may block (SCAN-5).
"""

from cell import ROOT, Cell, check, run, wait_for

PIECES = 6
STATIONS = ("loader", "robot", "sealer", "storage")


def running(cell):
    states = cell.states()
    return len(states) == 4 and set(states.values()) == {"RUNNING"}


def disturb(cell):
    """Each order that a scan carries out, and some that it refuses."""
    check("a Stop in mid-piece is obeyed", cell.ctl("stop", "robot").returncode == 0)
    check("reset of a station without a fault is refused", cell.ctl("reset", "robot").returncode != 0)
    check("an unknown key is refused", cell.ctl("start", "robot", "no_such_key=1").returncode != 0)
    for _ in range(20):
        cell.ctl("msg", "robot", "status")
    check("Start is obeyed", cell.ctl("start", "robot").returncode == 0)
    wait_for("all stations run again", lambda: running(cell), alive=list(cell.processes.values()))


def scenario():
    with Cell(period="1ms", speed=5.0) as cell:
        cell.start_controller("cell", ROOT / "config" / "cell-in-process.toml")
        cell.start_supervisor()
        wait_for("all stations run", lambda: running(cell), alive=list(cell.processes.values()))
        cell.wait_stored(2)
        disturb(cell)
        cell.wait_stored(PIECES)
        check("the supervisor ends with status 0", cell.end("supervisor") == 0)
        check("the daemon ends with status 0", cell.end("cell") == 0)
        cell.check_ledger(PIECES)
        check("RealtimeSanitizer is silent", "RealtimeSanitizer" not in cell.log("cell"))


run(scenario)
