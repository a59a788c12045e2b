#!/usr/bin/python3
"""Outputs at the device, read by pymodbus: safe before Start, at Stop, at exit and after kill -9 (IO-6).

A gripper's safe value is `hold`: it keeps what the device has.
"""

import subprocess

from cell import BIN, ROOT, Cell, check, run, wait_for
from pymodbus.client import ModbusTcpClient

GRIPPER = 7
LOADER = 1


class Field:
    """The loader's coils as the device has them."""

    def __init__(self, port):
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=3)
        self.client.connect()

    def coils(self):
        return [int(bit) for bit in self.client.read_coils(0, count=8, slave=LOADER).bits[:8]]

    def set_all(self):
        self.client.write_coils(0, [True] * 8, slave=LOADER)

    def others(self):
        return sum(self.coils()[:GRIPPER])


def before_start(cell, field):
    field.set_all()
    check("all coils were driven by somebody else", field.others() == 7)
    cell.start_controller("controller1")
    wait_for("the daemon makes them safe before the first Start", lambda: field.others() == 0)
    check("the gripper holds", field.coils()[GRIPPER] == 1)
    before = cell.stations()["loader"]["scans"]
    wait_for("100 scans pass in STOPPED", lambda: cell.stations()["loader"]["scans"] > before + 100)
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


run(scenario)
