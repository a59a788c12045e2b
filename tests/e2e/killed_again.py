#!/usr/bin/env python3
"""Controller 2 is killed (kill -9) thirty times at random moments under load: its retained data stay whole,
its epochs count on, and the ledger is right (IMG-4, IMG-5, SYS-4)."""

import os
import random
import re
import struct
import time
import zlib

from cell import Cell, check, run, wait_for

KILLS = 30
STATIONS = ("sealer", "storage")
HEADER = struct.Struct("<8sQQII")  # magic, layout, generation, epoch, slots


def records(cell, station):
    """(generation, epoch) of each whole record that the kill left behind."""
    found = []
    for path in (cell.work / "controller2").glob(f"controller2.{station}.retained.[01]"):
        data = path.read_bytes()
        if len(data) < HEADER.size + 4:
            continue
        magic, _, generation, epoch, slots = HEADER.unpack_from(data)
        body = HEADER.size + 8 * slots
        whole = magic == b"STRET001" and len(data) == body + 4
        if whole and zlib.crc32(data[:body]) == int.from_bytes(data[body:], "little"):
            found.append((generation, epoch))
    return sorted(found)


def mend(cell):
    """What sensors and record do not settle is a question to the operator; here the answer is: go on."""
    for station, state in cell.states().items():
        if state == "FAULT":
            cell.ctl("reset", station)
            cell.ctl("start", station)


def killed(cell, number):
    before = {s: records(cell, s) for s in STATIONS}
    cell.kill("controller2")
    left_epochs = {}
    for station in STATIONS:
        left = records(cell, station)
        left_epochs[station] = max((epoch for _, epoch in left), default=0)
        whole = left and left[-1] >= before[station][-1]
        check(f"kill {number}: {station} has a whole record, none older than before", whole, left)
    seen = len(cell.log("controller2"))
    cell.start_controller("controller2")
    log = cell.log("controller2")[seen:]
    for station in STATIONS:
        began = re.search(rf"station {station}: epoch (\d+), warm start", log)
        check(f"{station} starts warm", began, "" if began else log)
        check("with an epoch above all before", int(began[1]) > left_epochs[station], began[1])


def scenario():
    seed = int(os.environ.get("STATIOND_SEED", "5"))
    moments = random.Random(seed)
    with Cell(pallets=40, speed=4.0) as cell:
        cell.start_all()
        cell.wait_stored(2)
        for number in range(1, KILLS + 1):
            time.sleep(moments.uniform(0.0, 2.0))  # anywhere in a piece, not where a condition holds
            killed(cell, number)
            mend(cell)
        check("no record was refused for damage to both", "starting cold" not in cell.log("controller2"))

        def all_stored():
            mend(cell)
            return cell.stored() >= 40

        wait_for("40 pieces are stored", all_stored, limit=300)
        cell.end("plantsim")
        cell.check_ledger(40)


run(scenario)
