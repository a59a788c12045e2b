#!/usr/bin/env python3
"""scripts/demo as a user runs it: pieces counted and judged; in process; at 1 ms; interrupted; nothing left
behind."""

import os
import pathlib
import re
import signal
import subprocess
import tempfile

from cell import BIN, ROOT, check, run, wait_for


def demo(folder, *arguments):
    environment = dict(os.environ, TMPDIR=str(folder))
    return subprocess.Popen(
        [ROOT / "scripts" / "demo", "--bin", BIN, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=environment,
        stdin=subprocess.DEVNULL,
    )


def left_in(folder):
    return [p.name for p in pathlib.Path(folder).iterdir() if "stationd" in p.name]


def pieces(folder, name, *arguments):
    process = demo(folder, *arguments)
    said, _ = process.communicate(timeout=300)
    check(f"{name} ends with status 0", process.returncode == 0, said[-1500:] if process.returncode else "")
    check(f"{name} leaves no file", left_in(folder) == [])


def without_rights(folder):
    """Real-time rights are refused by the kernel: the demo says so and goes on."""
    drop = ["setpriv", "--bounding-set=-sys_nice,-ipc_lock,-sys_resource", "--inh-caps=-sys_nice,-ipc_lock"]
    command = [*drop, ROOT / "scripts" / "demo", "--bin", BIN, "--pieces", "2", "--speed", "3"]
    environment = dict(os.environ, TMPDIR=str(folder))
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment, check=False)
    check("the demo without real-time rights ends with status 0", done.returncode == 0, done.stdout[-900:])
    check("it says that it has none", "without real-time rights" in done.stdout)
    section = re.search(r'README.md says under "(.+?)"', done.stdout)
    headings = (ROOT / "README.md").read_text().splitlines()
    check("it names a section that the README has", section and f"## {section[1]}" in headings, section)


def interrupted(folder):
    process = demo(folder, "--speed", "3")
    lines = []
    wait_for(
        "the cell runs",
        lambda: lines.append(process.stdout.readline())
        or "supervisor" in lines[-1].lower()
        or "RUNNING" in lines[-1],
    )
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    check("Ctrl-C ends it with status 0 or 130", process.returncode in (0, 130), process.returncode)
    check("an interrupted demo leaves no file", left_in(folder) == [])


def child_of(parent, word):
    """The process that `parent` started with `word` in its command line."""
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            mine = int((entry / "stat").read_text().rpartition(")")[2].split()[1]) == parent
            if mine and word in (entry / "cmdline").read_text():
                return int(entry.name)
        except OSError:
            continue
    return None


def bereft(folder):
    """A controller is killed while the demo runs: the demo says so in its own words at the end (SYS-7)."""
    process = demo(folder, "--speed", "3")
    lines = []
    wait_for("storage runs", lambda: lines.append(process.stdout.readline()) or "RUNNING" in lines[-1])
    os.kill(child_of(process.pid, "controller2.toml"), signal.SIGKILL)
    wait_for("its stations are away", lambda: lines.append(process.stdout.readline()) or "away" in lines[-1])
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    check("it names the controller that had ended", "controller2 had ended before" in said, said[-900:])
    check("the shell says nothing of its own", "Killed" not in "".join(lines) + said, said[-900:])
    check("the demo without a controller leaves no file", left_in(folder) == [])


def scenario():
    with tempfile.TemporaryDirectory() as folder:
        pieces(folder, "the demo with 5 pieces", "--pieces", "5", "--speed", "3")
        pieces(folder, "the demo in process", "--pieces", "5", "--speed", "3", "--in-process")
        pieces(folder, "the demo at 1 ms", "--pieces", "5", "--speed", "3", "--period", "1ms")
        without_rights(folder)
        interrupted(folder)
        bereft(folder)


run(scenario)
