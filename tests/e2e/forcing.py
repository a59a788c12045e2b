#!/usr/bin/python3
"""Forced inputs and outputs, seen at the device and in the program; writable parameters (IMG-3, IMG-2).

The loader runs against a plant whose coils pymodbus reads. A copy of its configuration makes a parameter
writable.
"""

import json

from cell import ROOT, Cell, check, run, wait_for
from pymodbus.client import ModbusTcpClient

LOADER = 1
OUTPUT = "read_code"  # off until a pallet is in position
NO_STATION, REFUSED, USAGE = 3, 1, 64


class Field:
    """One coil of the loader as the device has it."""

    def __init__(self, port, coil):
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=3)
        self.client.connect()
        self.coil = coil

    def on(self):
        return bool(self.client.read_coils(self.coil, count=1, slave=LOADER).bits[0])


def configuration(cell):
    """controller1's, with step_timeout writable between 2 s and 1 min."""
    text = (ROOT / "config" / "controller1.toml").read_text(encoding="utf-8")
    limits = 'step_timeout = { value = "10s", min = "2s", max = "1min", writable = true }'
    lines = [line for line in text.splitlines() if not line.startswith("step_timeout")]
    at = next(i for i, line in enumerate(lines) if line.strip() == "[station.outputs]")
    lines[at:at] = ["[station.parameters]", limits]
    file = cell.work / "controller1.toml"
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def tag(cell, name):
    answer = cell.ctl("get", "loader", name)
    check(f"get loader {name} is answered", answer.returncode == 0, answer.stderr)
    (row,) = json.loads(answer.stdout)["tags"]
    return row


def forced(cell):
    return cell.stations()["loader"]["forced"]


def order(cell, *words):
    answer = cell.ctl(*words)
    check(" ".join(words), answer.returncode == 0, answer.stdout + answer.stderr)


def output_when_stopped(cell, field):
    order(cell, "force", "loader", OUTPUT, "on")
    wait_for("Status tells of the force", lambda: forced(cell) == 1)
    before = cell.stations()["loader"]["scans"]
    wait_for("100 scans pass in STOPPED", lambda: cell.stations()["loader"]["scans"] > before + 100)
    check("the forced output is not driven in STOPPED", not field.on())
    row = tag(cell, OUTPUT)
    check("told as forced, with its safe value", (row["value"], row["forced"]) == ("false", "true"), row)


def output_when_running(cell, field):
    order(cell, "start", "loader")
    wait_for("in RUNNING the device has the forced value", field.on)
    wait_for("its quality is FORCED", lambda: tag(cell, OUTPUT)["quality"] == "FORCED")
    order(cell, "force", "loader", OUTPUT, "false")
    wait_for("forced to the other value", lambda: not field.on())
    order(cell, "force", "loader", OUTPUT, "1")
    wait_for("and back", field.on)
    order(cell, "stop", "loader")
    wait_for("Stop makes it safe although it is forced", lambda: not field.on())
    check("the force still stands", forced(cell) == 1)
    order(cell, "start", "loader")
    wait_for("it is driven again after Start", field.on)


def input_seen(cell):
    order(cell, "stop", "loader")
    name = "pallet_at_entry"
    true_value = tag(cell, name)["value"]
    wanted = "false" if true_value == "true" else "true"
    order(cell, "force", "loader", name, wanted)
    row = wait_for("the input is FORCED", lambda: (r := tag(cell, name))["quality"] == "FORCED" and r)
    check("it has the forced value", row["value"] == wanted, row)
    order(cell, "unforce", "loader", name)
    wait_for("let go it is its source's again", lambda: tag(cell, name)["quality"] == "GOOD")


def fault_by_force(cell):
    """The program sees what is forced: both end switches of the clamp at once are a fault."""
    order(cell, "unforce", "loader", "all")
    for switch in ("clamp_is_closed", "clamp_is_open"):
        order(cell, "force", "loader", switch, "true")
    order(cell, "start", "loader")
    wait_for("the program sees the forced inputs", lambda: cell.states()["loader"] == "FAULT")
    order(cell, "unforce", "loader", "all")
    order(cell, "reset", "loader")


def parameter(cell):
    order(cell, "set", "loader", "step_timeout", "20s")
    check("the parameter is set", tag(cell, "step_timeout")["value"] == "20s")
    answer = cell.ctl("set", "loader", "step_timeout", "2min")
    check("out of its range it is refused", answer.returncode == REFUSED and "2s..1min" in answer.stderr)
    answer = cell.ctl("set", "loader", "arrival_timeout", "20s")
    check("one not declared writable is refused", answer.returncode == REFUSED and "ST1314" in answer.stderr)
    answer = cell.ctl("force", "loader", "raed_code", "1")
    check("a misspelt tag is answered with the right one", 'mean "read_code"' in answer.stderr, answer.stderr)
    check("usage", cell.ctl("force", "loader", OUTPUT).returncode == USAGE)


def said(cell):
    log = cell.log("controller1")
    for line in (f"tag {OUTPUT} forced to true, from=stationctl-", f"tag {OUTPUT} unforced, from="):
        check(f"the log says: {line}", f"loader: {line}" in log)
    check("the log says: set", "loader: tag step_timeout set to 20s (was 10s), from=" in log)
    events = cell.ctl("events").stdout
    for text in (f"tag forced: {OUTPUT}", f"tag unforced: {OUTPUT}", "tag set: step_timeout"):
        check(f"an event says: {text}", text in events)


def gone_at_restart(cell, file, field):
    order(cell, "force", "loader", OUTPUT, "on")
    order(cell, "start", "loader")
    wait_for("forced before kill -9", field.on)
    cell.kill("controller1")
    cell.start_controller("controller1", file)
    wait_for("no force outlives the daemon", lambda: forced(cell) == 0)
    check("nor does a set parameter", tag(cell, "step_timeout")["value"] == "10s")
    wait_for("the output is safe", lambda: not field.on())
    check("nobody there: status 3", cell.ctl("force", "lader", OUTPUT, "1").returncode == NO_STATION)


def scenario():
    with Cell(period="50ms", speed=0.1) as cell:
        cell.start_plant("--watchdog", "600s")
        file = configuration(cell)
        cell.start_controller("controller1", file)
        field = Field(cell.port, coil_of(file, OUTPUT))
        output_when_stopped(cell, field)
        output_when_running(cell, field)
        input_seen(cell)
        fault_by_force(cell)
        parameter(cell)
        said(cell)
        gone_at_restart(cell, file, field)


def coil_of(file, name):
    """The first station's: its mappings come first."""
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.split("=")[0].strip() == name and ":co:" in line:
            return int(line.split(":co:")[1].split('"')[0])
    raise AssertionError(f"no coil {name}")


run(scenario)
