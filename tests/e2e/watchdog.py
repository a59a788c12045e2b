#!/usr/bin/python3
"""Programs that do not return from their scan, on every CPU at the highest priority (SCAN-9).

Their outputs go safe at the device, the machine lives, the other stations go on.
"""

import os
import re
import socket

from cell import BIN, Cell, check, run, wait_for
from pymodbus.client import ModbusTcpClient

CPUS = sorted(os.sched_getaffinity(0))[:3]
STEADY = len(CPUS) + 1  # its unit

HEAD = """
[controller]
name = "stuck"
restart_on_stuck = RESTART
[bus]
domain = "${STATIOND_DOMAIN:-0}"
"""
DEVICE = """
[[device]]
name = "io-UNIT"
address = "${STATIOND_PLANT}"
unit = UNIT
period = "10ms"
heartbeat = { register = 1, period = "100ms" }
"""
TASK = """
[[task]]
name = "NAME"
period = "10ms"
priority = PRIORITY
watchdog = "200ms"
PIN
[[station]]
name = "NAME"
task = "NAME"
program = "PROGRAM"
[station.outputs]
lamp = "io-UNIT:co:0"
"""


def filled(text, **values):
    for key, value in values.items():
        text = text.replace(key, str(value))
    return text


def configuration(restart):
    text = filled(HEAD, RESTART=restart)
    for unit in range(1, STEADY + 1):
        text += filled(DEVICE, UNIT=unit)
    for unit, cpu in enumerate(CPUS, 1):
        text += filled(TASK, NAME=f"loop{unit}", PRIORITY=95, PIN=f"cpu = {cpu}", PROGRAM="looper", UNIT=unit)
    return text + filled(TASK, NAME="steady", PRIORITY=50, PIN="", PROGRAM="steady", UNIT=STEADY)


class Field:
    def __init__(self, port):
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=5)
        self.client.connect()

    def lamp(self, unit):
        return int(self.client.read_coils(0, count=1, slave=unit).bits[0])

    def loops(self):
        return [self.lamp(unit) for unit, _ in enumerate(CPUS, 1)]


class Manager:
    """The service manager's end of the notify socket."""

    def __init__(self, cell):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(cell.work / "notify"))
        self.socket.setblocking(False)
        cell.environment.update(NOTIFY_SOCKET=str(cell.work / "notify"), WATCHDOG_USEC="1000000")

    def fed(self):
        count = 0
        try:
            while True:
                count += self.socket.recv(4096).count(b"WATCHDOG=1")
        except BlockingIOError:
            return count


def start(cell, restart):
    file = cell.work / "stuck.toml"
    file.write_text(configuration(restart))
    process = cell.start("stuck", BIN / "watchdog_stations", file, state="stuck")
    wait_for("the daemon is ready", lambda: "ready:" in cell.log("stuck"), alive=[process])
    return process


def scheduling(process, name):
    """(policy, nice) of the thread of that name."""
    for task in os.listdir(f"/proc/{process.pid}/task"):
        with open(f"/proc/{process.pid}/task/{task}/comm", encoding="ascii") as file:
            if file.read().strip() == name:
                tid = int(task)
                return os.sched_getscheduler(tid), os.getpriority(os.PRIO_PROCESS, tid)
    return None


def row(cell, name):
    return cell.stations().get(name, {})


def soon(cell, scans):
    """at_scan=N, that many scans ahead."""
    return f"at_scan={row(cell, 'steady')['scans'] + scans}"


def hang(cell, field, process):
    """All loopers in the same scan, for ever."""
    check("steady starts", cell.ctl("start", "steady").returncode == 0)
    at_scan = soon(cell, 500)
    for unit, _ in enumerate(CPUS, 1):
        check(f"loop{unit} starts, {at_scan}", cell.ctl("start", f"loop{unit}", at_scan).returncode == 0)
    wait_for("all lamps are on", lambda: field.loops() == [1] * len(CPUS) and field.lamp(STEADY) == 1)
    wait_for("lamps of programs that hang go off at the device", lambda: field.loops() == [0] * len(CPUS))
    wait_for(
        "each is in FAULT ST1205 for who asks",
        lambda: all(
            row(cell, f"loop{unit}").get("state") == "FAULT" and "1205" in str(row(cell, f"loop{unit}"))
            for unit, _ in enumerate(CPUS, 1)
        ),
    )
    normal = (os.SCHED_OTHER, 19)
    check("the threads have lost their real-time rights", scheduling(process, "scan-loop1") == normal)
    check("steady has kept its own", scheduling(process, "scan-steady")[0] == os.SCHED_FIFO)
    scans = row(cell, "steady")["scans"]
    wait_for("steady goes on", lambda: row(cell, "steady")["scans"] > scans + 100)
    check("its lamp is on", field.lamp(STEADY) == 1)
    check("nothing that hangs is driven", field.loops() == [0] * len(CPUS), field.loops())
    wait_for("the log names the program", lambda: "of station loop1 does not return" in cell.log("stuck"))
    for idle in re.findall(r"no progress for (\d+) ms", cell.log("stuck")):
        check("the watchdog judged by its limit of 200 ms", 200 <= int(idle) <= 260, idle)
    events = cell.ctl("events", timeout="5s").stdout
    check("the events tell of it", "1205" in events and "loop1" in events, events[-300:])


def for_ever(cell):
    manager = Manager(cell)
    process = start(cell, "false")
    field = Field(cell.port)
    hang(cell, field, process)
    manager.fed()
    wait_for("the service manager's watchdog is fed all the same", lambda: manager.fed() >= 1)
    check("SIGTERM ends the daemon with status 1: threads do not end", cell.end("stuck") == 1)
    check("nothing is driven", field.loops() + [field.lamp(STEADY)] == [0] * STEADY)


def for_a_while(cell):
    """A program that returns late: FAULT, rights given back, reset and Start."""
    process = start(cell, "true")
    field = Field(cell.port)
    check("loop1 starts", cell.ctl("start", "loop1", soon(cell, 200), "rounds=1000").returncode == 0)
    wait_for("it hangs", lambda: "no progress for" in cell.log("stuck"))
    wait_for("it moves again", lambda: "task loop1: moves again" in cell.log("stuck"))
    wait_for("it is in FAULT", lambda: row(cell, "loop1").get("state") == "FAULT")
    check("real-time rights are back", scheduling(process, "scan-loop1") == (os.SCHED_FIFO, 0))
    check("its lamp is off", field.lamp(1) == 0)
    check("reset is obeyed", cell.ctl("reset", "loop1").returncode == 0)
    check("Start is obeyed", cell.ctl("start", "loop1", "at_scan=0").returncode == 0)
    wait_for("its lamp is on again", lambda: field.lamp(1) == 1)
    check("the daemon ends with status 0", cell.end("stuck") == 0)


def restart_on_stuck(cell):
    process = start(cell, "true")
    manager = Manager(cell)
    cell.end("stuck")
    process = start(cell, "true")
    wait_for("the service manager's watchdog is fed", lambda: manager.fed() >= 1, alive=[process])
    check("loop1 starts", cell.ctl("start", "loop1", soon(cell, 200)).returncode == 0)
    wait_for("it hangs", lambda: cell.log("stuck").count("no progress for") > 0)
    manager.fed()
    scans = row(cell, "steady")["scans"]
    wait_for("300 scans of steady pass", lambda: row(cell, "steady")["scans"] > scans + 300)
    check("with restart_on_stuck it is not fed any more", manager.fed() == 0)
    check("SIGTERM ends the daemon with status 1", cell.end("stuck") == 1)


def scenario():
    with Cell(speed=0.1) as cell:
        cell.start_plant("--watchdog", "600s")
        for_a_while(cell)
        (cell.work / "stuck.log").unlink()
        restart_on_stuck(cell)
        (cell.work / "stuck.log").unlink()
        (cell.work / "notify").unlink()
        for_ever(cell)


run(scenario)
