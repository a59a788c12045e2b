"""What every benchmark says the same way: its figures, the machine, how it ends and what it needs."""

import argparse
import contextlib
import fcntl
import json
import os
import pathlib
import platform
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
VOID = 3  # exit status: no real-time rights, so the figures say nothing
NO_RIGHTS = (
    "VOID: no real-time rights (SCHED_FIFO, memory lock); root has them, or CAP_SYS_NICE and CAP_IPC_LOCK"
)


def figure(name, value, unit, goal=None, floor=None, ratio=None, met=None):
    """One row. `met` is said by the caller where it is no plain `value <= goal`; None: there is no goal."""
    if met is None and goal is not None:
        met = value <= goal
    if ratio is None and floor:
        ratio = value / floor
    rounded = [None if x is None else round(x, 4) for x in (value, floor, ratio)]
    return {
        "name": name,
        "value": rounded[0],
        "unit": unit,
        "floor": rounded[1],
        "ratio": rounded[2],
        "goal": goal,
        "met": met,
    }


def machine():
    model = [x for x in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if x.startswith("model name")]
    return {
        "kernel": platform.release(),
        "preemption": next((x for x in platform.version().split() if x.startswith("PREEMPT")), "none"),
        "cpus": len(os.sched_getaffinity(0)),
        "cpu": model[0].split(":")[1].strip() if model else platform.machine(),
        "load_before": round(os.getloadavg()[0], 2),
    }


def arguments(text, more=lambda parser: None):
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="under a minute")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release", metavar="DIR")
    more(parser)
    return parser.parse_args()


def prepare(build, targets, packages=True):
    """Installs and builds what is missing, as the demo does; silent when all is there."""
    if packages:
        subprocess.run([ROOT / "scripts" / "setup", "--bench"], check=True)
    if not (build / "build.ninja").exists():
        quiet = ["cmake", "--preset", "release", "-DSTATIOND_TESTS=OFF", "-B", build]
        subprocess.run(quiet, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    built = subprocess.run(["ninja", "-C", build, *targets], stdout=subprocess.PIPE, text=True, check=False)
    if built.returncode:
        raise SystemExit(built.stdout + "the build failed")


def said(value):
    return {True: "met", False: "MISSED", None: "not judged"}[value]


def finish(bench, about, figures, file):
    """Prints the rows, writes the JSON; the exit status is 0: a missed goal is a result, not a failure."""
    width = max(len(f["name"]) for f in figures)
    print(f"\n{'figure':{width}}  {'value':>12}  {'floor':>12}  {'ratio':>8}  goal")
    for f in figures:
        cells = ["-" if f[key] is None else f"{f[key]:g}" for key in ("value", "floor", "ratio")]
        goal = "-" if f["goal"] is None else f"{f['goal']:g}: {said(f['met'])}"
        print(f"{f['name']:{width}}  {cells[0]:>12}  {cells[1]:>12}  {cells[2]:>8}  {goal}  [{f['unit']}]")
    if file:
        file.write_text(json.dumps({"bench": bench, "machine": about, "figures": figures}, indent=1) + "\n")
    return 0


def end_by_signal():
    """SIGTERM and SIGHUP end as Ctrl-C does: what was started is ended, too."""

    def leave(number, _):
        sys.exit(128 + number)

    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, leave)


@contextlib.contextmanager
def domain():
    """A DDS domain that no other run on this machine has, claimed as scripts/lib.sh does it, for
    tests/e2e/cell.py. STATIOND_TEST_DOMAIN: who sets it has claimed one."""
    if os.environ.get("STATIOND_TEST_DOMAIN"):
        yield os.environ["STATIOND_TEST_DOMAIN"]
        return
    for attempt in range(99):
        number = (os.getpid() + attempt * 7) % 99 + 1
        file = pathlib.Path(f"/tmp/stationd-domain-{number}.lock")
        try:
            descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError:
            continue
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.stat(file).st_ino != os.fstat(descriptor).st_ino:
                raise BlockingIOError
        except OSError:
            os.close(descriptor)
            continue
        os.environ["STATIOND_TEST_DOMAIN"] = str(number)
        try:
            yield str(number)
        finally:
            file.unlink(missing_ok=True)
            os.close(descriptor)
        return
    raise SystemExit("all DDS domains from 1 to 99 are claimed (/tmp/stationd-domain-*.lock)")
