"""The checker of the soak finds planted trends and no others."""

import unittest

import numpy as np

from trend import trend

COUNTS = np.arange(1, 101) * 1000.0
BOUND = 1000.0


def memory(rng, leak=0.0):
    """kB: caches fill at first, an allocator takes and returns pages, and `leak` grows."""
    share = COUNTS / COUNTS[-1]
    caches = 5000 * np.minimum(1.0, share / 0.15)
    steps = 128 * rng.integers(-2, 3, len(COUNTS))
    return 40_000 + caches + steps + leak * share


class Trends(unittest.TestCase):
    def found(self, leak, seeds=200):
        exceeds = [trend(COUNTS, memory(np.random.default_rng(seed), leak)).exceeds(BOUND)
                   for seed in range(seeds)]
        return sum(exceeds) / seeds

    def test_a_leak_is_found(self):
        self.assertEqual(self.found(1500.0), 1.0)
        self.assertEqual(self.found(20_000.0), 1.0)

    def test_caches_and_small_growth_are_none(self):
        self.assertEqual(self.found(0.0), 0.0)
        self.assertEqual(self.found(500.0), 0.0)
        self.assertEqual(self.found(-20_000.0), 0.0)

    def test_a_slowdown_is_found_in_noise(self):
        for slower, share in ((0.0, 0.0), (0.01, 0.0), (0.2, 1.0)):
            found = []
            for seed in range(200):
                rng = np.random.default_rng(seed)
                time_us = 100 * (1 + slower * COUNTS / COUNTS[-1]) * rng.normal(1, 0.03, len(COUNTS))
                result = trend(COUNTS, time_us)
                found.append(result.exceeds(0.05 * result.start))
            self.assertEqual(np.mean(found), share, slower)

    def test_a_random_walk_seldom_is_significant(self):
        """Samples that depend on each other, such as a neighbour's load. The bound is another guard."""
        found = []
        for seed in range(200):
            rng = np.random.default_rng(seed)
            noise = np.convolve(rng.normal(0, 300, len(COUNTS) + 4), np.ones(5) / 5, "valid")
            found.append(trend(COUNTS, 40_000 + noise).exceeds(BOUND))
        self.assertEqual(sum(found), 0)

    def test_descriptors(self):
        one_each_tenth = np.floor(np.arange(100) / 10)
        self.assertTrue(trend(COUNTS, 7 + one_each_tenth).exceeds(0.5))
        self.assertFalse(trend(COUNTS, np.full(100, 7.0)).exceeds(0.5))
        # One more from the beginning on, or for a moment.
        once = np.full(100, 7.0)
        once[40] = 9
        self.assertFalse(trend(COUNTS, once).exceeds(0.5))

    def test_too_few_samples_are_refused(self):
        with self.assertRaises(ValueError):
            trend(COUNTS[:20], COUNTS[:20])


if __name__ == "__main__":
    unittest.main()
