"""Second implementations on the logs of runs. They have each metric from the rows of the scenario's
file, the laws of the arm and of a motor, the drive's friction, and impacts."""

import itertools
import pathlib
import re
import tomllib
import unittest
import warnings

import numpy as np
from scipy.integrate import solve_ivp

import breakwater as bw
from support import near

INF = np.inf
SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "scenarios"
WALL = {"run.duration_s": 17, "wall.solid_from_s": 9, "force.from_s": 10, "record.fine_from_s": 0,
        "record.fine_to_s": 17, "metrics.from_s": 13, "metrics.to_s": 16}
# Case, keys, names that are neither keys nor events, and metrics that the log does not suffice for.
RUNS = (
    ("motor_estimation", "mdob", {"encoder.bits": 8}, {}, "lambda_mean_1 lambda_min_1"),
    ("motor_estimation", "vfakfd", {"encoder.bits": 8, "drive.limit_Nm": 10.5,
                                    "disturbance.start_s": 2, "disturbance.kind": "two_sines"},
     {}, ""),
    ("cart_position", "mdob", {"run.duration_s": 10}, {}, ""),
    ("cart_estimation", "gamma-1.02", {"metrics.from_s": 20, "metrics.to_s": 40}, {}, ""),
    ("cart_offset_free", "proposed",
     {"noise.enabled": True, "metrics.from_s": 30, "metrics.to_s": 40}, {}, ""),
    ("cart_constrained", "proposed-idob", {}, {"push_s": 0}, ""),
    ("two_inertia", "sf-kfd", {}, {"last_step": 0.1},
     "rmse_disturbance_Nm rmse_load_velocity_rad_s"),
    ("impact_test", "hertz", {"record.fine_from_s": 0, "record.fine_to_s": 10}, {},
     "bounce_count contact_impulse_Ns restitution"),
    ("arm_push", "proposed-link2", {}, {"release": 5}, ""),
    ("arm_push", "hpfc-link2", {}, {"release": 5}, ""),  # returns in another posture
    # Each error of the tip counts as a return, but the joints are still where they were pushed.
    ("arm_push", "proposed-link2", {"run.duration_s": 5.2, "metrics.settled_within_m": 10},
     {"release": 5}, ""),
    ("arm_wall_contact", "proposed-2N", {**WALL, "contact.stiffness_N_m": 5000},
     {"force_control": 10}, "impact_mass_kg impact_velocity_m_s"),
    ("quadrotor_waves", "resonator", {"run.duration_s": 20, "metrics.window_s": 8}, {},
     "attitude_estimate_rmse_rad converged horizontal_force_rmse_N horizontal_force_rmse_of_zero_N"
     " nees_mean position_estimate_rmse_m position_measurement_rmse_m roll_rate_rmse_rad_s"
     " vertical_force_rmse_N"),
    ("plant", "idob", {}, {}, ""),
)


def rms(x):
    return np.sqrt(np.mean(np.square(x)))


class Window:
    """The values of a row within its window, and what it compares them with."""

    def __init__(self, times, values, is_inside, is_before, numbers, period_s):
        self.t, self.x, self.period_s = times[is_inside], values[is_inside], period_s
        self.v = self.x[:, 0]
        self.before = values[is_before, 0][-1:]  # the value before the window
        self.start, self.end, self.level, self.lower = numbers

    def since(self, fits):
        return self.t[np.argmax(fits)] - self.start if fits.any() else None

    def rises(self, v):
        return np.sum((v[1:] > self.level) & (v[:-1] <= self.level))

    def settled(self):
        outside = np.flatnonzero(np.abs(self.v) > abs(self.level))
        first = outside[-1] + 1 if len(outside) else 0
        return self.t[first] - self.start if first < len(self.v) else None

    def decay(self):
        fifth = (self.end - self.start) / 5
        early, late = self.t < self.start + fifth - 1e-9, self.t >= self.end - fifth - 1e-9
        first = np.std(self.v[early], ddof=1)
        return np.std(self.v[late & (self.t < self.end - 1e-9)], ddof=1) / first if first else None

    def all(self):
        return np.concatenate([self.before, self.v])


def beyond(x):
    """The farthest value of a column beyond 0, on the other side of its first one."""
    return max(0, np.max(np.where(x[0] > 0, -1, 1) * x))


def posture_overshoot(w):
    joints, tip_error = w.x[:, :-1], w.x[-1, -1]
    farthest, last = beyond(joints), np.abs(joints[-1]).max()
    return max(farthest, last) if tip_error <= w.level and last > 0.2 else farthest


def turns(values, level):
    """How often they turn back by more than the level."""
    count, direction, least, most = 0, 0, values[0], values[0]
    for value in values:
        least, most = min(least, value), max(most, value)
        if direction >= 0 and value < most - level or direction <= 0 and value > least + level:
            count += direction != 0
            direction = -direction or (1 if value > least + level else -1)
            least = most = value
    return count


KINDS = {
    "rms": lambda w: rms(w.v), "rmse": lambda w: rms(w.v),
    "mean": lambda w: np.mean(w.v), "running_mean": lambda w: np.mean(w.v),
    "max": lambda w: w.v.max(), "min": lambda w: w.v.min(), "peak": lambda w: np.abs(w.v).max(),
    "std": lambda w: np.std(w.v, ddof=1), "deviation": lambda w: np.abs(w.v - w.v.mean()).max(),
    "excess": lambda w: max(0.0, w.v.max()), "first": lambda w: w.v[0], "last": lambda w: w.v[-1],
    "rms_change": lambda w: rms(np.diff(w.all())), "travel": lambda w: np.abs(np.diff(w.v)).sum(),
    "integral": lambda w: w.period_s * w.v.sum(),
    "settling": Window.settled, "settled": Window.settled,
    "reach": lambda w: w.since(np.abs(w.v) >= abs(w.level)) if w.level else None,
    "exceed": lambda w: w.since(w.v > w.level), "beyond": lambda w: beyond(w.x),
    "overshoot": lambda w: 100 * beyond(w.v) / abs(w.v[0]),
    "time": lambda w: w.period_s * np.sum(w.v > w.level),
    "time_outside": lambda w: w.period_s * np.sum((w.v > w.level) | (w.v < w.lower)),
    "bounces": lambda w: w.rises(w.all()) - 1 if w.rises(w.all()) else None,
    "rises": lambda w: w.rises(w.v), "rise_rate": lambda w: w.rises(w.v) / (w.end - w.start),
    "decay": Window.decay, "relative_rms": lambda w: rms(w.x[:, 0] - w.x[:, 1]) / rms(w.x[:, 1]),
    "rms_per_value": lambda w: rms(w.x),
    "posture_overshoot": posture_overshoot,
    "reversals": lambda w: max(turns(column, w.level) for column in w.x.T),
}
TAKEN = {"value": lambda x: x, "largest": lambda x: x.max(axis=1, keepdims=True),
         "largest_size": lambda x: np.abs(x).max(axis=1, keepdims=True),
         "norm": lambda x: np.linalg.norm(x, axis=1, keepdims=True)}


class Metrics(unittest.TestCase):
    def expect_metrics(self, scenario, case, sets, known, missing):
        run = bw.run(scenario, case, set=sets)
        known = dict(known)
        # The arm is at its start pose first.
        moved = {"x_offset_m": "x_true_m", "y_offset_m": "y_true_m",
                 "phi_offset_rad": "phi_true_rad", "joint_offset_rad": "q_true_rad"}
        if "physics/force_true_N" in run:
            t, touches = run["physics/time_s"], run["physics/force_true_N"] > 0
            touches = touches & (t >= known.get("force_control", 0))
            first = np.argmax(touches)
            known["first_contact"] = t[first]
            known["first_separation"] = t[first + np.argmax(~touches[first:])]

        def number(text):
            def value(name):
                found = known.get(name[0], run.config)
                for part in name[0].split(".") if found is run.config else ():
                    found = found[part]
                return repr(float(found))
            return eval(re.sub(r"[a-z]\w*(\.\w+)?", value, str(text)))

        def again(name, row):
            """The metric; nothing if it does not apply. LookupError if the log does not suffice."""
            is_fine = row.get("at", "step" if scenario == "impact_test" else "") == "step"
            track = "physics/" if is_fine and "physics" in run.groups else ""
            t = run[track + "time_s"]

            def signal(name):
                if name == "force_reference_N":
                    return np.full((len(t), 1), 2.0)
                if name == "tip_error_m":
                    return np.hypot(signal("x_offset_m"), signal("y_offset_m"))
                values = run[track + moved.get(name, name)].reshape(len(t), -1)
                return values - values[0] if name in moved else values

            names = [*row["of"].split(", "), *filter(None, [row.get("minus")])]
            signals = [signal(name) for name in names]
            x = np.hstack(signals)
            if "minus" in row:
                x = np.hstack(signals[:-1])
                x[:, 0] -= signals[-1][:, 0]
            x = TAKEN[row.get("take", "value")](x)
            is_open, is_before = "to_s" not in row, "before_s" in row
            end_s = run.config["run"]["duration_s"]
            start = number(row.get("from_s", 0))
            end = end_s if is_open else number(row["to_s"])
            if start < 0 or end > end_s:
                return None
            end = number(row["before_s"]) if is_before else end
            early = t < start - (1e-9 if is_before else 0)
            late = t >= end - 1e-9 if is_before else (t > end + 1e-9) & (row["kind"] != "settled")
            numbers = start, end, number(row.get("level", 0)), number(row.get("lower", 0))
            period_s = run.config["physics" if is_fine else "control"][
                "timestep_s" if is_fine else "period_s"]
            if (early | late).all():
                return None
            return KINDS[row["kind"]](Window(t, x, ~(early | late), early, numbers, period_s))

        rows = tomllib.loads((SCENARIOS / scenario / f"{scenario}.toml").read_text())["metric"]
        elsewhere = [f"it is defined only where {row.get('where')}" for row in rows.values()]
        lacking, found = [], 0
        for table, row in rows.items():
            name = row.get("name", table)
            name = next((own for own in run.metrics if own.startswith(name + "_")), name)
            if "where" in row and run.absent.get(name) in elsewhere:
                continue
            with self.subTest(name):
                try:
                    value = again(name, row)
                except LookupError:
                    lacking.append(name)
                    continue
                self.assertEqual(value is not None, name in run.metrics, run.absent.get(name))
                if value is not None:
                    found += 1
                    np.testing.assert_allclose(run.metrics[name], value, rtol=1e-9, atol=1e-9)
        self.assertGreater(found, 2)
        self.assertEqual(sorted(lacking), missing.split())
        return run.metrics

    def test_each_is_that_of_its_log(self):
        found = []
        for row in RUNS:
            with self.subTest(row[:2]):
                found.append(self.expect_metrics(*row))
        for name in ("bounce_count", "late_bounce_count", "force_frequency_Hz", "reversal_count"):
            self.assertGreater(max(metrics.get(name, 0) for metrics in found), 1, name)
        pushed = [metrics for metrics in found if "posture_overshoot_rad" in metrics]
        self.assertTrue(any(metrics["posture_overshoot_rad"] == 0 and metrics["overshoot_rad"] > 1
                            for metrics in pushed))

    def test_absent_ones_say_why(self):
        not_reached = "the run does not reach "
        for scenario, sets, duration_s, absent, present in (
            ("arm_wall_contact", WALL, 9.9, {
                "free_motion_time_s": "the run does not cover its window, from force_control to the"
                                      " run's end"}, ()),
            ("arm_wall_contact", WALL, 10.4, {
                "peak_force_raw_N": not_reached + "first_contact", "bounce_count": "",
                "free_motion_time_s": "the value never rises above the level"},
             ["saturated_time_s"]),
            ("arm_wall_contact", WALL, 10.6, {
                "contact_impulse_Ns": not_reached + "first_contact + 0.2"}, ["peak_force_raw_N"]),
            ("arm_wall_contact", WALL, 15.9, {"mean_force_error_N": not_reached}, ()),
            ("arm_wall_contact", WALL, 16.0, {}, ["mean_force_error_N"]),
            ("arm_push", {}, 2.0, {"max_push_rad": ""}, ()),
            ("arm_push", {}, 4.9, {"overshoot_rad": ""}, ["max_push_rad"]),
            ("arm_push", {}, 5.2, {"settling_time_s": "the magnitude ends beyond the level"},
             ["overshoot_rad"]),
            ("motor_estimation", {"metric.d.of": "saturated", "metric.d.kind": "decay",
                                  "metric.d.unit": "1"}, 5.0, {
                "d": "the value is constant in the window's first fifth"}, ()),
        ):
            with self.subTest(scenario, duration_s=duration_s):
                run = bw.run(scenario, set={**sets, "run.duration_s": duration_s})
                for name, reason in absent.items():
                    self.assertNotIn(name, run.metrics)
                    self.assertIn(reason, run.absent[name])
                self.assertLessEqual(set(present), set(run.metrics))

    def test_the_impact_has_the_speed_of_the_tip(self):
        run = bw.run("arm_wall_contact", "hpfc-2N", set=WALL)
        k = np.searchsorted(run.time_s, 10 + run.metrics["free_motion_time_s"]) - 1
        speed = np.diff(run["x_true_m"])[k] / 1e-3
        self.assertAlmostEqual(run.metrics["impact_velocity_m_s"] / speed, 1, delta=0.01)

    def test_the_raw_velocity_is_the_raw_difference(self):
        run = bw.run("motor_estimation", "mdob", set={"encoder.bits": 8})
        raw = np.diff(run["position_measured_rad"]) / np.diff(run.time_s)
        np.testing.assert_allclose(run["velocity_raw_rad_s"], [0, *raw], atol=1e-6)

    def test_the_lag_of_a_ramp_is_its_mean_error_over_its_slope(self):
        run = bw.run("cart_estimation", "order1", set={"disturbance.kind": "ramp"})
        d, window = run["d_true_N"], (run.time_s >= 40) & (run.time_s <= 50)
        late = np.mean((d - run["d_hat_N"])[window]) / ((d[-1] - d[-2]) / run.time_s[1])
        self.assertAlmostEqual(run.metrics["disturbance_lag_s"], late, delta=1e-9)

    def test_the_lag_of_a_sine_is_the_delay_that_fits_best(self):
        """But for a gain, d shifted by it fits better than with a smaller or larger shift."""
        run = bw.run("cart_estimation", "order2", set={"disturbance.kind": "sine"})
        d, d_hat, period_s = run["d_true_N"], run["d_hat_N"], run.time_s[1]

        def misfit(delay_s):
            i = np.arange(round(20 / period_s), len(d))
            there = i - round(delay_s / period_s)
            i, there = i[there < len(d)], there[there < len(d)]
            return d_hat[i] @ d_hat[i] - (d_hat[i] @ d[there]) ** 2 / (d[there] @ d[there])

        lag_s = run.metrics["disturbance_lag_s"]
        self.assertLess(misfit(lag_s), min(misfit(lag_s - 1), misfit(lag_s + 1)))


def responses(count, bases, t_ref_s, T=1e-3):
    """Coincidence points of a PFC with their decay, and the positions there of a double integrator
    under (i T)^l (Eqs. 2.71, 2.72)."""
    h = np.array([int(t_ref_s / T / (count - j) + 1e-9) for j in range(count)])
    i = np.arange(h.max()) * T
    step = np.maximum(0, h[:, None] - 1 - np.arange(h.max())) * T * T
    return h * T, np.exp(-3 * h * T / t_ref_s), step @ np.vander(i, bases, increasing=True)


class Laws(unittest.TestCase):
    def wall(self, case, **sets):
        run = bw.run("arm_wall_contact", case, set={
            "run.duration_s": 7, "wall.solid_from_s": 3, "force.from_s": 4, "record.fine_from_s": 0,
            "record.fine_to_s": 0, **sets})
        return run, bw.PlanarChain("models/arm.urdf")

    def samples(self, run, chain):
        """q, q', Jacobian, pose error and force error of some samples in regular postures."""
        start, found = chain.tip_pose(run.config["task"]["start_angles_rad"]), []
        for k in range(100, len(run.time_s), 50):
            q, dq = run["q_hat_rad"][k], run["dq_hat_rad_s"][k]
            J, is_pressing = chain.tip_jacobian(q), run.time_s[k] > 4 - 1e-9
            force_error = 2 - run["force_measured_N"][k] if is_pressing else 0.0
            if np.linalg.svd(J)[1][-1] > 0.02:
                found.append((k, q, dq, J, start - chain.tip_pose(q), is_pressing, force_error))
        self.assertGreaterEqual(len(found), 50)
        self.assertTrue(any(force_error not in (0, 2) for *_, force_error in found))
        return found

    def test_hpfc_follows_equations_2_89_to_2_91(self):
        run, chain = self.wall("hpfc-2N")
        inertia = run.config["observer"]["nominal_inertia_kgm2"]
        near(run["torque_command_Nm"], inertia * run["ddq_ref_rad_s2"] + run["d_hat_Nm"],
             atol=1e-13)
        self.assertGreater(np.abs(run["d_hat_Nm"]).max(), 0.1)
        for k, q, dq, J, error, is_pressing, force_error in self.samples(run, chain):
            error[0] *= not is_pressing
            expected = np.linalg.solve(J, 30 * error - 2 * np.sqrt(30) * (J @ dq))
            expected += 40 * J[0] * force_error
            near(run["ddq_ref_rad_s2"][k], expected, atol=1e-9)

    def test_drac_gives_the_tip_the_resolved_acceleration(self):
        """J a + J' q' is K_p e - K_d X' (Eq. 2.93), with x's reference from the force error."""
        run, chain = self.wall("drac-2N")
        for k, q, dq, J, error, is_pressing, force_error in self.samples(run, chain):
            rate = chain.tip_jacobian(q + 1e-5 * dq) - chain.tip_jacobian(q - 1e-5 * dq)
            bias = rate @ dq / 2e-5
            if is_pressing:
                error[0] = force_error / 20
            near(J @ run["ddq_ref_rad_s2"][k] + bias, 15 * error - 2 * np.sqrt(15) * (J @ dq),
                 atol=1e-8)

    def test_proposed_chains_its_parts(self):
        """Inverse kinematics (Eqs. 2.65 to 2.68), predictive functional control (Eqs. 2.78, 2.80)
        and the limits of the torque (Eq. 2.84)."""
        limits = bw.PlanarChain("models/arm.urdf").effort_limits_Nm
        for count, bases, t_ref_s in ((3, 3, 1.0), (8, 2, 0.8), (1, 1, 0.5)):
            run, chain = self.wall("proposed-2N", **{
                "controller.coincidence_points": count, "controller.basis_functions": bases,
                "controller.t_ref_s": 3 * [t_ref_s], "force.reference_N": 2})
            inertia = run.config["observer"]["nominal_inertia_kgm2"]
            way, decay, basis = responses(count, bases, t_ref_s)
            limited = 0
            for k, q, dq, J, error, is_pressing, force_error in self.samples(run, chain):
                q_ref = np.array(run.config["task"]["start_angles_rad"])
                if is_pressing:
                    error[0] = force_error / 20
                    weights = np.array([100, 100, 10])
                    normal = J.T @ (weights[:, None] * J) + np.diag(np.abs(error) + 1e-8)
                    q_ref = q + np.linalg.solve(normal, J.T @ (weights * error) + error)
                    near(run["x_ref_m"][k], chain.tip_pose(q)[0] + error[0], atol=1e-15)
                near(run["q_ref_rad"][k], q_ref, atol=1e-12)
                missing = (1 - decay)[:, None] * (q_ref - q) - way[:, None] * dq
                a = np.linalg.lstsq(basis, missing, rcond=None)[0][0]
                d = run["d_hat_Nm"][k]
                expected = np.clip(a, (-limits - d) / inertia, (limits - d) / inertia)
                limited += (a != expected).any()
                near(run["ddq_ref_rad_s2"][k], expected, atol=1e-9)
            most = (np.abs(run["torque_command_Nm"]) / limits).max()
            self.assertLessEqual(most, 1 + 1e-12)
            if t_ref_s == 1.0:
                self.assertGreater(limited, 0)
                self.assertGreaterEqual(most, 1 - 1e-12)

    def test_by_the_tip_it_holds_its_posture_before_force_control(self):
        run, chain = self.wall("proposed-2N", **{"controller.positioning": "workspace"})
        before = run.time_s < 4 - 1e-9
        self.assertGreater(np.abs(np.diff(run["q_ref_rad"][before], axis=0)).max(), 1e-6)
        start = chain.tip_pose(run.config["task"]["start_angles_rad"])
        near(run["x_ref_m"][before], start[0], atol=1e-15)

    def test_force_control_starts_at_its_sample(self):
        """Also if its time has a rounding error."""
        for from_s in (4, 4 - 1e-13, 4 + 1e-13):
            run, _ = self.wall("hpfc-2N", **{"force.from_s": from_s, "run.duration_s": 5})
            x_ref = run["x_ref_m"]
            self.assertEqual(np.flatnonzero(x_ref != x_ref[0])[0], 4000)

    def test_a_motors_pd_follows_equation_4_22(self):
        run = bw.run("motor_estimation", "idob")
        gains = run.config["controller"]
        expected = (gains["kp"] * (run["reference_rad"] - run["position_hat_rad"])
                    - gains["kd"] * run["velocity_hat_rad_s"] + run["d_hat_Nm"])
        near(run["command_Nm"], expected, atol=1e-12)

    def test_a_weight_on_the_disturbance_changes_no_input(self):
        """The printed "pseudo-feedback" has no effect."""
        with_it, without = (bw.run("cart_offset_free", "proposed",
                                   set={"controller.q_disturbance": weight})["command_N"]
                            for weight in (1e6, 0))
        near(with_it, without, atol=1e-9)

    def test_the_poles_of_variable_and_of_fixed_factors(self):
        """At rest those of the variable factor are near 1, and those of a fixed one well inside
        (Figs 4.40-4.43)."""
        for case, least, most in (("vfakfd", 0.9995, INF), ("fakfd-095", 0, 0.995)):
            run = bw.run("motor_estimation", case, duration=30, set={
                "encoder.bits": 48, "control.period_s": 1e-3, "noise.std_rad": 0.1,
                "observer.alpha": 100, "observer.lambda": 0.98})
            last = np.hypot(run["poles_discrete_re"][-1], run["poles_discrete_im"][-1]).max()
            self.assertTrue(least < last < most, last)


# Parts of the motor's drive: keys, and the signals that they add.
STRIBECK = {"friction.law": "stribeck", "friction.static_ratio": 1.5,
            "friction.stribeck_velocity": 0.05}
PARTS = (
    ({"plant.coulomb_friction_Nm": 0.5, **STRIBECK}, {"friction_Nm"}),
    ({"plant.coulomb_friction_Nm": 0.5, **STRIBECK, "friction.law": "lugre",
      "friction.bristle_stiffness": 1e4, "friction.bristle_damping": 10}, {"friction_Nm"}),
    ({"plant.coulomb_friction_Nm": 0.5, "friction.law": "load_dependent",
      "friction.load_ratio": 0.1}, {"friction_Nm"}),
    ({"drive.current_bandwidth_rad_s": 200}, {"current_A", "motor_Nm"}),
    ({"drive.voltage_limit_V": 24, "drive.resistance_ohm": 2, "drive.inductance_H": 1e-3},
     {"current_A", "motor_Nm"}),
    ({"drive.cogging_Nm": 0.1, "drive.cogging_per_turn": 12}, {"current_A", "motor_Nm"}),
    ({"drive.ripple_ratio": 0.05, "drive.ripple_per_turn": 6}, {"current_A", "motor_Nm"}),
    ({"control.delay_s": 1.5e-3}, set()), ({"control.jitter_s": 1e-3}, set()),
    ({"control.drop_probability": 0.1}, set()), ({"encoder.eccentricity_rad": 1e-3}, set()),
    ({"encoder.interpolation_rad": 1e-3, "encoder.interpolation_per_turn": 64}, set()),
)


class Drive(unittest.TestCase):
    def test_the_true_disturbance_has_the_dry_friction(self):
        """The balance of momentum over a sample gives d, since the inertia is 1 kg m^2 and the
        drive ideal. If the shaft sticks after a step, an observer finds all of d."""
        for law in ({"friction.law": "coulomb"}, STRIBECK,
                    {"friction.law": "load_dependent", "friction.load_ratio": 0.1}):
            law = {**law, "plant.coulomb_friction_Nm": 0.5}
            run = bw.run("motor_estimation", "dkf", duration=10,
                         set={**law, "disturbance.kind": "two_sines"})
            v = run["velocity_true_rad_s"]
            slides = (np.abs(v[:-1]) >= 0.02) & (v[:-1] * v[1:] >= 0)
            slides[:1500] = False
            self.assertGreater(slides.sum(), 1000)
            balance = run["applied_Nm"][:-1] - np.diff(v) / 1e-3
            np.testing.assert_allclose(run["d_true_Nm"][:-1][slides], balance[slides], atol=0.02)
            self.assertTrue((run["friction_Nm"] * v < 0)[:-1][slides].all())
            held = bw.run("motor_estimation", "dkf", set=law)
            self.assertLess(held.metrics["rmse_disturbance_Nm"], 0.1)

    def motor(self, u, steps, step_s=1e-4, plant={}, **keys):
        """The motor under a constant command."""
        class Constant(bw.Controller):
            def update(self, t, y):
                return u

        return bw.run("motor_estimation", controller=Constant(), set={
            "physics.timestep_s": step_s, "control.period_s": step_s, "disturbance.kind": "none",
            "run.duration_s": step_s * steps, **plant,
            **{f"drive.{key}": value for key, value in keys.items()}})

    def test_the_current_loop_has_the_step_response_of_its_closed_form(self):
        """w^2/(s^2 + 2 z w s + w^2), or w/(s + w). The force of the first order is the mean over a
        step, so that its impulse is exact."""
        for omega, zeta in itertools.product((50.0, 1000.0, 3e4), (0.0, 0.3, 0.7, 1.0, 2.5)):
            run = self.motor(1.0, 300, current_bandwidth_rad_s=omega, current_damping_ratio=zeta,
                             torque_constant_Nm_A=0.5)
            t = run.time_s
            if zeta == 0.0:
                expected = -np.expm1(-omega * t)
                impulse = t + np.expm1(-omega * t) / omega
                np.testing.assert_allclose(run["velocity_true_rad_s"], impulse, atol=1e-11)
            elif zeta == 1.0:
                expected = 1 - np.exp(-omega * t) * (1 + omega * t)
            else:
                root = np.sqrt(zeta**2 - 1 + 0j)
                a, b = omega * (-zeta + root), omega * (-zeta - root)
                expected = np.real(1 + (b * np.exp(a * t) - a * np.exp(b * t)) / (a - b))
            np.testing.assert_allclose(run["current_A"], 2 * expected, atol=2e-7, err_msg=zeta)

    def test_limits_of_current_and_voltage(self):
        for command in (4.0, 7.0, -9.0):
            run = self.motor(command, 10, torque_constant_Nm_A=2.0, current_limit_A=3.0)
            np.testing.assert_allclose(run["motor_Nm"][-1], np.clip(command, -6, 6))
        # The top speed, where k (U - k v)/R = b v.
        for inductance, bandwidth, zeta in itertools.product((0.0, 0.01), (0.0, 500.0), (0.0, 0.7)):
            loop = {} if bandwidth == 0.0 else {"current_damping_ratio": zeta}
            run = self.motor(100.0, 20_000, 1e-3, {
                "plant.inertia_ratio": 0.2, "plant.viscous_friction_Nms_rad": 0.1},
                torque_constant_Nm_A=0.5, voltage_limit_V=24.0, resistance_ohm=2.0,
                inductance_H=inductance, current_bandwidth_rad_s=bandwidth, **loop)
            self.assertAlmostEqual(run["velocity_true_rad_s"][-1], 12 / 0.45, delta=1e-6)

    def test_cogging_and_ripple_are_sines_of_the_position(self):
        run = self.motor(2.0, 4000, 1e-3, cogging_Nm=0.3, cogging_per_turn=12, ripple_ratio=0.05,
                         ripple_per_turn=6)
        q = run["position_true_rad"]
        expected = 2 * (1 + 0.05 * np.sin(6 * q)) + 0.3 * np.sin(12 * q)
        np.testing.assert_allclose(run["motor_Nm"], expected, atol=1e-12)

    def test_each_part_changes_the_motor_and_logs_its_signals(self):
        ideal = bw.run("motor_estimation", "vfakfd", duration=3)
        for keys, signals in PARTS:
            with self.subTest(keys):
                run = bw.run("motor_estimation", "vfakfd", duration=3, set=keys)
                self.assertNotEqual(run.state_hash, ideal.state_hash)
                self.assertEqual(set(run.signals) ^ set(ideal.signals), signals)

    def expect_coulomb(self, friction, velocity, level, least):
        moves = np.abs(velocity) >= least
        self.assertTrue(moves.any())
        np.testing.assert_allclose(friction[moves], -level * np.sign(velocity[moves]), atol=0.02)

    def test_a_law_of_one_joint_leaves_the_others_their_friction(self):
        """Without load dependence the law has the bits of the engine's friction. The log has that
        of all."""
        brief = {"run.duration_s": 2, "push.start_s": 0.1, "push.rise_s": 0.5}
        own = {"axis.joint3.friction.law": "load_dependent", "axis.joint3.friction.load_ratio": 0}
        law = bw.run("arm_push", "proposed-link1", set=brief | own)
        self.assertEqual(law.state_hash, bw.run("arm_push", "proposed-link1", set=brief).state_hash)
        self.expect_coulomb(law["friction_Nm"], law["dq_true_rad_s"], 4.0, 0.05)

    def test_a_stiff_spring_moves_as_a_rigid_gear(self):
        """A motor that the model lacks gets a rotor."""
        sets = {"transmission.ratio": 2, "transmission.motor_inertia_kgm2": 0.25,
                "nominal.motor_inertia_kgm2": 0.25, "disturbance.amplitude_Nm": 20,
                "physics.timestep_s": 2e-4}
        rigid, stiff = (bw.run("motor_estimation", "idob", set={**sets, **more}) for more in (
            {}, {"transmission.stiffness_Nm_rad": 1e6, "transmission.damping_Nms_rad": 50}))
        peaks = [run.metrics["peak_position_rad"] for run in (stiff, rigid)]
        self.assertNotEqual(*peaks)
        self.assertAlmostEqual(peaks[0] / peaks[1], 1, delta=2e-3)
        # The log has the positions of the model file, for pictures.
        self.assertEqual((stiff.signals[0], stiff["qpos"].shape), ("qpos", stiff.time_s.shape))
        self.assertEqual(len(rigid.signals) + 3, len(stiff.signals))

    def test_dry_friction_acts_on_the_side_of_its_key(self):
        """With the Coulomb level, against its motion."""
        hashes = set()
        for side, velocity in (("load", "velocity_true_rad_s"), ("motor", "motor_velocity_rad_s")):
            own = {"plant.coulomb_friction_Nm": 0.2, "friction.side": side}
            run = bw.run("two_inertia", "pd", set={**own, **STRIBECK, "friction.static_ratio": 1,
                                                   "friction.stribeck_velocity": 1})
            self.expect_coulomb(run["friction_Nm"], run[velocity], 0.2, 0.1)
            self.assertEqual(bw.run("two_inertia", "pd", set=own).state_hash, run.state_hash)
            hashes.add(run.state_hash)
        self.assertEqual(len(hashes), 2)


class Disturbances(unittest.TestCase):
    KEYS = {"amplitude_Nm": 3.0, "frequency_rad_s": 2.0, "start_s": 1.0, "second_amplitude_Nm": 0.7,
            "second_frequency_rad_s": 6.0, "end_frequency_rad_s": 5.0, "sweep_s": 2.0}

    def test_each_has_its_shape_from_its_start_to_its_end(self):
        """The phase of a chirp is the integral of its frequency, which changes linearly and then
        stays."""
        for kind, shape in {
            "none": lambda t: 0 * t, "step": lambda t: 3 + 0 * t, "ramp": lambda t: 3 * t,
            "sine": lambda t: 3 * np.sin(2 * t),
            "two_sines": lambda t: 3 * np.sin(2 * t) + 0.7 * np.sin(6 * t),
            "chirp": lambda t: 3 * np.sin(np.where(t < 2, 2 * t + 0.75 * t**2, 7 + 5 * (t - 2))),
            "chirp to 0": lambda t: 3 * np.sin(np.where(t < 2, 2 * t - 0.5 * t**2, 2)),
        }.items():
            for offset, end_s in ((0.0, INF), (-0.4, 4.5)):
                ends = {} if end_s == INF else {"end_s": end_s}
                ends |= {"end_frequency_rad_s": 0} if kind.endswith(" 0") else {}
                run = bw.run("motor_estimation", "idob", duration=6, set={
                    f"disturbance.{key}": value for key, value in
                    {**self.KEYS, **ends, "kind": kind.split()[0], "offset_Nm": offset}.items()})
                t = run.time_s
                acts = (t >= 1 - 1e-9) & (t < end_s - 1e-9)
                near(run["d_true_Nm"], offset + acts * shape(t - 1), atol=1e-9, err_msg=kind)


def impact_laws(K, v):
    """For an impact of 1 kg: name, keys, the force of x, x' and z with z', and about how long the
    contact takes."""
    omega, depth = np.sqrt(K), v / np.sqrt(K)
    B, alpha, tau = 0.2 * omega, 0.4 / v, 0.3 / omega
    hertz_s = 2.9432 * (1.25 * v * v / K) ** 0.4 / v
    layers = [[0.5 * depth, 0.25 * K * depth], [depth, K * depth]]

    def kelvin_voigt(x, u, z):
        return K * x + B * u, 0.0

    def layered(x, u, z):
        return np.interp(x, [0, 0.5 * depth, 9 * depth], np.array([0, 0.25, 13]) * K * depth), 0.0

    return {
        "kelvin_voigt": ({"damping_Ns_m": B}, kelvin_voigt, 3.2 / omega),
        "kelvin_voigt_clipped": ({"damping_Ns_m": B}, kelvin_voigt, 3.2 / omega),
        "hertz": ({}, lambda x, u, z: (K * x**1.5, 0.0), hertz_s),
        "hunt_crossley": ({"restitution": 1, "dissipation_s_m": alpha},
                          lambda x, u, z: (K * x**1.5 * (1 + alpha * u), 0.0), 1.3 * hertz_s),
        "layered": ({"layers": layers, "dissipation_s_m": 0}, layered, 4.2 / omega),
        "standard_linear_solid": (
            {"maxwell_stiffness_N_m": K, "relaxation_s": tau},
            lambda x, u, z: (2 * K * x - K * z, (x - z) / tau), 3.2 / omega)}


class Impact(unittest.TestCase):
    def strike(self, name, K, v, **sets):
        keys, _, time_s = impact_laws(K, v)[name]
        # A soft wall needs no finer step than one of 10 kN/m.
        soft = {"physics.timestep_s": 1e-4} if K < 1e4 else {}
        return bw.run("impact_test", name, set={
            "contact.stiffness_N_m": K, "impact.speed_m_s": v, "impact.distance_m": 0,
            "run.duration_s": 1.5 * time_s + 1e-3, "record.fine_to_s": 0, **soft,
            **{f"contact.{key}": value for key, value in keys.items()}, **sets}).metrics

    def integrated(self, name, K, v):
        """Peak, contact time, restitution and penetration by SciPy."""
        _, law, time_s = impact_laws(K, v)[name]

        def slope(t, s):
            force, dz = law(max(s[0], 0.0), s[1], s[2])
            return s[1], -max(force, 0.0), dz

        def pull(t, s):
            return law(max(s[0], 0.0), s[1], s[2])[0] if t > 0.1 * time_s else 1.0

        pull.terminal = True
        done = solve_ivp(slope, (0, 9 * time_s), (0.0, v, 0.0), events=pull, rtol=1e-9,
                         atol=1e-12 * v * time_s, max_step=time_s / 300)
        forces = [-slope(0, s)[1] for s in done.y.T]
        return max(forces), done.t[-1], -done.y[1, -1] / v, done.y[0].max()

    def test_it_is_within_one_percent_over_stiffness_and_speed(self):
        for K in (1e2, 1e4, 1e6):
            for v in (0.01, 0.2, 2.0):
                for name in impact_laws(K, v):
                    with self.subTest(name, K=K, v=v):
                        found = self.strike(name, K, v)
                        measured = [found[key] for key in ("peak_force_raw_N", "contact_time_s",
                                                           "restitution", "penetration_m")]
                        np.testing.assert_allclose(measured, self.integrated(name, K, v), rtol=0.01)
                        # Momentum, by the integrator's own stages.
                        np.testing.assert_allclose(found["contact_impulse_Ns"],
                                                   v * (1 + found["restitution"]), rtol=1e-6)
                        self.assertEqual(found["bounce_count"], 0)

    def test_kelvin_voigt_is_its_closed_form(self):
        K, B, v = 1e4, 30.0, 0.2
        found = bw.run("impact_test", "kelvin_voigt_clipped", duration=0.05, set={
            "impact.distance_m": 0, "contact.damping_Ns_m": B}).metrics
        # F = m v exp(-s t) (2 s cos w t + (w^2 - s^2)/w sin w t), until it is 0.
        s = B / 2
        w = np.sqrt(K - s * s)
        end_s = (np.pi - np.arctan2(2 * s * w, w * w - s * s)) / w
        restitution = -np.exp(-s * end_s) * (np.cos(w * end_s) - s / w * np.sin(w * end_s))
        self.assertAlmostEqual(found["contact_time_s"], end_s, delta=2e-5)
        depth_m = v / np.sqrt(K) * np.exp(-s / w * np.arctan2(w, s))
        np.testing.assert_allclose([found["restitution"], found["penetration_m"]],
                                   [restitution, depth_m], rtol=1e-4)

    def test_hertz_is_its_closed_form(self):
        for k in (1e4, 1e6):
            for v in (0.1, 1.0):
                found, depth_m = self.strike("hertz", k, v), (5 * v * v / (4 * k)) ** 0.4
                np.testing.assert_allclose(found["penetration_m"], depth_m, rtol=1e-6)
                self.assertAlmostEqual(found["contact_time_s"], 2.9432 * depth_m / v, delta=2e-5)
                self.assertAlmostEqual(found["restitution"] ** 2, 1, delta=1e-6)  # energy

    def test_the_energy_of_continuous_laws_and_the_timestep_of_the_others(self):
        """Under rk4 a continuous force keeps the energy's balance to 1e-6. Otherwise the error
        falls with the timestep. The compiled kelvin_voigt has MuJoCo's added mass."""
        for name in impact_laws(1e4, 0.2):
            expected = self.integrated(name, 1e4, 0.2)[2]
            is_continuous = not name.startswith("kelvin_voigt")
            if is_continuous:
                found = self.strike(name, 1e4, 0.2)["restitution"]
                self.assertAlmostEqual(found**2, expected**2, delta=1e-6)
            for integrator in ("euler", "implicit", "rk4"):
                if name == "kelvin_voigt" or (is_continuous and integrator == "rk4"):
                    continue
                # The same part of a step before each contact.
                fine, coarse = (abs(self.strike(name, 1e4, 0.2, **{
                    "physics.timestep_s": h, "impact.distance_m": 0.3 * 0.2 * h,
                    "physics.integrator": integrator})["restitution"] - expected)
                    for h in (2e-5, 4e-5))
                self.assertLess(fine, 0.7 * coarse + 1e-7, name + integrator)
                self.assertLess(fine, 2e-3, name + integrator)

    def free_wall(self, integrator):
        """Time, the ball's position and speed, the wall's position, and force: 0.5 kg with 0.3 m/s
        on 10 kN/m and a wall of 1.5 kg."""
        run = bw.run("impact_test", "kelvin_voigt_clipped", duration=0.04, set={
            "physics.integrator": integrator, "physics.timestep_s": 1e-4, "impact.mass_kg": 0.5,
            "impact.speed_m_s": 0.3, "impact.distance_m": 0, "contact.stiffness_N_m": 1e4,
            "contact.damping_Ns_m": 0, "wall.motion": "free", "wall.mass_kg": 1.5,
            "wall.stiffness_N_m": 0, "wall.damping_Ns_m": 0, "record.fine_from_s": 0,
            "record.fine_to_s": 1})
        return (run[f"physics/{name}"] for name in
                ("time_s", "qpos", "qvel", "wall_m", "force_true_N"))

    def test_a_free_wall_has_the_motion_of_its_closed_form(self):
        """Two masses on a spring: half a period of a sine."""
        t, ball, _, wall, force = self.free_wall("rk4")
        omega = np.sqrt(1e4 * (1 / 0.5 + 1 / 1.5))
        early = t < 0.95 * np.pi / omega
        depth, way = 0.3 / omega * np.sin(omega * t), 0.3 * t
        for found, expected, close in (
                (ball - ball[0], way / 4 + 3 / 4 * depth, 1e-10),
                (wall, (way - depth) / 4, 1e-10), (force, 1e4 * depth, 1e-6)):
            near(found[early], expected[early], atol=close)

    def test_eulers_method_moves_a_free_wall_by_the_speed_that_the_force_gave_it(self):
        t, _, speed, wall, force = self.free_wall("euler")
        of_wall = 0.5 * (0.3 - speed) / 1.5
        near(np.diff(wall), 1e-4 * of_wall[1:], atol=1e-15)
        near(0.5 * (0.3 - speed[1:]), 1e-4 * np.cumsum(force[:-1]), atol=1e-12)
        self.assertAlmostEqual(of_wall[-1] * 1.5, 2 * 0.3 / (1 / 0.5 + 1 / 1.5), delta=2.25e-4)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    unittest.main(warnings="ignore")
