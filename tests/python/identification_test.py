"""Identification of simulated axes, whose simulators (identification/bench.h) have their own small steps."""

import math
import os
import unittest

import numpy as np
from scipy.integrate import solve_ivp

import methods
from methods import AxisBench, AxisParameter
from support import near

COLUMNS = ("times_s", "inputs", "positions", "input_times_s", "all_inputs")
BENCHES = int(os.environ.get("BREAKWATER_BENCHES", 0))  # set by the studies, which print each interval


def values(**given):
    """A model's parameters; the others are 0."""
    given = {"torque_constant": 1.0} | given
    return [given.get(name, 0.0) for name in AxisParameter.__members__]


def identified(records, held_out=(), **settings):
    records, held_out = ([one] if isinstance(one, methods.RecordedAxis) else one for one in (records, held_out))
    return methods.identify_axis(records, held_out, methods.IdentificationSettings(**settings))


def of(found):
    return {estimate.parameter.name: estimate for estimate in found.parameters}


def is_white(found):
    return found.whiteness.statistic <= found.whiteness.limit


def changed(record, **columns):
    return methods.RecordedAxis(**{name: getattr(record, name) for name in COLUMNS} | columns)


def swaying(record, rad_s):
    """With a part of the motion that no model explains."""
    return changed(record, positions=np.array(record.positions) + 0.5 * np.sin(rad_s * np.array(record.times_s)))


def without(record, start, count):
    """Without so many rows."""
    keep = np.r_[0:start, start + count:len(record.times_s)]
    return changed(record, **{name: np.array(getattr(record, name))[keep] for name in COLUMNS[:3]})


def covered(found, truths, n):
    """How many intervals hold the truth."""
    count = 0
    for name, truth in truths.items():
        one = of(found)[name]
        holds = one.low <= truth <= one.high
        count += holds
        if BENCHES:
            print("bench", n, name, truth, one.value, one.low, one.high, holds, one.is_identifiable,
                  found.is_bootstrapped, is_white(found))
    return count


class FrictionAxis(unittest.TestCase):
    def end_of(self, input, duration, position=0.0, velocity=0.0, **parameters):
        stretch = methods.AxisStretch(input_times_s=[0], inputs=[input], times_s=[0, 0.3 * duration, duration],
                                      positions=[0] * 3)
        start = methods.AxisStart(position=position, velocity=velocity)
        return methods.friction_axis.move(values(stribeck_speed=parameters.pop("stribeck_speed", 1.0), **parameters),
                                          start, stretch)[-1]

    def test_it_moves_as_in_closed_form(self):
        # Under viscous friction: q = v₀ (1 − e^(−c t/J)) J/c.
        near(self.end_of(0, 4, 1, 3, inertia=2, viscous=0.5), 1 + 12 * (1 - math.exp(-1)), atol=1e-12)
        # Without friction: q = u t²/(2 J).
        near(self.end_of(3, 4, inertia=2), 12, atol=1e-12)
        near(self.end_of(4, 4, inertia=2, offset=1), 12, atol=1e-12)
        # Coulomb friction stops it after J v₀²/(2 F), and it stays there.
        for duration in (4, 40):
            near(self.end_of(0, duration, 0, 1, inertia=2, coulomb=0.5), 2, atol=1e-12)
        # It sticks below the friction, and moves on in the other direction above it.
        self.assertEqual(self.end_of(0.499, 4, 7, 0, inertia=2, viscous=0.1, coulomb=0.5), 7)
        near(self.end_of(-1.5, 3, 0, 1, inertia=2, coulomb=0.5), 0.5 - 0.5 * 0.5 * 4, atol=1e-12)

    def test_breakaway_friction_holds_and_then_falls(self):
        friction = {"inertia": 1, "coulomb": 0.5, "breakaway": 0.3, "stribeck_speed": 0.01}
        self.assertEqual(self.end_of(0.79, 4, **friction), 0)
        # Far above v_s it is Coulomb friction.
        near(self.end_of(0.5, 4, 0, 2, **friction), 8, atol=1e-9)
        # Breakaway ends within 10 ms at a velocity near 0.01, so the rest is almost Coulomb friction.
        near(self.end_of(1.5, 4, **friction), 0.5 * 16, atol=0.05)

    def test_it_moves_through_the_stribeck_friction_as_with_small_steps(self):
        """A pass through standstill and the bump of the friction, beside SciPy's DOP853."""
        plant = values(inertia=4e-3, viscous=8e-3, coulomb=0.05, breakaway=0.04, stribeck_speed=0.8)
        inputs, durations, ends = [-0.2, -0.2, 0.15], [None, 0.05, 0.004], []
        state, t = [0.0, 9.0], 0.0
        for u, duration, sign in zip(inputs, durations, (1, -1, -1)):
            def rate(_, x, u=u, sign=sign):
                return x[1], (u - 8e-3 * x[1] - sign * (0.05 + 0.04 * np.exp(-x[1]**2 / 0.64))) / 4e-3

            def stands(_, x):
                return x[1]
            stands.terminal = duration is None  # the first part ends there
            done = solve_ivp(rate, (0, duration or 10), state, "DOP853", events=stands, rtol=1e-13, atol=1e-14, max_step=1e-3)
            ends.append((t, u, t + done.t[-1], done.y[0, -1]))
            state, t = [done.y[0, -1], done.y[1, -1] if duration else 0.0], t + done.t[-1]
        for _, _, end, position in ends:
            stretch = methods.AxisStretch(input_times_s=[one[0] for one in ends], inputs=inputs, times_s=[0, end],
                                          positions=[0] * 2)
            moved = methods.friction_axis.move(plant, methods.AxisStart(velocity=9), stretch)
            near(moved[-1], position, atol=1e-11)

    def test_the_delay_shifts_the_input(self):
        stretch = methods.AxisStretch(input_times_s=[0, 1], inputs=[0, 2], times_s=[0, 1.25, 2.25], positions=[0] * 3)
        positions = methods.friction_axis.move(values(inertia=1, stribeck_speed=1, delay=0.25), methods.AxisStart(), stretch)
        near(positions[1], 0, atol=1e-15)
        near(positions[2], 1, atol=1e-12)


class Identification(unittest.TestCase):
    def assert_relative(self, found, bench, **tolerances):
        for name, tolerance in tolerances.items():
            truth = getattr(bench, name)
            near(of(found)[name].value, truth, atol=tolerance * truth)

    def test_it_says_that_a_bad_fit_is_bad(self):
        """The fitted noise takes what no model explains, the record's own does not."""
        bench = AxisBench()
        found = identified(swaying(methods.record(bench, 1), 20), swaying(methods.record(bench, 2), 20))
        self.assertGreater(found.errors.rms, 0.1)
        self.assertGreater(found.errors.normalised, 20)
        self.assertFalse(methods.holds(found))

    def test_it_finds_the_parameters_of_a_bench(self):
        bench, quantum = AxisBench(), 2 * math.pi / 2**12
        found = identified(methods.record(bench, 1), methods.record(bench, 2))
        self.assertEqual((found.is_converged, found.is_bootstrapped), (True, False))
        near(found.data.quantum, quantum, atol=1e-9)
        self.assert_relative(found, bench, inertia=1e-3, coulomb=3e-3)
        near(of(found)["offset"].value, bench.offset, atol=3e-4)
        near(of(found)["delay"].value, bench.delay_s, atol=0.25 / bench.rate_Hz)
        near(found.fit.noise_std, 0.5 * quantum, atol=0.05 * quantum)
        self.assertTrue(is_white(found))
        near([found.errors.normalised, found.held_out.normalised], 1, atol=0.1)
        self.assertTrue(methods.holds(found))
        for one in found.parameters:
            self.assertTrue(one.is_identifiable and one.low < one.value < one.high)

    def test_units_change_nothing(self):
        """A motor in mN m, a stage in µm, a clock in ms: the same axis in other units."""
        for has_stribeck in (False, True):
            bench = AxisBench(duration_s=1, breakaway=0.06 * has_stribeck, stribeck_speed=2 if has_stribeck else 1)
            record = methods.record(bench, 3)
            plain = of(identified(record, has_stribeck=has_stribeck))
            for u, q, t in ((2**-20, 1, 1), (2**20, 1, 1), (1, 2**-12, 1), (1, 1, 2**-6), (1, 1, 2**6)):
                found = of(identified(changed(record, inputs=u * np.array(record.inputs), times_s=t * np.array(record.times_s),
                                              positions=q * np.array(record.positions)), has_stribeck=has_stribeck))
                units = {"inertia": u / q * t * t, "viscous": u / q * t, "coulomb": u, "breakaway": u, "stribeck_speed": q / t}
                for name in units.keys() & plain.keys():
                    expected = plain[name].value
                    near(found[name].value / units[name], expected, atol=1e-6 * expected, err_msg=f"{name} {u} {q} {t}")
                    self.assertEqual(found[name].is_identifiable, plain[name].is_identifiable)

    def test_it_finds_a_small_motor(self):
        """With 2e-8 kg m² and 0.3 mN m."""
        bench = AxisBench(inertia=2e-8, viscous=1e-7, coulomb=2e-5, offset=0, swing=1e-3)
        found = identified(methods.record(bench, 1))
        self.assertTrue(of(found)["inertia"].is_identifiable)
        self.assert_relative(found, bench, inertia=0.01)

    def assert_no_inertia(self, record, truth):
        inertia = of(identified(record))["inertia"]
        self.assertFalse(inertia.is_identifiable)
        self.assertTrue(inertia.low <= truth <= inertia.high)

    def test_a_constant_torque_shows_no_inertia(self):
        """q = ½ (T − offset − friction)/J t²: any inertia fits."""
        for inertia in (1e-3, 4e-3):
            for torque in (-1, 0.12, 0.3, 3, 10):
                self.assert_no_inertia(methods.record(AxisBench(swing=0, inertia=inertia, mean_input=torque), 1), inertia)

    def test_an_exact_record_of_a_constant_torque_shows_no_inertia(self):
        """Without an encoder, and hardly any noise: the curvature at the fit must not look like knowledge."""
        t = 1e-3 * np.arange(1000)
        for viscous in (1e-4, 4e-3):
            for noise in (0, 1e-6):
                rate = viscous / 1e-3
                q = (t + np.expm1(-rate * t) / rate) / viscous + noise * np.random.default_rng(1).normal(size=1000)
                self.assert_no_inertia(methods.RecordedAxis(times_s=t, inputs=np.ones(1000), positions=q), 1e-3)

    def test_draws_have_the_intervals_and_the_correlations(self):
        found = identified(methods.record(AxisBench(), 1))
        plants = methods.drawn_plants(found, 1024)
        viscous, coulomb, phase = ([plant[key] for plant in plants]
                                   for key in ("viscous_Nms", "coulomb_Nm", "phase"))
        # The draws have the longer side of an interval.
        for drawn, one in ((viscous, of(found)["viscous"]), (coulomb, of(found)["coulomb"])):
            near(np.std(drawn) / ((one.high - one.low) / 2 / 1.959963984540054), 1, atol=0.1)
        correlation, covariance = np.corrcoef(viscous, coulomb)[0, 1], methods.covariance_of(found)
        near(correlation, covariance[1, 2] / math.sqrt(covariance[1, 1] * covariance[2, 2]), atol=0.05)
        self.assertLess(correlation, -0.3)
        near(np.ptp(phase) / (2 * math.pi / 2**12), 1, atol=0.01)

    def test_without_noise_the_intervals_come_from_a_bootstrap(self):
        bench = AxisBench(noise_counts=0, duration_s=1.5)
        found = identified(methods.record(bench, 3))
        self.assertTrue(found.is_bootstrapped)
        self.assert_relative(found, bench, inertia=1e-3)
        self.assertLess(of(found)["inertia"].low, of(found)["inertia"].high)

    def test_it_finds_the_stribeck_friction(self):
        bench = AxisBench(breakaway=0.06, stribeck_speed=0.8, swing=0.5)
        record = methods.record(bench, 11)
        found = identified(record, methods.record(bench, 12), has_stribeck=True)
        self.assertTrue(found.is_converged and methods.holds(found))
        self.assert_relative(found, bench, breakaway=0.1, stribeck_speed=0.1, coulomb=0.03)
        plain = identified(record)
        self.assertGreater(plain.errors.rms, 3 * found.errors.rms)
        self.assertFalse(is_white(plain))

    def test_the_torque_constant_follows_from_a_known_inertia(self):
        bench = AxisBench()
        record = methods.record(bench, 4)
        found = identified(changed(record, inputs=np.array(record.inputs) / 0.07), known_inertia=bench.inertia)  # now in A
        near(of(found)["torque_constant"].value, 0.07, atol=1e-4)
        self.assert_relative(found, bench, coulomb=3e-3)

    def test_a_gap_begins_a_new_stretch_and_many_short_ones_are_bridged(self):
        bench = AxisBench()
        record = without(without(methods.record(bench, 5), 2000, 200), 700, 2)
        found = identified(record)
        self.assertEqual(len(found.data.stretches), 3)
        self.assert_relative(found, bench, inertia=2e-3)
        self.assertTrue(is_white(found))
        for start in range(100, 2500, 150):
            record = without(record, start, 2)
        bridged = methods.axis_data([record], False, 0).stretches
        self.assertEqual(len(bridged), 2)
        self.assertGreater(len(bridged[0].inputs), len(bridged[0].times_s) + 20)

    def test_inputs_of_rows_without_a_position_still_act(self):
        record = methods.record(AxisBench(), 5)
        record = changed(record, input_times_s=record.times_s, all_inputs=record.inputs)
        for start in range(100, 2500, 150):
            record = without(record, start, 2)
        found = identified(record)
        self.assertEqual(len(found.data.stretches), 1)
        self.assertTrue(is_white(found))

    def test_it_says_what_a_record_cannot_show(self):
        steady = of(identified(methods.record(AxisBench(mean_input=0.5, swing=0, starts_at_speed=True), 6)))
        self.assertFalse(steady["inertia"].is_identifiable or steady["delay"].is_identifiable)
        # From rest: J, c, F_C and d₀ are known up to a factor.
        one_torque = AxisBench(mean_input=0.5, swing=0)
        one_step = methods.record(one_torque, 16)
        one_step.inputs = [0.0] * 5 + one_step.inputs[5:]
        for record in (methods.record(one_torque, 15), one_step):
            found = of(identified(record))
            for name in ("inertia", "viscous", "coulomb", "offset"):
                self.assertFalse(found[name].is_identifiable, name)
            self.assertIn("torque", found["inertia"].excitation)
        forward = of(identified(methods.record(AxisBench(mean_input=1, swing=0.5), 7)))
        self.assertTrue(forward["inertia"].is_identifiable and forward["viscous"].is_identifiable)
        for name, other in (("coulomb", "offset torque"), ("offset", "Coulomb friction")):
            self.assertFalse(forward[name].is_identifiable)
            self.assertIn("not separate it from: ", forward[name].reason)
            self.assertIn(other, forward[name].reason)
            self.assertIn("reverse", forward[name].excitation)

    def test_a_held_out_record_of_another_axis_fails(self):
        other = methods.record(AxisBench(inertia=1.1 * AxisBench().inertia), 9)
        self.assertFalse(methods.holds(identified(methods.record(AxisBench(), 8), other)))

    def test_records_of_two_axes_do_not_give_a_white_fit(self):
        other = AxisBench(duration_s=1.5, inertia=3 * AxisBench().inertia, bits=16)
        found = identified([methods.record(AxisBench(duration_s=1.5), 13), methods.record(other, 14)])
        self.assertEqual(len(found.parameters), 5)
        self.assertFalse(found.is_converged and is_white(found))

    def test_records_without_motion_or_input_are_refused(self):
        record = methods.record(AxisBench(), 10)
        rows = len(record.times_s)
        for wrong in ([changed(record, positions=np.ones(rows))], [changed(record, inputs=np.zeros(rows))], []):
            self.assertRaises(ValueError, identified, wrong)

    def test_the_step_of_rounded_times_is_found(self):
        k = np.arange(500)
        t = (k + np.random.default_rng(1).uniform(-0.05, 0.05, 500)) / 1300
        rounded = 1e-5 * np.round(1e5 * t)
        for exact in (t, 1e-6 * np.round(1e6 * k / 1300)):
            self.assertEqual(methods.rounding_step(exact), 0)
        for late in (0, 1.7e9):
            near(methods.rounding_step(late + rounded) / 1e-5, 1, atol=1e-15)


def random_bench(n, stamp_s=0.0):
    """Each eighth bench has no noise, so that its intervals come from the bootstrap."""
    random = np.random.default_rng(1000 + n)
    inertia, rate_Hz = 10**random.uniform(-3.2, -2), 500 * 8**random.uniform()
    return AxisBench(
        stamp_s=stamp_s, inertia=inertia, viscous=inertia * random.uniform(0.5, 5), coulomb=random.uniform(0.02, 0.15),
        offset=random.uniform(-0.05, 0.05), rate_Hz=rate_Hz, delay_s=random.uniform(0, 4) / rate_Hz,
        bits=random.integers(8, 21), noise_counts=0 if n % 8 == 7 else random.uniform(0.2, 2))


def truths_of(bench, *more):
    names = ("inertia", "viscous", "coulomb", "offset", *more)
    return {name: getattr(bench, name) for name in names} | {"delay": bench.delay_s}


def coverage_of(benches, stamp_s):
    """The share of covered parameters, the number of white fits and the median errors, of random benches."""
    count, white, errors = 0, 0, []
    for n in range(benches):
        bench = random_bench(n, stamp_s)
        found = identified(methods.record(bench, 5000 + n))
        white += is_white(found)
        count += covered(found, truths_of(bench), n)
        errors.append([abs(of(found)["inertia"].value / bench.inertia - 1),
                       abs(of(found)["coulomb"].value / bench.coulomb - 1),
                       abs(of(found)["delay"].value - bench.delay_s) * bench.rate_Hz])
    return count / (5 * benches), white, np.median(errors, axis=0)


class Coverage(unittest.TestCase):
    def test_intervals_cover_the_truth(self):
        share, _, (inertia, coulomb, delay) = coverage_of(BENCHES or 16, 0)
        self.assertLessEqual(inertia, 0.01)
        self.assertLessEqual(coulomb, 0.03)
        self.assertLessEqual(delay, 0.25)
        # Fewer than 68 of 80 independent intervals cover the truth with a probability of 1e-4.
        self.assertTrue(0.93 <= share <= 0.97 if BENCHES >= 300 else share >= 0.85, share)

    def test_intervals_cover_the_truth_with_stribeck_friction(self):
        """One bench of eight may end in a wrong minimum. Its residuals are not white, so its intervals are said to be too
        narrow. The simulator needs smaller steps here."""
        count = white = 0
        for n in range(BENCHES or 8):
            bench, random = random_bench(n), np.random.default_rng(n)
            bench.breakaway, bench.stribeck_speed = bench.coulomb * random.uniform(0.3, 0.8), random.uniform(0.3, 2)
            bench.substeps, bench.rate_Hz, bench.noise_counts = 400, 500, max(bench.noise_counts, 0.2)
            found = identified(methods.record(bench, 5000 + n), has_stribeck=True)
            if is_white(found):
                white += 1
                count += covered(found, truths_of(bench, "breakaway", "stribeck_speed"), n)
        self.assertGreaterEqual(white, 7 * (BENCHES or 8) // 8)
        # Fewer than 40 of 49 independent intervals cover the truth with a probability of 2e-4.
        self.assertGreaterEqual(count, 0.82 * 7 * white)

    def test_intervals_cover_the_truth_with_rounded_times(self):
        """Digits of 1 µs, unless BREAKWATER_STAMP_S says another step. Without the rounding in the likelihood: 0.78
        of 350, and 58 of 70 white."""
        share, white, _ = coverage_of(BENCHES or 8, float(os.environ.get("BREAKWATER_STAMP_S", 1e-6)))
        self.assertGreaterEqual(share, 0.85)
        self.assertGreaterEqual(white, 7 * (BENCHES or 8) // 8)


if __name__ == "__main__":
    unittest.main()
