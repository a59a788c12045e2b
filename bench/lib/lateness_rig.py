"""The cell that bench/scan_lateness measures in, and its two kinds of window."""

import dataclasses
import json
import os
import pathlib
import re
import signal
import subprocess
import time

import histogram
from report import ROOT

MEASURED, BESIDE = 80, 70  # SCHED_FIFO priorities: who is measured in a window, and who is beside
REACH_US = 100_000  # end of cyclictest's histogram; what is later is its overflow
BODY = "64KiB"  # a histogram fits into a reply without its buckets being merged
RUNNING = 1
PER_SECOND = 1_000_000
US = 1000


@dataclasses.dataclass
class Window:
    """One window of one side, or several together."""

    histogram: histogram.Histogram  # of every cycle; one that did not run is as late as it would have been
    raw: histogram.Histogram  # of the wake-ups alone
    missed: int = 0  # cycles that did not run
    late: int = 0  # deadline misses (stationd), missed cycles among them
    beside_steal: int = 0  # those of them within 0.2 s of steal on this CPU
    steal_ms: int = 0
    seconds: float = 0.0

    def plus(self, other):
        sums = {f.name: getattr(self, f.name) + getattr(other, f.name) for f in dataclasses.fields(self)[2:]}
        return Window(self.histogram.plus(other.histogram), self.raw.plus(other.raw), **sums)


def configuration(period_us, spin_us, cpu):
    """The four stations of the shipped controllers in one daemon; the task is this bench's."""
    texts = [(ROOT / "config" / f"controller{n}.toml").read_text() for n in (1, 2)]
    blocks = [re.split(r"^(?=\[)(?!\[station\.)", text, flags=re.MULTILINE)[1:] for text in texts]
    wanted = [b for b in blocks[0] if b.startswith("[[recipe]]")]
    for of_one in blocks:
        wanted += [b for b in of_one if b.startswith(("[[device]]", "[[station]]"))]
    bus = next(b for b in blocks[0] if b.startswith("[bus]"))
    task = f'[[task]]\nname = "main"\nperiod = "{period_us}us"\npriority = {MEASURED}\ncpu = {cpu}\n'
    task += 'watchdog = "1s"\n' + (f'spin = "{spin_us}us"\n' if spin_us else "")
    text = '[controller]\nname = "cell"\n\n' + bus.rstrip() + f'\nmax_body = "{BODY}"\n\n' + task + "\n"
    return text + "".join(wanted).replace('"${STATIOND_PERIOD:-10ms}"', '"1ms"')


class Rig:
    """plantsim, stationd with four stations on Modbus, the supervisor, 100 requests a second: always."""

    def __init__(self, cell_module, cpu, period_us=1000, spin_us=0):
        self.module, self.cpu = cell_module, cpu
        self.period_us, self.spin_us = period_us, spin_us
        # A scan that spins would end its wait in the other's timer interrupt, and keep the CPU awake for it.
        self.offset_us = period_us // 2 if spin_us else 0
        self.cell = cell_module.Cell(period="1ms", speed=1.0)
        self.requester = None
        self.scan = 0
        self.execution_ns = 0  # median of all four stations' latch, execute, commit

    def __enter__(self):
        try:
            self.begin()
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(self, kind, error, trace):
        if self.requester:
            self.requester.stdin.close()
            try:
                self.requester.wait(10)
            except subprocess.TimeoutExpired:
                self.requester.kill()
                self.requester.wait()
        self.cell.__exit__(kind, error, trace)

    def begin(self):
        file = self.cell.work / "cell.toml"
        file.write_text(configuration(self.period_us, self.spin_us, self.cpu))
        self.cell.start_plant()
        daemon = self.cell.start_controller("cell", file)
        rights = re.search(r"real-time rights: (.*)", self.cell.log("cell"))
        if not rights or "refused" in rights[1]:
            raise PermissionError(rights[1] if rights else "the daemon said nothing of its rights")
        threads = pathlib.Path(f"/proc/{daemon.pid}/task").iterdir()
        self.scan = int(next(t.name for t in threads if (t / "comm").read_text().strip() == "scan-main"))
        self.cell.start_supervisor()
        command = [self.module.BIN / "bench_requester", self.module.DOMAIN, "assembly", f"cpu{self.cpu}"]
        pipe = subprocess.PIPE
        self.requester = subprocess.Popen([str(c) for c in command], stdin=pipe, stdout=pipe, text=True)
        self.module.wait_for(
            "all four stations run", lambda: self.running() == 4, alive=[daemon, self.requester]
        )

    def ask(self, question):
        print(question, file=self.requester.stdin, flush=True)
        answer = json.loads(self.requester.stdout.readline() or '{"error": "bench_requester ended"}')
        if "error" in answer:
            raise SystemExit(answer["error"] + "\n" + self.cell.log("cell")[-2000:])
        return answer

    def running(self):
        return list(self.ask("states").values()).count(RUNNING)

    def revive(self):
        """Between windows: stations that a loaded machine brought to FAULT go on. True: there were any."""
        if self.running() == 4:
            return False
        for order in ("reset", "start"):
            self.cell.ctl(order, "all")
        end = time.monotonic() + 10
        while self.running() < 4 and time.monotonic() < end:
            time.sleep(0.1)
        return True

    def steal_ms(self):
        lines = pathlib.Path("/proc/stat").read_text().splitlines()
        ticks = next(x for x in lines if x.startswith(f"cpu{self.cpu} ")).split()[8]
        return int(ticks) * 1000 // os.sysconf("SC_CLK_TCK")

    def priority_of_scan(self, priority):
        os.sched_setscheduler(self.scan, os.SCHED_FIFO, os.sched_param(priority))

    def start_cyclictest(self, priority, seconds):
        file = self.cell.work / "cyclictest.txt"
        command = ["cyclictest", "-q", "-m", f"-p{priority}", f"-i{self.period_us}", "-t1", f"-a{self.cpu}"]
        command += [f"--secaligned={self.offset_us}"]  # 0: due on full periods of CLOCK_MONOTONIC, as a scan
        command += [f"-h{REACH_US}", f"--histfile={file}", f"-l{int(seconds * PER_SECOND / self.period_us)}"]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL), file

    def cyclictest(self, seconds):
        """cyclictest is measured; the scan goes on beside it, at the lower priority."""
        self.priority_of_scan(BESIDE)
        steal, began = self.steal_ms(), time.monotonic()
        process, file = self.start_cyclictest(MEASURED, seconds)
        self.end(process, seconds * 5 + 30)
        measured = histogram.of_cyclictest(file.read_text())
        extra = measured.missed(self.period_us * US)
        return Window(
            measured.plus(extra),
            measured,
            missed=extra.total,
            steal_ms=self.steal_ms() - steal,
            seconds=time.monotonic() - began,
        )

    def stationd(self, seconds):
        """The scan is measured; cyclictest goes on beside it, at the lower priority."""
        process, _ = self.start_cyclictest(BESIDE, seconds + 600)
        try:
            self.priority_of_scan(MEASURED)
            time.sleep(1.05 - time.monotonic() % 1.0)  # until the other one has begun
            before, steal, began = self.ask("window"), self.steal_ms(), time.monotonic()
            time.sleep(seconds - 0.5)  # figures are collected once a second
            after, steal = self.ask("window"), self.steal_ms() - steal
            elapsed = time.monotonic() - began
        finally:
            process.send_signal(signal.SIGINT)
            self.end(process, 30)
        if before["merged"] != 1 or after["merged"] != 1:
            raise SystemExit("the histogram's buckets were merged: it is coarser than 1 %")
        self.execution_ns = after["execution_p50_ns"]
        measured = histogram.of_stationd(after).minus(histogram.of_stationd(before))
        missed = after["skipped"] - before["skipped"]
        extra = measured.missed(self.period_us * US)
        # Cycles that were passed over for another reason than a late wake-up count as a period late.
        rest, period_ns = max(missed - extra.total, 0), self.period_us * US
        extra = extra.plus(histogram.Histogram([(period_ns, period_ns + 1, rest)]))
        return Window(
            measured.plus(extra),
            measured,
            missed=missed,
            late=after["misses"] - before["misses"],
            beside_steal=after["misses_beside_steal"] - before["misses_beside_steal"],
            steal_ms=steal,
            seconds=elapsed,
        )

    @staticmethod
    def end(process, limit):
        try:
            process.wait(limit)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            raise SystemExit("cyclictest did not end") from None
        except BaseException:
            process.kill()
            process.wait()
            raise
