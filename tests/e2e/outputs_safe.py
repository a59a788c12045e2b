#!/usr/bin/python3
"""Outputs at the device, read by pymodbus: safe before Start, at Stop, at exit and after kill -9 (IO-6).

A gripper's safe value is `hold`: it keeps what the device has.
"""

import signal
import subprocess

from cell import BIN, ROOT, Cell, check, run, wait_for
from field import GRIPPER, Field
from out_of_reach import BlackHole


def before_start(cell, field):
    field.set_all()
    check("all coils were driven by somebody else", field.others() == 7)
    cell.start_controller("controller1")
    wait_for("the daemon makes them safe before the first Start", lambda: field.others() == 0)
    check("the gripper holds", field.coils()[GRIPPER] == 1)
    before = cell.station("loader")["scans"]
    wait_for("100 scans pass in STOPPED", lambda: cell.station("loader")["scans"] > before + 100)
    check("nothing is driven in STOPPED", field.others() == 0, field.coils())


def run_until_driven(cell, field, name):
    check(f"Start before {name}", cell.ctl("start", "loader").returncode == 0)
    wait_for(f"the station drives its outputs before {name}", lambda: field.others() > 0)


def after_kill(cell, field):
    run_until_driven(cell, field, "kill -9")
    cell.kill("controller1")
    check("after kill -9 the outputs stand as they were", field.others() > 0, field.coils())
    command = [BIN / "stationd", "--write-safe", ROOT / "config" / "controller1.toml"]
    written = subprocess.run(
        command, capture_output=True, text=True, timeout=60, env=cell.environment, cwd=ROOT, check=False
    )
    check("stationd --write-safe ends with status 0", written.returncode == 0, written.stderr)
    check("and the outputs are safe", field.others() == 0, field.coils())


def while_lost(cell, field):
    """SIGTERM comes while the connection is lost and its next attempt is a while off: one is made at once."""
    cell.start_controller("controller1")
    run_until_driven(cell, field, "the device stops answering")
    plant = cell.processes["plantsim"]
    plant.send_signal(signal.SIGSTOP)
    before = len(cell.log("controller1"))
    wait_for(
        "the station is in FAULT, its device out of reach",
        lambda: cell.states().get("loader") == "FAULT" and "remote-io-1" in cell.log("controller1")[before:],
    )
    scans = cell.station("loader")["scans"]  # 10 ms each: the back-off has grown to seconds
    wait_for("400 scans pass", lambda: cell.station("loader")["scans"] > scans + 400)
    plant.send_signal(signal.SIGCONT)
    check("the daemon ends with status 0", cell.end("controller1") == 0)
    check("the device is safe all the same", field.others() == 0, field.coils())


def beside_dead_ones(cell, field):
    """--write-safe reaches the living device while it still tries the dead ones before it."""
    dead = BlackHole()
    device = '[[device]]\nname = "dead-{}"\naddress = "127.0.0.1:{}"\nunit = {}\ntimeout = "10s"\n\n'
    text = (ROOT / "config" / "controller1.toml").read_text()
    file = cell.work / "dead.toml"
    devices = "".join(device.format(i, dead.port, i) for i in range(1, 6))
    file.write_text(text.replace("[[device]]", devices + "[[device]]", 1))
    field.set_all()
    process = cell.start("write-safe", BIN / "stationd", "--write-safe", file)
    wait_for("the living device is safe", lambda: field.others() == 0)
    check("while the dead ones are still being tried", process.poll() is None)
    check("whose failure is the exit status", cell.processes.pop("write-safe").wait(60) == 1)
    check("each of them is named", cell.log("write-safe").count("NOT written: no connection") == 5)


def scenario():
    with Cell(speed=0.1) as cell:
        cell.start_plant("--watchdog", "600s")
        field = Field(cell.port)
        before_start(cell, field)
        run_until_driven(cell, field, "Stop")
        check("Stop succeeds", cell.ctl("stop", "loader").returncode == 0)
        wait_for("Stop makes them safe", lambda: field.others() == 0)
        run_until_driven(cell, field, "SIGTERM")
        check("the daemon ends with status 0", cell.end("controller1") == 0)
        check("its outputs are safe when it has ended", field.others() == 0, field.coils())
        cell.start_controller("controller1")
        after_kill(cell, field)
        while_lost(cell, field)
        beside_dead_ones(cell, field)


run(scenario)
