#!/usr/bin/env python3
"""stationd as a service manager sees it, on a notify socket: READY, STATUS, WATCHDOG, reload, stop
(SYS-1)."""

import os
import re
import signal
import socket
import subprocess
import time

from cell import BIN, ROOT, Cell, check, run, wait_for
from out_of_reach import BlackHole, Silent


def ends_in_time(cell, what):
    """The promise is 2 s. The daemon's own measure is held to it; the whole, with a busy machine's delays in
    starting and reaping processes, to five times as much."""
    began = time.monotonic()
    check(f"{what}: SIGTERM ends it with status 0", cell.end("controller1") == 0)
    took = time.monotonic() - began
    own = re.findall(r"all ended within (\d+) ms", cell.log("controller1"))
    check(f"{what}: within 2 s, as it says itself", own and int(own[-1]) <= 2000, own[-1:])
    check(f"{what}: and as seen from outside", took < 10, f"{took:.2f} s")


class Notifications:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(path))
        self.socket.settimeout(0.05)
        self.lines = []

    def read(self):
        try:
            while True:
                self.lines += self.socket.recv(4096).decode().splitlines()
        except TimeoutError:
            return self.lines


def unread(cell):
    """Nobody reads the notify socket: the daemon goes on and still ends on SIGTERM."""
    deaf = Notifications(cell.work / "deaf")
    cell.environment.update(NOTIFY_SOCKET=str(cell.work / "deaf"), WATCHDOG_USEC="400000")
    cell.start_controller("controller1")
    wait_for("1,000 scans pass", lambda: cell.stations().get("loader", {}).get("scans", 0) > 1000)
    check("a daemon whose service manager is deaf ends with status 0", cell.end("controller1") == 0)
    check("the socket was full of what nobody read", len(deaf.read()) >= 10)


def safe_values(cell):
    process = subprocess.run(
        [BIN / "stationd", "--write-safe", ROOT / "config" / "controller1.toml"],
        capture_output=True,
        text=True,
        timeout=60,
        env=cell.environment,
        cwd=ROOT,
        check=False,
    )
    check(
        "--write-safe writes to both devices",
        process.returncode == 0 and process.stdout.count("written") == 2,
        process.stdout + process.stderr,
    )


def late(cell, daemon):
    """The daemon is stopped for a while: the scans left out are misses, and in the log (SCAN-4)."""
    scans = cell.station("loader")["scans"]
    daemon.send_signal(signal.SIGSTOP)
    time.sleep(0.3)
    daemon.send_signal(signal.SIGCONT)
    line = wait_for(
        "the deadline misses are in the log",
        lambda: next((text for text in cell.log("controller1").splitlines() if "deadline miss:" in text), ""),
    )
    for word in ("task main", "loader, robot", "scan ", "lateness", "execution", "skipped"):
        check(f'the line has "{word}"', word in line, "" if word in line else line)
    misses = wait_for("Status counts them", lambda: cell.station("loader")["deadline_misses"])
    check("at least 25 periods of 10 ms were missed", misses >= 25, misses)
    wait_for("the scan goes on", lambda: cell.station("loader")["scans"] > scans + 10)


def out_of_reach(cell):
    """Devices that do not answer are not waited for, whatever their time-out (IO-3)."""
    del cell.environment["NOTIFY_SOCKET"]
    silent, hole = Silent(), BlackHole()
    text = (ROOT / "config" / "controller1.toml").read_text()
    for number, port in ((1, silent.port), (2, hole.port)):
        text = text.replace(
            f'name = "remote-io-{number}"\naddress = "${{STATIOND_PLANT:-127.0.0.1:5020}}"',
            f'name = "remote-io-{number}"\naddress = "127.0.0.1:{port}"',
        )
    text = text.replace('timeout = "200ms"', 'timeout = "10s"')
    check("both devices are replaced", text.count("STATIOND_PLANT") == 0 and text.count('"10s"') == 2)
    file = cell.work / "silent.toml"
    file.write_text(text)
    cell.start_controller("controller1", file)
    silent.listener.accept()
    ends_in_time(cell, "with one device silent and one a black hole")
    log = cell.log("controller1")
    for device in ("remote-io-1", "remote-io-2"):
        check(f"the log says that {device} is not safe", f"{device}: safe values NOT written" in log)


def stuck_log(cell):
    """Standard error is a pipe that is full and that nobody reads."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    try:
        while True:
            os.write(writer, b"x" * 4096)
    except BlockingIOError:
        os.set_blocking(writer, True)
    environment = dict(cell.environment, STATE_DIRECTORY=str(cell.work / "controller1"))
    process = subprocess.Popen(
        [BIN / "stationd", ROOT / "config" / "controller1.toml"], stderr=writer, env=environment, cwd=ROOT
    )
    cell.processes["controller1"] = process
    wait_for("it scans", lambda: cell.stations().get("loader", {}).get("scans", 0) > 100)
    check("a daemon whose log is stuck ends with status 0", cell.end("controller1") == 0)
    os.close(reader)
    os.close(writer)


def scenario():
    with Cell() as cell:
        path = cell.work / "notify"
        notifications = Notifications(path)
        cell.start_plant()
        cell.environment.update(NOTIFY_SOCKET=str(path), WATCHDOG_USEC="2000000")
        cell.start_controller("controller1")
        wait_for("READY comes once the first scan ran", lambda: "READY=1" in notifications.read())
        wait_for(
            "STATUS shows scans and misses",
            lambda: any(
                line.startswith("STATUS=") and "scan" in line and "miss" in line
                for line in notifications.read()
            ),
        )
        wait_for("WATCHDOG is fed", lambda: notifications.read().count("WATCHDOG=1") >= 3)
        daemon = cell.processes["controller1"]
        late(cell, daemon)
        notifications.read()  # a full socket would lose what comes next
        daemon.send_signal(signal.SIGHUP)
        wait_for(
            "SIGHUP reads the configuration again",
            lambda: "configuration read again" in cell.log("controller1"),
        )
        check("it says so to the service manager", "RELOADING=1" in notifications.read())
        ends_in_time(cell, "with its devices there")
        check("STOPPING was told", "STOPPING=1" in notifications.read())
        safe_values(cell)
        unread(cell)
        out_of_reach(cell)
        stuck_log(cell)


run(scenario)
