"""Histograms of lateness in nanoseconds, and how two of them are compared."""

import random
import re
import statistics

US = 1000


class Histogram:
    """Buckets (from_ns, to_ns, count), ascending; to_ns is not in it. `max_ns`: exact where known."""

    def __init__(self, buckets=(), max_ns=0):
        self.buckets = [b for b in buckets if b[2] > 0]
        self.max_ns = max_ns or (self.buckets[-1][1] if self.buckets else 0)
        self.total = sum(b[2] for b in self.buckets)

    def minus(self, earlier):
        """What came since; a histogram since start less one taken before. Buckets of one fineness."""
        before = {b[0]: b[2] for b in earlier.buckets}
        return Histogram([(lo, hi, n - before.get(lo, 0)) for lo, hi, n in self.buckets])

    def plus(self, other):
        """Both together; buckets of one kind stay apart from those of another and may overlap."""
        counts = {}
        for lo, hi, n in self.buckets + other.buckets:
            counts[lo, hi] = counts.get((lo, hi), 0) + n
        return Histogram(
            [(lo, hi, counts[lo, hi]) for lo, hi in sorted(counts)], max(self.max_ns, other.max_ns)
        )

    def percentile(self, share):
        """Evenly spread within a bucket: cyclictest's are 1 us wide, those of stationd at most 1 %."""
        wanted, seen = share * self.total, 0
        for lo, hi, n in self.buckets:
            if seen + n >= wanted:
                return min(lo + (hi - lo) * (wanted - seen) / n, self.max_ns)
            seen += n
        return self.max_ns

    def later_than(self, limit_ns):
        """How many are later; evenly spread within the bucket that the limit is in."""
        return sum(n * min(1.0, (hi - limit_ns) / (hi - lo)) for lo, hi, n in self.buckets if hi > limit_ns)

    def missed(self, period_ns):
        """The cycles that a late wake-up passed over, as late as they would have been: one that comes 2.3
        periods late stands for one of 1.3 and one of 0.3, which did not run."""
        extra = []
        for lo, hi, n in self.buckets:
            late = (lo + hi) // 2 - period_ns
            while late > 0:
                extra.append((late, late + 1, n))
                late -= period_ns
        return Histogram(sorted(extra))


def of_cyclictest(text):
    """From its `--histfile`: 1 us buckets. What overflowed stands as the maximum, so never as less."""
    buckets = [
        (int(us) * US, int(us) * US + US, int(n)) for us, n in re.findall(r"^(\d{6,}) (\d+)", text, re.M)
    ]
    longest = int(re.search(r"Max Latencies: (\d+)", text)[1]) * US + US
    over = int(re.search(r"Histogram Overflows: (\d+)", text)[1])
    return Histogram(buckets + [(longest - US, longest, over)], longest)


def of_stationd(reading):
    """From bench_requester's `window`; the overflow has no end and is told as its least."""
    return Histogram([(lo, min(hi, lo * 2 + 1), n) for lo, hi, n in reading["buckets"]])


def median_interval(ratios, seed=1, rounds=10_000):
    """Median of the ratios of pairs, and its 95 % interval by bootstrap over the pairs; seeded."""
    draw = random.Random(seed)
    medians = sorted(statistics.median(draw.choices(ratios, k=len(ratios))) for _ in range(rounds))
    return statistics.median(ratios), medians[int(rounds * 0.025)], medians[int(rounds * 0.975) - 1]
