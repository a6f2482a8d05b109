"""Some changes of the impact count as a difference, fewer as a detected mutant.

Usage: impact_goldens_test.py
"""
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

from impact_goldens import METRICS, differences, has_finite_change

GOLDEN = dict.fromkeys(METRICS, 2.0)
ROWS = (  # how the first metric differs: found, is a difference, is a finite change
    ({}, False, False),
    ({METRICS[0]: 2.001}, False, False),
    ({METRICS[0]: 2.01}, True, True),
    ({METRICS[0]: math.nan}, True, False),
    ({METRICS[0]: math.inf}, True, False),
    (dict.fromkeys(METRICS, math.nan), True, False),
)


class ImpactGoldens(unittest.TestCase):
    def test_a_mutant_is_seen_by_a_finite_change_alone(self):
        for changes, is_difference, is_finite in ROWS:
            with self.subTest(changes=changes):
                found = {**GOLDEN, **changes}
                self.assertEqual(bool(differences(GOLDEN, found)), is_difference)
                self.assertEqual(has_finite_change(GOLDEN, found), is_finite)
        self.assertTrue(differences(GOLDEN, {}))  # the run failed
        self.assertFalse(has_finite_change(GOLDEN, {}))


if __name__ == "__main__":
    unittest.main()
