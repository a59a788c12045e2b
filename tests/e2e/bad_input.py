#!/usr/bin/env python3
"""Bad input gets one clear message and an exit status of its own, and nothing is driven."""

import pathlib
import subprocess

from cell import BIN, ROOT, Cell, check, run, wait_for


def stationd(cell, *arguments, program="stationd", state=None):
    environment = dict(cell.environment, STATE_DIRECTORY=str(state or cell.work))
    return subprocess.run(
        [str(BIN / program), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=60,
        env=environment,
        cwd=ROOT,
        check=False,
    )


def expect(name, result, status, *words):
    said = result.stdout + result.stderr
    check(f"{name}: exit status {status}", result.returncode == status, f"{result.returncode} {said[-300:]}")
    for word in words:
        check(f'{name}: says "{word}"', word in said, "" if word in said else said)


def files(cell):
    good = (ROOT / "config" / "controller1.toml").read_text()
    broken = cell.work / "broken.toml"
    broken.write_text(good.replace("[controller]", "[controller\n"))
    misspelt = cell.work / "misspelt.toml"
    misspelt.write_text(good.replace("priority", "prioritty", 1))
    expect("a broken file", stationd(cell, broken), 78, "broken.toml:")
    expect(
        "a misspelt key", stationd(cell, "--check", misspelt), 78, "misspelt.toml:", "prioritty", "priority"
    )
    unknown = cell.work / "unknown.toml"
    unknown.write_text(good.replace('program = "robot"', 'program = "robott"'))
    expect("an unknown program", stationd(cell, unknown), 78, "robott", "loader")
    expect("a missing file", stationd(cell, cell.work / "none.toml"), 78, "none.toml")
    expect("no file", stationd(cell), 64, "usage")
    expect("an unknown option", stationd(cell, "--chek", broken), 64, "--chek")
    network = cell.work / "network.toml"
    network.write_text(good.replace('"127.0.0.1"]', '"203.0.113.77"]'))
    expect("no DDS network", stationd(cell, network), 69, "203.0.113.77")
    for name in ("controller1", "controller2", "cell-in-process"):
        expect(f"{name} as shipped", stationd(cell, "--check", ROOT / "config" / f"{name}.toml"), 0, "good")


def supervisors(cell):
    """The supervisor's file has a check of its own, and neither program takes the other's (CFG-1, SYS-7)."""

    def supervisor(*arguments, **options):
        return stationd(cell, *arguments, program="stationd-supervisor", **options)

    shipped = ROOT / "config" / "supervisor.toml"
    expect("the supervisor's file as shipped", supervisor("--check", shipped), 0, "supervisor.toml: good")
    expect("a good file has one line", supervisor(shipped, "--check"), 0, "4 stations\n")
    expect(
        "its file given to stationd", stationd(cell, "--check", shipped), 78, "stationd-supervisor --check"
    )
    other = ROOT / "config" / "controller1.toml"
    expect(
        "a controller's file given to it", supervisor("--check", other), 78, "stationd --check", "1 error "
    )
    broken = cell.work / "supervisor.toml"
    broken.write_text(shipped.read_text().replace("start_repeat", "strat_repeat").replace('"1s"', "1s"))
    expect("a syntax error", supervisor("--check", broken), 78, "syntax error", 'stale_after = "1s"')
    broken.write_text(shipped.read_text().replace("start_repeat", "strat_repeat").replace('"1s"', '"1y"'))
    expect("all its errors at once", supervisor(broken), 78, "start_repeat", "1y", "2 errors in")
    state = pathlib.Path("/proc/nowhere")
    expect(
        "a state that cannot be kept", supervisor(shipped, state=state), 73, "$STATE_DIRECTORY", "--observe"
    )


def ports(cell):
    second = subprocess.run(
        [str(BIN / "plantsim"), "--port", str(cell.port)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    expect("plantsim on a port in use", second, 69, str(cell.port), "in use")


def duplicates(cell):
    same = cell.start("same", BIN / "stationd", ROOT / "config" / "controller1.toml", state="controller1")
    check("a second daemon of one controller ends with status 69", same.wait(60) == 69)
    check("it says why", "already running" in cell.log("same"))
    other = cell.start("other", BIN / "stationd", ROOT / "config" / "controller1.toml", state="other")
    check("a second daemon with the same station name ends with status 69", other.wait(60) == 69)
    check(
        "it names the station",
        "loader" in cell.log("other") and "another" in cell.log("other"),
        cell.log("other"),
    )
    del cell.processes["same"], cell.processes["other"]
    check("the first one goes on", cell.processes["controller1"].poll() is None)
    check("its stations are as they were", set(cell.states().values()) == {"STOPPED"}, cell.states())


def silence(cell):
    answer = cell.ctl("msg", "roboter", "status", timeout="1s")
    check("stationctl tells an unknown station apart", answer.returncode == 3, answer.stderr)
    wait_for("both stations are seen", lambda: len(cell.states()) == 2)


def scenario():
    with Cell() as cell:
        files(cell)
        supervisors(cell)
        cell.start_plant()
        ports(cell)
        cell.start_controller("controller1")
        silence(cell)
        duplicates(cell)
        check("controller 1 ends with status 0", cell.end("controller1") == 0)


run(scenario)
