#!/usr/bin/env python3
"""stationctl stats against a running daemon: figures that belong together, and what a stalled daemon leaves
in them (SCAN-6, SCAN-4)."""

import json
import re
import signal
import time

from cell import ROOT, Cell, check, run, wait_for

FIGURES = ("lateness", "execution", "response", "task_execution", "task_response")
PHASES = ("latch", "execute", "commit", "publish", "service")
ORDER = ("min_ns", "p50_ns", "p99_ns", "p999_ns", "max_ns")
STALL = 1.2  # seconds: above one, where figures from nanoseconds alone would be wrong
SOME = 50  # scans that may pass while the figures are read, one after the other


def stats(cell, *arguments):
    answer = cell.ctl("stats", *arguments, timeout="30s")
    check(
        "stats answers",
        answer.returncode == 0,
        answer.stdout[-300:] + answer.stderr if answer.returncode else "",
    )
    return {row["station"]: row for row in json.loads(answer.stdout)["stations"]}


def sound(cell):
    rows = stats(cell)
    check("every station is there", sorted(rows) == ["loader", "robot", "sealer", "storage"], sorted(rows))
    for name, row in rows.items():
        for window in ("since_start", "last_minute"):
            figures = [row[window][figure] for figure in FIGURES + PHASES]
            ordered = all(figure[a] <= figure[b] for figure in figures for a, b in zip(ORDER, ORDER[1:]))
            check(f"{name}, {window}: percentiles are in order", ordered, "" if ordered else figures)
            counts = {figure["count"] for figure in figures}
            check(f"{name}, {window}: each scan is in each figure", max(counts) - min(counts) <= SOME, counts)
        check(
            f"{name}: its execution is part of its task's",
            row["since_start"]["execution"]["mean_ns"] < row["since_start"]["task_execution"]["mean_ns"],
        )
    check("four stations share the task", rows["robot"]["task_stations"] == 4)


def stalled(cell, daemon):
    before = stats(cell, "robot")["robot"]["since_start"]
    daemon.send_signal(signal.SIGSTOP)
    time.sleep(STALL)
    daemon.send_signal(signal.SIGCONT)
    after = wait_for(
        "the stall is in the figures",
        lambda: (row := stats(cell, "robot")["robot"])["since_start"]["deadline_misses"]
        > before["deadline_misses"] + 100
        and row,
    )
    for window in ("since_start", "last_minute"):
        # The stall makes a scan late, or falls into one of its phases.
        longest = max(after[window][figure]["max_ns"] for figure in ("lateness",) + PHASES)
        check(f"{window}: the longest of them is above a second", longest > 1_000_000_000, longest)
        check(f"{window}: skipped cycles are counted", after[window]["skipped"] >= 100)
    line = wait_for(
        "the miss is in the log, with what took the time",
        lambda: re.search(r"deadline miss:.*(woken late by|took) \d{6,}\.\d us", cell.log("cell")),
    )
    print(f"     {line.group(0)[:150]}")


def histogram(cell):
    row = stats(cell, "robot", "--histogram")["robot"]
    for figure in ("lateness", "execution", "response"):
        buckets = row["histograms"][figure]
        total = sum(bucket["count"] for bucket in buckets)
        check(f"{figure}: the buckets hold every scan", total >= row["since_start"][figure]["count"], total)
        edges = [edge for bucket in buckets for edge in (bucket["from_ns"], bucket.get("to_ns"))]
        check(f"{figure}: they are in order", edges == sorted(edges))
        least, most = row["since_start"][figure]["min_ns"], row["since_start"][figure]["max_ns"]
        check(f"{figure}: from the minimum up to the maximum", edges[0] <= least and most < edges[-1] + 1)
    unknown = cell.ctl("stats", "robbot", timeout="3s")
    check("an unknown station: status 3", unknown.returncode == 3, unknown.stderr)
    check("and a suggestion", 'did you mean "robot"?' in unknown.stderr)


def scenario():
    with Cell() as cell:
        daemon = cell.start_controller("cell", ROOT / "config" / "cell-in-process.toml")
        wait_for("200 scans pass", lambda: cell.stations().get("robot", {}).get("scans", 0) > 200)
        sound(cell)
        stalled(cell, daemon)
        histogram(cell)
        check("SIGTERM ends it with status 0", cell.end("cell") == 0)


run(scenario)
