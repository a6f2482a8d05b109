"""The checker of the soak finds planted trends and no others."""

import unittest

import numpy as np

from soak import trend

COUNTS = np.arange(1, 101) * 1000.0
SHARE = COUNTS / COUNTS[-1]


def memory(leak):
    """kB: caches fill at first, an allocator takes and returns pages, and `leak` grows."""
    return lambda rng: 40_000 + 5000 * np.minimum(1.0, SHARE / 0.15) + 128 * rng.integers(-2, 3, 100) + leak * SHARE


def time_us(slower):
    return lambda rng: 100 * (1 + slower * SHARE) * rng.normal(1, 0.03, 100)


def dependent(rng):
    """Samples that depend on each other, such as a neighbour's load. The bound is another guard."""
    return 40_000 + np.convolve(rng.normal(0, 300, 104), np.ones(5) / 5, "valid")


class Trends(unittest.TestCase):
    def test_are_found_if_they_are_planted(self):
        for what, series, bound, share in (
                ("a leak", memory(1500.0), 1000, 1), ("a large leak", memory(20_000.0), 1000, 1), ("none", memory(0.0), 1000, 0),
                ("a small one", memory(500.0), 1000, 0), ("a shrinking one", memory(-20_000.0), 1000, 0),
                ("even times", time_us(0.0), 5, 0), ("a little slower", time_us(0.01), 5, 0), ("slower", time_us(0.2), 5, 1),
                ("a neighbour's load", dependent, 1000, 0),
                ("descriptors", lambda rng: 7 + np.arange(100) // 10, 0.5, 1), ("7 descriptors", lambda rng: np.full(100, 7.0), 0.5, 0),
                ("two more for a moment", lambda rng: 7 + 2.0 * (np.arange(100) == 40), 0.5, 0)):
            with self.subTest(what):
                found = [trend(COUNTS, series(np.random.default_rng(seed))).exceeds(bound) for seed in range(200)]
                self.assertEqual(np.mean(found), share)

    def test_too_few_samples_are_refused(self):
        with self.assertRaises(ValueError):
            trend(COUNTS[:20], COUNTS[:20])


if __name__ == "__main__":
    unittest.main()
