#!/usr/bin/python3
"""Real-time rights are refused by the kernel: fatal with require_realtime, told without it (SCAN-8)."""

import os
import subprocess

from cell import BIN, ROOT, Cell, check, run, wait_for
from field import Field

NO_RIGHTS = ["prlimit", "--rtprio=0:0", "--memlock=65536:65536"]
if os.geteuid() == 0:  # root has the rights whatever the limits say: take its capabilities, too
    NO_RIGHTS = ["setpriv", "--bounding-set=-all", "--inh-caps=-all", *NO_RIGHTS]


def required(cell, field):
    text = (ROOT / "config" / "controller1.toml").read_text()
    file = cell.work / "required.toml"
    file.write_text(text.replace("[controller]\n", "[controller]\nrequire_realtime = true\n", 1))
    field.set_all()
    environment = dict(cell.environment, STATE_DIRECTORY=str(cell.work))
    ended = subprocess.run(
        [*NO_RIGHTS, BIN / "stationd", file],
        capture_output=True,
        text=True,
        timeout=120,
        env=environment,
        cwd=ROOT,
        check=False,
    )
    check("stationd ends with status 77", ended.returncode == 77, f"{ended.returncode} {ended.stderr[-500:]}")
    lines = [line for line in ended.stderr.splitlines() if "require_realtime is set and" in line]
    check("one line says which right was refused", len(lines) == 1 and "refused: " in lines[0], lines)
    check("it never was ready", "ready:" not in ended.stderr)
    check("no device was touched", field.others() == 7, field.coils())


def not_required(cell):
    cell.start("controller1", *NO_RIGHTS, BIN / "stationd", ROOT / "config" / "controller1.toml", state="c1")
    wait_for("without it the daemon is ready", lambda: "ready:" in cell.log("controller1"))
    log = cell.log("controller1")
    for what in ("SCHED_FIFO", "running without all real-time rights"):
        check(f'the log says "{what}"', what in log, "" if what in log else log)
    wait_for("it scans", lambda: cell.stations().get("loader", {}).get("scans", 0) > 100)
    check("and ends with status 0", cell.end("controller1") == 0)


def scenario():
    with Cell() as cell:
        cell.start_plant("--watchdog", "600s")
        required(cell, Field(cell.port))
        not_required(cell)


run(scenario)
