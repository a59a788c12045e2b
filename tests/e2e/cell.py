"""The cell as real processes, for end-to-end scenarios: plantsim, two controllers, supervisor, stationctl.

Each scenario is a short script: parameters, run, named checks. Everything waits for conditions; nothing
sleeps
for a result. Programs come from $STATIOND_BUILD/bin, the DDS domain from $STATIOND_TEST_DOMAIN.
"""

import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("STATIOND_BUILD", ROOT / "build" / "release")) / "bin"
DOMAIN = os.environ.get("STATIOND_TEST_DOMAIN") or str(os.getpid() % 99 + 1)
GENEROUS = 120.0  # seconds; a limit for conditions, not a measurement


class Failed(AssertionError):
    """A named check that did not hold."""


def check(name, condition, seen=""):
    print(f"{'ok  ' if condition else 'FAIL'} {name}" + (f": {seen}" if seen != "" else ""), flush=True)
    if not condition:
        raise Failed(name)


def wait_for(name, condition, limit=GENEROUS, alive=(), quiet=False):
    """Polls until condition() is truthy; returns its value."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        value = condition()
        if value:
            if not quiet:
                print(f"ok   {name}", flush=True)
            return value
        for process in alive:
            if process.poll() is not None:
                raise Failed(f"{name}: a process ended with status {process.returncode}")
        time.sleep(0.05)
    raise Failed(f"{name}: not within {limit:.0f} s")


class Cell:
    def __init__(self, period="10ms", pallets=0, speed=3.0, seed=1):
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="stationd-e2e-"))
        self.pallets, self.speed, self.seed = pallets, speed, seed
        self.processes = {}
        self.environment = dict(
            os.environ,
            STATIOND_DOMAIN=DOMAIN,
            STATIOND_PERIOD=period,
            STATIOND_SPEED=str(speed),
            STATIOND_SEED=str(seed),
            STATIOND_PALLETS=str(pallets),
            STATIOND_LEDGER=str(self.work / "ledger.json"),
        )
        self.port = 0

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        for name in list(self.processes)[::-1]:
            self.end(name)
        if kind is not None:
            for log in sorted(self.work.glob("*.log")):
                print(f"--- {log.name}\n" + "\n".join(log.read_text(errors="replace").splitlines()[-25:]))
        shutil.rmtree(self.work, ignore_errors=True)

    def log(self, name):
        file = self.work / f"{name}.log"
        return file.read_text(errors="replace") if file.exists() else ""

    def start(self, name, *command, state=None):
        environment = dict(self.environment)
        if state:
            (self.work / state).mkdir(exist_ok=True)
            environment["STATE_DIRECTORY"] = str(self.work / state)
        with open(self.work / f"{name}.log", "a", encoding="utf-8") as log:
            process = subprocess.Popen(
                [str(c) for c in command],
                stdout=log,
                stderr=log,
                env=environment,
                stdin=subprocess.DEVNULL,
                cwd=ROOT,
            )
        self.processes[name] = process
        return process

    def start_plant(self, *options):
        before = len(self.log("plantsim"))
        command = [
            BIN / "plantsim",
            "--port",
            self.port,
            "--speed",
            self.speed,
            "--seed",
            self.seed,
            "--ledger",
            self.work / "ledger.json",
            "--state",
            self.work / "plant.state",
        ]
        if self.pallets:
            command += ["--pallets", self.pallets]
        command += options
        process = self.start("plantsim", *command)
        found = wait_for(
            "plantsim listens",
            lambda: re.search(r"127\.0\.0\.1:(\d+)", self.log("plantsim")[before:]),
            alive=[process],
        )
        self.port = int(found.group(1))
        self.environment["STATIOND_PLANT"] = f"127.0.0.1:{self.port}"

    def start_controller(self, name, file=None):
        before = len(self.log(name))
        process = self.start(name, BIN / "stationd", file or ROOT / "config" / f"{name}.toml", state=name)
        wait_for(f"{name} is ready", lambda: "ready:" in self.log(name)[before:], alive=[process])
        return process

    def start_supervisor(self, *options):
        return self.start(
            "supervisor",
            BIN / "stationd-supervisor",
            *options,
            ROOT / "config" / "supervisor.toml",
            state="supervisor",
        )

    def start_all(self):
        self.start_plant()
        self.start_controller("controller1")
        self.start_controller("controller2")
        self.start_supervisor()

    def kill(self, name, how=signal.SIGKILL):
        process = self.processes.pop(name)
        process.send_signal(how)
        return process.wait(GENEROUS)

    def end(self, name):
        """SIGTERM; the exit status. Killed when it does not end."""
        process = self.processes.pop(name)
        process.terminate()
        try:
            return process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            raise Failed(f"{name} did not end on SIGTERM within 20 s") from None

    def ctl(self, *arguments, timeout="5s"):
        command = [
            str(BIN / "stationctl"),
            "--domain",
            DOMAIN,
            "--timeout",
            timeout,
            "--json",
            *map(str, arguments),
        ]
        return subprocess.run(
            command, capture_output=True, text=True, timeout=GENEROUS, check=False, env=self.environment
        )

    def listed(self, which):
        """What `stationctl --json list` says of the `stations` there are, or of those `missing`."""
        answer = self.ctl("list", timeout="2s")
        return json.loads(answer.stdout)[which] if answer.returncode == 0 else []

    def stations(self):
        """{name: what `stationctl --json list` says of it}"""
        return {row["station"]: row for row in self.listed("stations")}

    def station(self, name):
        """What it says of a station that runs; asked again where discovery took longer than the command."""
        return wait_for(f"{name} is on the bus", lambda: self.stations().get(name), quiet=True)

    def states(self):
        return {name: row["state"] for name, row in self.stations().items()}

    def verdict(self):
        try:
            return json.loads((self.work / "ledger.json").read_text())["verdict"]
        except (OSError, ValueError, KeyError):
            return {}

    def stored(self):
        return self.verdict().get("stored", 0)

    def wait_stored(self, count, limit=GENEROUS):
        wait_for(
            f"{count} pieces are stored",
            lambda: self.stored() >= count,
            limit=limit,
            alive=list(self.processes.values()),
        )

    def check_ledger(self, stored):
        verdict = self.verdict()
        check("the plant's ledger is clean", verdict.get("clean") is True, verdict)
        check(
            f"{stored} pieces are stored, each right", verdict["stored_right"] == verdict["stored"] >= stored
        )


def run(scenario):
    """Runs a scenario function; the process's exit status tells the result."""
    began = time.monotonic()
    try:
        scenario()
    except Failed as failure:
        print(f"FAIL {failure}")
        sys.exit(1)
    print(f"passed in {time.monotonic() - began:.1f} s")
