#!/usr/bin/env python3
"""stationd as a service manager sees it, on a notify socket: READY, STATUS, WATCHDOG, reload, stop
(SYS-1)."""

import signal
import socket
import subprocess
import time

from cell import BIN, ROOT, Cell, check, run, wait_for


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
    scans = cell.stations()["loader"]["scans"]
    daemon.send_signal(signal.SIGSTOP)
    time.sleep(0.3)
    daemon.send_signal(signal.SIGCONT)
    line = wait_for(
        "the deadline misses are in the log",
        lambda: next((text for text in cell.log("controller1").splitlines() if "deadline miss:" in text), ""),
    )
    for word in ("task main", "loader, robot", "scan ", "lateness", "execution", "skipped"):
        check(f'the line has "{word}"', word in line, "" if word in line else line)
    misses = wait_for("Status counts them", lambda: cell.stations()["loader"]["deadline_misses"])
    check("at least 25 periods of 10 ms were missed", misses >= 25, misses)
    wait_for("the scan goes on", lambda: cell.stations()["loader"]["scans"] > scans + 10)


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
        began = time.monotonic()
        check("SIGTERM ends it with status 0", cell.end("controller1") == 0)
        print(f"     it took {time.monotonic() - began:.2f} s")
        check("STOPPING was told", "STOPPING=1" in notifications.read())
        safe_values(cell)
        unread(cell)


run(scenario)
