#!/usr/bin/env python3
"""A peer on Cyclone DDS, made from the paper's literal Table 4, joins the cell (PV-5, ASE-4, REQ-1)."""

import subprocess

from cell import BIN, DOMAIN, Cell, check, run, wait_for


def peer(*arguments):
    command = [BIN / "cyclone_peer", DOMAIN, "assembly", *map(str, arguments)]
    uri = (
        "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces>"
        "<AllowMulticast>true</AllowMulticast></General></Domain></CycloneDDS>"
    )
    return subprocess.Popen(
        list(map(str, command)),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={"CYCLONEDDS_URI": uri, "CYCLONE_PEER_MATCHES": "3", "PATH": "/usr/bin:/bin"},
    )


def finish(name, process):
    said, _ = process.communicate(timeout=60)
    check(name, process.returncode == 0, said.strip()[-400:])
    return said


def receives(cell):
    listener = peer("listen", 2)
    check("plantsim ends with status 0", cell.end("plantsim") == 0)
    wait_for("stations fault for want of their inputs", lambda: "FAULT" in cell.states().values())
    said = finish("the peer receives Set, End and GSE", listener)
    for topic in ("Set", "End", "GSE"):
        check(f"the peer printed {topic}", topic in said)
    check("the lost device is among the events", "1101" in said)


def commands(cell):
    finish("the peer sends Stop", peer("order", "Stop", "robot", "mode=immediate"))
    wait_for("the robot obeys Stop", lambda: cell.states().get("robot") == "STOPPED")
    finish("the peer sends Start", peer("order", "Start", "robot", ""))
    wait_for("the robot obeys Start", lambda: cell.states().get("robot") == "RUNNING")
    said = finish("the peer is answered", peer("order", "Msg", "robot", "status"))
    check("the answer carries its id and the state", "id=77" in said and "RUNNING" in said, said.strip())


def is_understood(cell):
    cell.end("controller1")
    speaker = peer("say", "robot", 102, 20)

    def tag(name):
        answer = cell.ctl("msg", "sealer", "get", name)
        return answer.stdout if answer.returncode == 0 else ""

    wait_for("the sealer has the peer's Set as its input", lambda: "102" in tag("ready.CODE"))
    wait_for("the sealer has the peer's End as its input", lambda: "102" in tag("begin.CODE"))
    speaker.terminate()
    speaker.wait(30)


def scenario():
    with Cell() as cell:
        cell.start_all()
        wait_for("all four stations run", lambda: list(cell.states().values()).count("RUNNING") == 4)
        commands(cell)
        receives(cell)
        is_understood(cell)


run(scenario)
