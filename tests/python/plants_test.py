"""Plants of one and two masses: friction beside fine integrations by SciPy, and a transmission
beside closed forms."""

import itertools
import math
import pathlib
import unittest

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import breakwater as bw
from support import temporary_folder

SLIDE = """<mujoco><option gravity="0 0 0"/><worldbody><body><inertial pos="0 0 0" mass="{mass}"
  diaginertia="1 1 1"/><joint name="x" type="slide" axis="1 0 0"/></body></worldbody>
<actuator><motor name="push" joint="x"/></actuator>
<sensor><jointpos name="x" joint="x"/><jointvel name="v" joint="x"/></sensor></mujoco>"""
PLANT = """scenario = "plant"
default_case = "own"
model.mjcf = "slide.xml"
physics = { timestep_s = 1e-4, integrator = "euler" }
control.period_s = 1e-4
run = { duration_s = 1.0, seed = 1 }
plant = { coulomb_friction_N = 1.0, viscous_friction_Ns_m = 0.4 }
[axis.x]
joint = "x"
controller = { name = "pd", kp = 0.0, kd = 0.0 }
observer.name = "none"
[case.own]
"""
CURVE = {"friction.static_ratio": 1.5, "friction.stribeck_velocity": 0.001}
LUGRE = {**CURVE, "friction.law": "lugre", "friction.bristle_stiffness": 1e5,
         "friction.bristle_damping": np.sqrt(1e5)}
STRIBECK = {**CURVE, "friction.law": "stribeck", "friction.stribeck_velocity": 0.02}
INTEGRATORS = ("euler", "rk4", "implicit")


def level(v, law):
    return 1 + 0.5 * math.exp(-((v / law["friction.stribeck_velocity"]) ** 2))


def integrated(law, force, duration_s, outputs=400):
    """Positions at equal distances of time. Without bristles the friction is set-valued: implicit
    Euler, whose velocity is 0 where the friction can hold the mass."""
    if "friction.bristle_stiffness" in law:
        stiffness, damping = law["friction.bristle_stiffness"], law["friction.bristle_damping"]

        def slope(t, state):
            x, v, z = state
            rate = v - stiffness * abs(v) / level(v, law) * z
            return v, force(t, x) - stiffness * z - damping * rate - 0.4 * v, rate

        return solve_ivp(slope, (0, duration_s), [0.0] * 3, method="Radau", rtol=1e-8,
                         atol=[1e-12, 1e-10, 1e-12], max_step=duration_s / 2000,
                         t_eval=np.linspace(0, duration_s, outputs + 1)[1:]).y[0]
    h, x, v, positions = 5e-5, 0.0, 0.0, []
    every = round(duration_s / outputs / h)
    for k in range(1, outputs * every + 1):
        free = v + h * force(k * h, x)
        v = free
        for _ in range(3):  # iterations for the level at the new velocity
            v = math.copysign(max(0.0, abs(free) - h * level(v, law)) / (1 + 0.4 * h), free)
        x += h * v
        if k % every == 0:
            positions.append(x)
    return np.array(positions)


class Friction(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(temporary_folder())
        (self.folder / "slide.toml").write_text(PLANT)
        (self.folder / "ramp.csv").write_text("time_s,value\n0,0\n100,10\n")

    def run_with(self, law, duration_s, mass=1.0, integrator="euler", **sets):
        (self.folder / "slide.xml").write_text(SLIDE.format(mass=mass))
        return bw.run(str(self.folder / "slide.toml"), duration=duration_s,
                      set={**law, "physics.integrator": integrator, **sets})

    def push(self, force_N, **more):
        """A constant force, against which the disturbance acts."""
        return {"axis.x.disturbance.offset_N": -force_N, **more}

    def expect_close(self, law, force, duration_s, sets):
        every = round(duration_s / 400 / 1e-4)
        reference = integrated(law, force, duration_s)
        for integrator in INTEGRATORS:
            run = self.run_with(law, duration_s, integrator=integrator, **sets)
            x = run["x_position_true_m"][every::every]
            self.assertGreaterEqual(len(x), 399)
            self.assertLess(np.abs(x - reference[:len(x)]).max(), 0.005 * np.abs(reference).max())

    def test_bristles_have_the_presliding_hysteresis_of_a_fine_integration(self):
        self.expect_close(LUGRE, lambda t, x: 0.9 * np.sin(6 * t), 2.0, {
            "axis.x.disturbance.kind": "sine", "axis.x.disturbance.amplitude_N": -0.9,
            "axis.x.disturbance.frequency_rad_s": 6.0})

    def test_stick_slip_is_that_of_a_fine_integration(self):
        pull = {"axis.x.controller.kp": 2.0, "axis.x.reference.kind": "csv",
                "axis.x.reference.file": str(self.folder / "ramp.csv")}
        for law in (LUGRE, STRIBECK):
            self.expect_close(law, lambda t, x: 2.0 * (0.1 * t - x), 20.0, pull)

    def test_it_slides_steadily_at_the_level_of_its_speed(self):
        """A servo holds the speed, so that the falling part of the curve is stable."""
        for law, integrator, speed in itertools.product((LUGRE, STRIBECK), INTEGRATORS,
                                                        (0.01, 0.03, 0.1, 1.0)):
            run = self.run_with(law, 1.1, integrator=integrator,
                                **self.push(1e3 * speed, **{"axis.x.controller.kd": 1e3}))
            expected = level(run["x_velocity_true_m_s"][-1], law)
            friction = -run["x_friction_N"][-1000:].mean()
            self.assertAlmostEqual(friction / expected, 1, delta=0.005, msg=(speed, integrator))

    def test_bristles_hold_a_load_without_creep(self):
        for integrator in INTEGRATORS:
            duration_s = 100.0 if integrator == "euler" else 10.0
            run = self.run_with(LUGRE, duration_s, integrator=integrator,
                                **self.push(0.8, **{"control.period_s": 1e-2}))
            x = run["x_position_true_m"]
            self.assertAlmostEqual(x[100], 1.5 / 1e5 * -np.log(1 - 0.8 / 1.5), delta=1e-5)
            self.assertLess(abs(x[-1] - x[100]), 1e-9)

    def test_bristles_are_stable_on_any_mass_and_step(self):
        for integrator, mass, step_s in itertools.product(INTEGRATORS, (1e-4, 1e-2, 1.0),
                                                          (1e-4, 1e-3)):
            viscous = min(0.4, mass / step_s)  # within the stability of RK4
            run = self.run_with(LUGRE, 2.0, mass, integrator, **self.push(0.5, **{
                "physics.timestep_s": step_s, "control.period_s": 1e-3,
                "plant.viscous_friction_Ns_m": viscous, "axis.x.disturbance.kind": "step",
                "axis.x.disturbance.amplitude_N": -2.5, "axis.x.disturbance.start_s": 0.0,
                "axis.x.disturbance.end_s": 0.5}))
            v = run["x_velocity_true_m_s"]
            self.assertTrue(0 < v[499] <= 2 / viscous + 1e-6)
            self.assertLess(abs(v[-1]), 1e-6)

    def test_it_never_adds_energy_over_a_cycle(self):
        for law, integrator, amplitude, period_s in itertools.product(
                (LUGRE, STRIBECK), INTEGRATORS, (0.5, 1.2, 2.0, 20.0), (0.05, 0.5)):
            run = self.run_with(law, 5 * period_s, integrator=integrator, **{
                "axis.x.disturbance.kind": "sine", "axis.x.disturbance.amplitude_N": amplitude,
                "axis.x.disturbance.frequency_rad_s": 2 * np.pi / period_s})
            work_J = run["x_friction_N"][1:] * np.diff(run["x_position_true_m"])
            self.assertLess(work_J[round(4 * period_s / 1e-4):].sum(), 1e-15)

    def test_a_flat_stribeck_curve_is_coulomb_friction(self):
        sine = {"axis.x.disturbance.kind": "sine", "axis.x.disturbance.amplitude_N": 3.0,
                "axis.x.disturbance.frequency_rad_s": 5.0}
        for integrator in INTEGRATORS:
            flat = {**STRIBECK, "friction.static_ratio": 1.0}
            hashes = [self.run_with(law, 2.0, integrator=integrator, **sine).state_hash
                      for law in (flat, {"friction.law": "coulomb"})]
            self.assertEqual(*hashes)

    def test_a_loaded_gear_needs_more_force(self):
        """It moves where |f| > F_C + mu |f|, with the acceleration (|f| (1 - mu) - F_C)/m. The
        drive pushes: a weak spring to a place far away."""
        law = {"friction.law": "load_dependent", "friction.load_ratio": 0.25}
        for force_N in (1.2, -4.0):
            run = self.run_with(law, 1.0, **{
                "plant.viscous_friction_Ns_m": 0.0, "axis.x.controller.kp": 1e-6,
                "axis.x.reference.kind": "step", "axis.x.reference.value_m": 1e6 * force_N})
            left_N = abs(force_N) * 0.75 - 1
            self.assertAlmostEqual(abs(run["x_velocity_true_m_s"][-1]), max(left_N, 0), delta=1e-3)
            friction_N = 2.0 if left_N > 0 else 1.2
            self.assertAlmostEqual(abs(run["x_friction_N"][-1]), friction_N, delta=2e-3)


MOTOR, LOAD = 0.01, 0.02  # the inertias of models/two_inertia.xml
ELASTIC = """scenario = "plant"
default_case = "own"
model.mjcf = "two.xml"
physics = { timestep_s = 1e-3, integrator = "rk4" }
control.period_s = 1e-3
run = { duration_s = 1.0, seed = 1 }
start.keyframe = "home"
[axis.x]
joint = "load"
transmission = { motor_joint = "motor", stiffness_Nm_rad = 50.0 }
controller = { name = "pd", kp = 0.0, kd = 0.0 }
observer.name = "none"
nominal.model = "rigid"
[case.own]
"""


class Torque(bw.Controller):
    def __init__(self, law):
        self.law = law

    def update(self, t, y):
        return self.law(t, y.position)


class Transmission(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(temporary_folder())
        (self.folder / "two.toml").write_text(ELASTIC)

    def run_with(self, duration_s, start=(0, 0), law=None, friction=(0, 0), timestep_s=1e-3,
                 **keys):
        model = pathlib.Path(__file__).parents[2] / "models/two_inertia.xml"
        text = model.read_text().replace('qpos="0 0"', f'qpos="{start[0]} {start[1]}"')
        for name, damping in zip(("motor", "load"), friction, strict=True):
            text = text.replace(f'name="{name}" type', f'name="{name}" damping="{damping}" type')
        (self.folder / "two.xml").write_text(text)
        own = {f"axis.x.transmission.{key}": value for key, value in keys.items() if "." not in key}
        more = {key: value for key, value in keys.items() if "." in key}
        return bw.run(
            str(self.folder / "two.toml"), controllers={"x": Torque(law)} if law else None,
            set={"run.duration_s": duration_s, "physics.timestep_s": timestep_s,
                 "control.period_s": timestep_s, **own, **more})

    def state(self, run):
        """Angles and speeds of motor and load."""
        return (run[f"x_{name}"] for name in ("motor_position_rad", "position_true_rad",
                                              "motor_velocity_rad_s", "velocity_true_rad_s"))

    def test_a_free_spring_keeps_momentum_and_energy(self):
        for ratio, error in itertools.product((1.0, 2.5), (0.0, 0.05)):
            run = self.run_with(1.0, (0.4, -0.1), timestep_s=1e-4, ratio=ratio,
                                kinematic_error_rad=error, **{"axis.x.start.velocity_rad_s": -1.0})
            _, _, dm, dl = self.state(run)
            energy = 0.5 * (MOTOR * dm**2 + LOAD * dl**2 + run["x_transmission_Nm"] ** 2 / 50)
            self.assertLess(np.ptp(energy), 1e-8 * energy[0])
            change = np.ptp(ratio * MOTOR * dm + LOAD * dl)
            self.assertTrue(change < 1e-12 if error == 0 else change > 1e-4)

    def test_a_damper_takes_exactly_the_energy_that_is_lost(self):
        run = self.run_with(0.2, (0.2, 0.0), timestep_s=1e-5, damping_Nms_rad=0.05)
        qm, ql, dm, dl = self.state(run)
        lost = np.trapz(0.05 * (dm - dl) ** 2, run.time_s)
        left = 0.5 * (MOTOR * dm**2 + LOAD * dl**2 + 50 * (qm - ql) ** 2)[-1]
        self.assertAlmostEqual(left + lost, 0.5 * 50 * 0.2**2, delta=1e-6)
        self.assertGreater(lost, 0.5)

    def responses(self, omega, settle_s, ratio, damping):
        """Both angles over the motor's torque, measured over ten periods and in closed form. A
        weak feedback of the position is part of the torque, which is held between the samples."""
        steps = round(20 * np.pi / (omega * 1e-3))
        w = 20 * np.pi / (steps * 1e-3)
        run = self.run_with(settle_s + (steps - 1) * 1e-3, friction=(0.15, 0),
                            law=lambda t, q: 0.1 * np.sin(w * t) - 0.3 * q, ratio=ratio,
                            damping_Nms_rad=damping, **{"axis.x.encoder.side": "motor"})
        turned = np.exp(-1j * w * run.time_s[-steps:])
        torque = run["x_applied_Nm"][-steps:] @ turned * np.exp(-0.5j * w * 1e-3)
        found = [angle[-steps:] @ turned / torque for angle in list(self.state(run))[:2]]
        s, k = 1j * w, 50 + damping * 1j * w
        stiffness = [[MOTOR * s * s + 0.15 * s + k / ratio**2, -k / ratio],
                     [-k / ratio, LOAD * s * s + k]]
        return np.array(found), np.linalg.solve(stiffness, [1, 0])

    def test_the_frequency_response_is_that_of_two_inertias(self):
        for ratio in (1.0, 2.0):
            notch, peak = np.sqrt(50 / LOAD), np.sqrt(50 * (1 / LOAD + 1 / (ratio**2 * MOTOR)))
            for omega in 0.1 * peak * np.geomspace(1, 30, 11):
                if min(abs(omega / peak - 1), abs(omega / notch - 1)) < 0.02:
                    continue
                found, expected = self.responses(omega, 4.0, ratio, 0.03)
                quotient = found / expected
                self.assertLess(np.abs(20 * np.log10(np.abs(quotient))).max(), 1.0, omega)
                self.assertLess(np.abs(np.angle(quotient, deg=True)).max(), 5.0, omega)

    def test_resonances_are_within_half_a_percent(self):
        """At the anti-resonance the motor's angle, and at the resonance the load's, turns its
        sign."""
        for side, at in enumerate((50.0, np.sqrt(50 * (1 / MOTOR + 1 / LOAD)))):
            below, above = (self.responses(share * at, 12.0, 1.0, 0.01)[0][side].real
                            for share in (0.995, 1.005))
            self.assertTrue(below < 0 < above, (below, above))

    def test_backlash_oscillates_as_the_describing_function_predicts(self):
        """u = -k_p q_l, with friction at both inertias. For a dead zone the describing function is
        a lower stiffness K' of the spring. The loop oscillates where it has poles on the imaginary
        axis: w^2 = K' S/C, K' (J_m J_l S^2/C^2 - (J_m + J_l) S/C) = c_m c_l S/C - k_p."""
        c_m, c_l, play, gain = 0.3, 0.02, 0.02, 10.0
        S, C = c_m + c_l, MOTOR * c_l + LOAD * c_m
        reduced = c_m * c_l * S / C - gain
        reduced /= MOTOR * LOAD * (S / C) ** 2 - (MOTOR + LOAD) * S / C
        self.assertTrue(0 < reduced < 50)
        # 1 - (2/pi) (asin r + r sqrt(1 - r^2)) = K'/K with r = b/(2 A).
        r = brentq(lambda r: 1 - 2 / np.pi * (np.arcsin(r) + r * np.sqrt(1 - r * r)) - reduced / 50,
                   0, 1)
        run = self.run_with(25.0, (0.05, 0.05), lambda t, q: -gain * q, (c_m, c_l), 5e-4,
                            backlash_rad=play)
        late = run.time_s >= 15
        qm, ql, *_ = (values[late] for values in self.state(run))
        risings = run.time_s[late][1:][(ql[:-1] < 0) & (ql[1:] >= 0)]
        self.assertGreater(len(risings), 10)
        found = 2 * np.pi / np.diff(risings).mean()
        self.assertAlmostEqual(found / np.sqrt(reduced * S / C), 1, delta=0.1)
        self.assertAlmostEqual(np.abs(qm - ql).max() / (0.5 * play / r), 1, delta=0.2)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
