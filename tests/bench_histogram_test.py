#!/usr/bin/env python3
"""The arithmetic by which bench/scan_lateness compares two histograms."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench" / "lib"))
sys.dont_write_bytecode = True

import histogram  # noqa: E402

CYCLICTEST = """# Histogram
000000 000000
000009 000060
000010 000038
# Total: 000000098
# Max Latencies: 02500
# Histogram Overflows: 00002
"""


class BenchHistogram(unittest.TestCase):
    def test_percentile_lies_within_its_bucket(self):
        h = histogram.Histogram([(1000, 2000, 50), (4000, 5000, 50)])
        self.assertEqual(h.percentile(0.25), 1500)
        self.assertEqual(h.percentile(0.99), 4980)
        self.assertEqual(h.percentile(1.0), 5000)

    def test_difference_of_two_readings_is_what_came_between(self):
        earlier = histogram.Histogram([(1000, 2000, 5)])
        now = histogram.Histogram([(1000, 2000, 5), (2000, 3000, 7)])
        self.assertEqual(now.minus(earlier).buckets, [(2000, 3000, 7)])

    def test_wake_up_of_two_periods_and_more_stands_for_those_it_passed_over(self):
        late = histogram.Histogram([(2300, 2301, 4), (900, 901, 9)])
        self.assertEqual(late.missed(1000).buckets, [(300, 301, 4), (1300, 1301, 4)])

    def test_overflow_of_cyclictest_counts_as_its_maximum(self):
        h = histogram.of_cyclictest(CYCLICTEST)
        self.assertEqual(h.total, 100)
        self.assertEqual(h.percentile(0.99), 2_500_500)
        self.assertEqual(h.later_than(1_000_000), 2)

    def test_bucket_that_a_limit_is_in_counts_in_part(self):
        self.assertEqual(histogram.Histogram([(1000, 2000, 10)]).later_than(1500), 5)

    def test_interval_encloses_the_median_and_repeats(self):
        ratios = [0.8, 0.9, 1.0, 1.1, 5.0]
        median, low, high = histogram.median_interval(ratios, rounds=1000)
        self.assertEqual(median, 1.0)
        self.assertTrue(0.8 <= low <= median <= high <= 5.0)
        self.assertEqual(histogram.median_interval(ratios, rounds=1000), (median, low, high))


if __name__ == "__main__":
    unittest.main()
