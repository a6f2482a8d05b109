"""Identification of simulated motors with a spring and a load. Their simulator (identification/bench.h) has its own
small steps."""

import math
import unittest

import numpy as np

import methods
from identification_test import BENCHES, covered, identified, is_white, of, swaying, values
from methods import TwoInertiaBench
from support import near

MODEL = methods.two_inertia_axis
PARAMETERS = ("motor_inertia load_inertia stiffness damping backlash motor_viscous load_viscous motor_coulomb load_coulomb "
              "offset").split()


def truths_of(bench):
    return {name: getattr(bench, name) for name in PARAMETERS} | {"delay": bench.delay_s}


class TwoInertia(unittest.TestCase):
    def end_of(self, input, duration, **parameters):
        stretch = methods.AxisStretch(input_times_s=[0], inputs=[input], times_s=duration * np.arange(401) / 400)
        plant = values(motor_inertia=0.01, load_inertia=0.02, stiffness=50, **parameters)
        return MODEL.move(plant, methods.AxisStart(), stretch)[-1]

    def test_it_moves_as_in_closed_form(self):
        # A torque u: q_m = u t²/(2 J) + u J_l/(J_m J ω²) (1 − cos ω t).
        w, t = math.sqrt(50 * (100 + 50)), 0.3
        near(self.end_of(1, t), t * t / 0.06 + 0.02 / (0.01 * 0.03 * w * w) * (1 - math.cos(w * t)), atol=1e-9)
        # In its play the motor moves alone, until it meets the flank at 0.5 b = u t²/(2 J_m).
        near(self.end_of(1, 0.06, backlash=0.4), 0.06 * 0.06 / 0.02, atol=1e-12)
        # A spring that the static friction of the load holds.
        near(self.end_of(1, t, load_coulomb=100), 0.02 * (1 - math.cos(math.sqrt(5000) * t)), atol=1e-9)

    def test_a_start_is_found_on_either_flank_of_the_play(self):
        bench, quantum = TwoInertiaBench(backlash=0.04, duration_s=0.6), 2 * math.pi / 2**14
        record = methods.record(bench, 4)
        truth = methods.AxisFit(values=values(**truths_of(bench)), noise_std=bench.noise_counts * quantum)
        for n in range(1, 13):
            data = methods.axis_data([record], False, 0.02 * n)
            data.model, data.quantum = MODEL, quantum
            errors = np.array(methods.fitted_positions(data, methods.fit_starts(data, truth))) - data.stretches[0].positions
            self.assertLess(math.sqrt(np.mean(errors**2)), quantum, n)

    def test_it_finds_inertias_stiffness_and_backlash(self):
        bench = TwoInertiaBench(duration_s=1.2)
        found = identified(methods.record(bench, 1), methods.record(TwoInertiaBench(duration_s=0.6), 2), model=MODEL)
        self.assertTrue(found.is_converged and methods.holds(found) and is_white(found))
        near(found.errors.normalised, 1, atol=0.1)
        for name, tolerance in (("motor_inertia", 1e-3), ("load_inertia", 1e-3), ("stiffness", 1e-3), ("backlash", 0.01),
                                ("load_coulomb", 0.03)):
            near(of(found)[name].value / getattr(bench, name), 1, atol=tolerance, err_msg=name)
        near(of(found)["delay"].value, bench.delay_s, atol=0.25 / bench.rate_Hz)

    def test_it_says_that_a_bad_fit_is_bad(self):
        found = identified(swaying(methods.record(TwoInertiaBench(backlash=0, duration_s=0.4), 1), 40), model=MODEL)
        self.assertGreater(found.errors.rms, 0.02)
        self.assertGreater(found.errors.normalised, 20)
        self.assertFalse(is_white(found))

    def test_a_constant_speed_shows_no_inertia_no_spring_and_no_backlash(self):
        bench = TwoInertiaBench(mean_input=0.5, swing=0, duration_s=0.5, starts_at_speed=True)
        found = of(identified(methods.record(bench, 3), model=MODEL))
        for name in PARAMETERS[:3] + ["backlash"]:
            self.assertFalse(found[name].is_identifiable, name)
        self.assertIn("resonance", found["stiffness"].excitation)
        self.assertIn("reverse", found["backlash"].excitation)

    def test_intervals_without_play_cover_the_truth(self):
        """The first fit of bench 1 has a play, from which a search leads to the spring without one."""
        bench = TwoInertiaBench(backlash=0, damping=0.03, rate_Hz=500, duration_s=0.6, substeps=2000)
        count = sum(covered(identified(methods.record(bench, seed), model=MODEL), truths_of(bench), seed) for seed in (1, 3))
        # Fewer than 17 of 22 independent intervals cover the truth with a probability of 6e-4.
        self.assertGreaterEqual(count, 17)

    @unittest.skipUnless(BENCHES, "a study")
    def test_intervals_cover_the_truth(self):
        count, errors = 0, []
        for n in range(BENCHES):
            random = np.random.default_rng(1000 + n)
            motor = 10**random.uniform(-3.3, -2.3)
            load = motor * 10**random.uniform(-0.4, 0.7)
            both, reduced = motor + load, motor * load / (motor + load)
            resonance, swing = 2 * math.pi * random.uniform(8, 25), 10**random.uniform(-0.2, 0.3)
            stiffness = resonance**2 * reduced
            viscous, coulomb = both * random.uniform(0.2, 2, 2), swing * random.uniform(0.01, 0.06, 2)
            bench = TwoInertiaBench(
                duration_s=2, motor_inertia=motor, load_inertia=load, stiffness=stiffness, swing=swing,
                damping=2 * random.uniform(0.005, 0.04) * resonance * reduced, motor_viscous=viscous[0],
                load_viscous=viscous[1], motor_coulomb=coulomb[0], load_coulomb=coulomb[1],
                offset=swing * random.uniform(-0.03, 0.03), delay_s=random.uniform(0, 4e-3), bits=random.integers(12, 19),
                noise_counts=random.uniform(0.2, 1.5), substeps=40000,
                backlash=0 if n % 4 == 3 else swing / stiffness * random.uniform(0.05, 0.6))  # each fourth has no play
            found, truths = identified(methods.record(bench, 5000 + n), model=MODEL), truths_of(bench)
            count += covered(found, truths, n)
            errors += [(name, abs(of(found)[name].value / truth - 1)) for name, truth in truths.items() if truth]
        for names, limit in ((("motor_inertia", "load_inertia"), 0.01), (("stiffness",), 0.01), (("backlash",), 0.05)):
            self.assertLessEqual(np.median([error for name, error in errors if name in names]), limit, names)
        self.assertTrue(0.92 <= count / (11 * BENCHES) <= 0.98, count)


if __name__ == "__main__":
    unittest.main()
