"""The least free-motion time: its contact agrees with a closed form, and its general walls with the standing one.

Usage: contact_limit_test.py
"""

import math
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/studies"))
try:
    import numpy as np
except ImportError:
    sys.exit(77)
import contact_limit  # noqa: E402
from contact_limit import Arm, LAG_s, START_m, Wall  # noqa: E402

BRAKING_m_s2 = 4.0


class EvenArm(Arm):
    def acceleration(self, x, v, force, sign):
        return np.full(np.shape(x), sign * BRAKING_m_s2)


def closed_form_N(speed_m_s, stiffness_N_m):
    """The lagged peak of a spring under x = v t - a t^2 / 2: K x at the fixed point of its time."""
    time_s = LAG_s
    for _ in range(2000):
        time_s = (LAG_s + speed_m_s / BRAKING_m_s2) * (1.0 - math.exp(-time_s / LAG_s))
    return stiffness_N_m * (speed_m_s * time_s - 0.5 * BRAKING_m_s2 * time_s ** 2)


def speeds(walls, arm, peak_N=4.0):
    return arm.contact_speed(np.array([START_m, START_m + 0.05]), np.array([[peak_N]]), walls)


class Floor(unittest.TestCase):
    def test_the_peak_is_that_of_the_closed_form_for_even_braking(self):
        for speed_m_s in (0.1, 0.2, 0.3):
            peak_N = EvenArm().peak(np.array(START_m), speed_m_s, Wall(damping_Ns_m=0.0))
            self.assertAlmostEqual(float(peak_N) / closed_form_N(speed_m_s, 1000.0), 1.0, delta=0.01)

    def test_a_wall_that_moves_adds_its_speed_for_even_braking(self):
        standing = speeds([Wall()], EvenArm())
        for speed_m_s in (-0.03, 0.02):
            moving = speeds([Wall(speed_m_s=speed_m_s)], EvenArm())
            np.testing.assert_allclose(moving - speed_m_s, standing, atol=2e-5)

    def test_the_hardest_wall_of_a_range_decides(self):
        arm = Arm()
        walls = [Wall(500.0, 7.07), Wall(1000.0, 10.0), Wall(4000.0, 20.0)]
        np.testing.assert_array_equal(speeds(walls, arm), speeds(walls[-1:], arm))

    def test_ranges_of_no_width_give_the_floor_of_a_standing_wall_of_known_stiffness(self):
        arm = Arm()
        end = START_m + contact_limit.DISTANCE_m
        row = next(row for row in contact_limit.read(contact_limit.LIMITS) if row["peak_N"] == "4.0")
        places = np.linspace(START_m, end, 8)
        wall = Wall(1000.0, 10.0, speed_m_s=0.0)
        caps = np.column_stack([places, arm.contact_speed(places, np.array([[4.0]]), [wall, wall])[0]])
        time_s = contact_limit.time_to_wall(arm.drive(end + 0.01), caps, contact_limit.DISTANCE_m, 0.0)
        self.assertEqual(round(time_s, 4), float(row["unknown_s"]))


if __name__ == "__main__":
    unittest.main()
