#!/usr/bin/env python3
"""The disk is full while controller 2 retains its tags: it goes on, says so once, and recovers (IMG-4).

A limit on file sizes stands for the full disk: it needs no rights and strikes this one process. The log goes
through a pipe, or it would be cut off as well.
"""

import resource
import subprocess

from cell import BIN, ROOT, Cell, check, run, wait_for

FULL = "retained tags are not written: "
STATIONS = ("sealer", "storage")


def start_behind_pipe(cell, name):
    with open(cell.work / f"{name}.log", "a", encoding="utf-8") as log:
        pipe = subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=log)
    state = cell.work / name
    state.mkdir()
    daemon = subprocess.Popen(
        [BIN / "stationd", ROOT / "config" / f"{name}.toml"],
        stderr=pipe.stdin,
        stdin=subprocess.DEVNULL,
        env=dict(cell.environment, STATE_DIRECTORY=str(state)),
        cwd=ROOT,
    )
    pipe.stdin.close()  # cat ends with the daemon
    cell.processes[name] = daemon
    wait_for(f"{name} is ready", lambda: "ready:" in cell.log(name), alive=[daemon])
    return daemon, pipe


def said(cell, text):
    return {s: cell.log("controller2").count(f"station {s}: {text}") for s in STATIONS}


def full(cell, daemon):
    soft, hard = resource.prlimit(daemon.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(daemon.pid, resource.RLIMIT_FSIZE, (16, hard))
    wait_for("a full disk is in the log", lambda: sum(said(cell, FULL).values()))
    before = cell.station("storage")["scans"]
    wait_for("500 scans pass on a full disk", lambda: cell.station("storage")["scans"] > before + 500)
    check("it is said once for each station that it concerns", max(said(cell, FULL).values()) == 1)
    check("the reason is named", FULL + str(cell.work) in cell.log("controller2"))
    check("the daemon lives", daemon.poll() is None)
    concerned = [s for s, count in said(cell, FULL).items() if count]
    resource.prlimit(daemon.pid, resource.RLIMIT_FSIZE, (soft, hard))
    for station in concerned:
        again = "retained tags are written again"
        wait_for(f"{station} writes again and says so", lambda s=station: said(cell, again)[s] == 1)


def go_on(cell):
    """A program that waited too long for its record has stopped with that fault: the operator resets it."""
    for station, state in cell.states().items():
        if state == "FAULT":
            check(f"{station} is reset", cell.ctl("reset", station).returncode == 0)
            check(f"{station} is started", cell.ctl("start", station).returncode == 0)
    wait_for("all stations run", lambda: set(cell.states().values()) == {"RUNNING"})


def scenario():
    with Cell(pallets=10) as cell:
        cell.start_plant()
        cell.start_controller("controller1")
        daemon, pipe = start_behind_pipe(cell, "controller2")
        cell.start_supervisor()
        cell.wait_stored(2)
        full(cell, daemon)
        go_on(cell)
        cell.wait_stored(10)
        check("controller 2 ends with status 0", cell.end("controller2") == 0)
        pipe.wait(20)
        cell.end("plantsim")
        cell.check_ledger(10)


run(scenario)
