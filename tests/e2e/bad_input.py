#!/usr/bin/env python3
"""Bad input gets one clear message and an exit status of its own, and nothing is driven."""

import subprocess

from cell import BIN, ROOT, Cell, check, run, wait_for


def stationd(cell, *arguments):
    environment = dict(cell.environment, STATE_DIRECTORY=str(cell.work))
    return subprocess.run(
        [str(BIN / "stationd"), *map(str, arguments)],
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
        cell.start_plant()
        ports(cell)
        cell.start_controller("controller1")
        silence(cell)
        duplicates(cell)
        check("controller 1 ends with status 0", cell.end("controller1") == 0)


run(scenario)
