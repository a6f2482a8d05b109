"""Controllers and estimators in Python. A copy of a C++ one's commands gives the same bits."""

import pathlib
import shutil
import traceback
import unittest

import numpy as np

import breakwater as bw
from admittance import Admittance
from support import Returns, temporary_folder

CASES = {
    "arm_wall_contact": dict(case="hpfc-2N", u="torque_command_Nm", y=["q_measured_rad", "force_measured_N"]),
    "motor_estimation": dict(case="stf", u="command_Nm", y=["position_measured_rad"]),
    "cart_constrained": dict(case="proposed-idob", u="command_N", y=["position_measured_m"]),
    "quadrotor_waves": dict(case="ukf-zero", u="thrust_command_N", y=["pose_measured"]),
}


class Repeat(bw.Controller):
    """Repeats the commands of another run's controller, and checks that the inputs are equal."""

    def __init__(self, run, u, y):
        self.u = np.atleast_2d(run[u].T).T
        self.y = np.hstack([np.atleast_2d(run[name].T).T for name in y])
        self.time_s = run.time_s
        self.k = -1

    def reset(self, t, y):
        assert self.k == -1 and t == 0.0
        assert np.array_equal(y[: self.y.shape[1]], self.y[0])
        self.k = 0

    def update(self, t, y):
        assert t == self.time_s[self.k]
        assert np.array_equal(y[: self.y.shape[1]], self.y[self.k])
        self.k += 1
        return self.u[self.k - 1]


class RepeatEstimates(bw.Estimator):
    def __init__(self, run):
        self.rows = np.column_stack([run[f"{name}_{unit}"] for name, unit in (
            ("position_hat", "rad"), ("velocity_hat", "rad_s"), ("d_hat", "Nm"))])
        self.y = run["position_measured_rad"]
        self.u = run["applied_Nm"]
        self.k = None

    def reset(self, x0):
        assert x0.shape == (2,)
        self.k = 0

    def update(self, u, y):
        k, self.k = self.k, self.k + 1
        assert y.position == self.y[k]
        assert u.shape == (1,) and (k == 0 or u[0] == self.u[k - 1])
        return self.rows[k]


class Same(unittest.TestCase):
    def test_a_controller_that_repeats_the_commands_gives_the_same_bits(self):
        for scenario, about in CASES.items():
            with self.subTest(scenario):
                theirs = bw.run(scenario, case=about["case"], duration=0.2)
                repeat = Repeat(theirs, about["u"], about["y"])
                ours = bw.run(scenario, case=about["case"], duration=0.2, controller=repeat)
                self.assertEqual(ours.state_hash, theirs.state_hash)
                self.assertEqual(repeat.k, len(theirs.time_s))
                self.assertEqual(ours.config["controller"]["name"], "Repeat")
                self.assertEqual(ours.warnings, [])

    def test_an_estimator_that_repeats_the_estimates_gives_the_same_bits(self):
        theirs = bw.run("motor_estimation", case="idob", duration=0.5)
        ours = bw.run("motor_estimation", case="idob", duration=0.5, estimator=RepeatEstimates(theirs))
        self.assertEqual(ours.state_hash, theirs.state_hash)
        np.testing.assert_array_equal(ours["d_hat_Nm"], theirs["d_hat_Nm"])
        self.assertEqual(ours.config["observer"]["name"], "RepeatEstimates")

    def test_each_joint_of_the_arm_has_an_estimator_of_its_own(self):
        class Joint(bw.Estimator):
            def reset(self, x0):
                self.k = 0

            def update(self, u, y):
                self.k += 1
                return [y.position, 0.0, 10.0 * self.setup.joint + self.k]

        run = bw.run("arm_push", duration=0.1, estimator=Joint())
        np.testing.assert_array_equal(run["d_hat_Nm"][:2], [[1.0, 11.0, 21.0], [2.0, 12.0, 22.0]])
        np.testing.assert_array_equal(run["q_hat_rad"], run["q_measured_rad"])
        kfd = bw.run("arm_wall_contact", duration=0.1, set={"observer.name": "kfd"})
        self.assertEqual(kfd["innovation"].shape, kfd["q_hat_rad"].shape)

    def test_an_estimator_of_the_quadrotor_steers_it(self):
        theirs = bw.run("quadrotor_waves", case="ukf-zero", duration=0.3)

        class Motion(bw.Estimator):
            def reset(self, x0):
                self.k = 0

            def update(self, u, y):
                self.k += 1
                return np.concatenate([theirs["motion_estimate"][self.k - 1], [1.0, 2.0, 3.0]])

        ours = bw.run("quadrotor_waves", case="ukf-zero", duration=0.3, estimator=Motion(),
                      set={"controller.compensate": False, "metrics.window_s": 0.2})
        np.testing.assert_array_equal(ours["motion_estimate"][:3], theirs["motion_estimate"][:3])
        self.assertIn("vertical_force_rmse_N", ours.metrics)
        self.assertNotIn("nees_mean", ours.metrics)


class RepeatAxis(bw.Controller):
    """Repeats the commands of one axis of another run's plant."""

    def __init__(self, commands):
        self.commands = commands

    def reset(self, t, y):
        self.k = -1

    def update(self, t, y):
        self.k += 1
        return self.commands[self.k]


class OfOneAxis(unittest.TestCase):
    def test_controllers_that_repeat_the_commands_of_their_axes_give_the_same_bits(self):
        theirs = bw.run("plant", duration=0.5)
        both = {axis: RepeatAxis(theirs[f"{axis}_command_Nm"]) for axis in ("shoulder", "elbow")}
        ours = bw.run("plant", duration=0.5, controllers=both)
        self.assertEqual(ours.state_hash, theirs.state_hash)
        self.assertEqual(ours.config["axis"]["elbow"]["controller"]["name"], "RepeatAxis_elbow")
        one = bw.run("plant", duration=0.5, controllers={"elbow": both["elbow"]})
        self.assertEqual(one.state_hash, theirs.state_hash)
        self.assertEqual(one.config["axis"]["shoulder"]["controller"]["name"], "pd")
        self.assertEqual(both["elbow"].setup.A.shape, (2, 2))

    def test_an_estimator_of_one_axis_stands_beside_those_of_others(self):
        class Position(bw.Estimator):
            def update(self, u, y):
                return [y.position, 0.0, 0.5]

        run = bw.run("plant", duration=0.1, estimators={"elbow": Position()})
        np.testing.assert_array_equal(run["elbow_position_hat_rad"], run["elbow_position_measured_rad"])
        np.testing.assert_array_equal(run["elbow_d_hat_Nm"], 0.5)
        self.assertGreater(np.ptp(run["shoulder_d_hat_Nm"]), 0.1)

    def test_the_reference_is_at_the_side_of_the_encoder(self):
        drive = pathlib.Path(__file__).parents[1] / "regression" / "elastic_drive.toml"

        class Idle(bw.Controller):
            def update(self, t, y):
                return 0.0

        # The step at 0.1 s is 0.2 rad of the load, and the gear has the ratio 10.
        for case, at_step in (("pd", 2.0), ("spring", 0.2)):
            own = Idle()
            bw.run(str(drive), case, duration=0.01, controllers={"arm": own})
            self.assertAlmostEqual(own.setup.reference(0.2), at_step)
        whole = Idle()
        bw.run(str(drive), "pd", duration=0.01, controller=whole)
        np.testing.assert_allclose(whole.setup.reference(0.2), [2.0])

    def test_a_controller_of_an_axis_without_effect_is_warned_of(self):
        lqr = bw.run("plant", case="lqr", duration=0.1, controllers={"elbow": RepeatAxis([])})
        self.assertRegex(lqr.warnings[0], "axis.elbow.controller.name: has an effect only where controller.name is axes")


class Force(unittest.TestCase):
    PLANT = pathlib.Path(__file__).parents[1] / "regression/press.toml"

    def test_an_admittance_settles_at_its_force(self):
        run = bw.run(str(self.PLANT), controller=Admittance())
        np.testing.assert_array_equal(run["force_reference_N"], 5.0 * (run.time_s >= 0.5))
        last = run["force_true_N"][run.time_s >= 2.5]
        self.assertLess(np.abs(last - 5.0).max(), 0.05)  # 1 %
        self.assertLess(run.metrics["error_N"], 0.05)
        # The wall is a spring, and its metric has the physics steps.
        depth = run["contact_wall_penetration_m"][run.time_s >= 2.5]
        np.testing.assert_allclose(last, 2000 * depth, rtol=5e-3)
        self.assertGreaterEqual(run.metrics["peak_N"], run["force_true_N"].max())

    def test_a_controller_needs_no_estimator_of_the_plant(self):
        with temporary_folder() as folder:
            shutil.copy(self.PLANT.with_name("two_link.xml"), folder)
            own = folder / "own.toml"
            own.write_text(self.PLANT.read_text() + '[observer]\nname = "idob"\npoles_rad_s = [-40, -43, -46]\n')
            bw.run(str(own), duration=0.01, controller=Admittance())

    def test_an_axis_has_the_force_too(self):
        class Look(bw.Controller):
            def reset(self, t, y):
                self.seen = []

            def update(self, t, y):
                self.seen.append((y.position, y.true_position, y.force_N, y.raw_force_N))
                return 0.2

        look = Look()
        run = bw.run(str(self.PLANT), duration=0.3, controllers={"shoulder": look}, set={"sensor.true_state": True})
        names = ("shoulder_position_measured_rad", "shoulder_position_true_rad", "force_measured_N",
                 "force_raw_measured_N")
        np.testing.assert_array_equal(look.seen, np.column_stack([run[name] for name in names]))
        self.assertEqual(look.setup.force_reference(0.5), 5.0)
        without = Look()
        with self.assertRaises(IndexError):
            bw.run(str(self.PLANT), duration=0.1, controllers={"elbow": without})


class Told(unittest.TestCase):
    def test_named_fields_and_setup(self):
        class Look(bw.Controller):
            def reset(self, t, y):
                self.seen = []

            def update(self, t, y):
                self.seen.append(y)
                return self.command

        arm = Look()
        arm.command = [0.0, 0, 0]
        run = bw.run("arm_push", case="hpfc-link1", duration=0.01, controller=arm)
        self.assertEqual([type(y) for y in arm.seen], [bw.ArmSample] * len(arm.seen))
        np.testing.assert_array_equal([y.q_rad for y in arm.seen], run["q_measured_rad"])
        np.testing.assert_array_equal([y.force_N for y in arm.seen], run["force_measured_N"])
        np.testing.assert_array_equal([y.raw_force_N for y in arm.seen],
                                      run["force_raw_measured_N"])
        setup = arm.setup
        self.assertEqual(setup.period_s, 1e-3)
        np.testing.assert_allclose(setup.chain.tip_pose(setup.start_angles_rad), setup.start_pose)
        self.assertEqual(setup.chain.joints, 3)
        self.assertEqual(setup.torque_limit_Nm.shape, (3,))

        axis = Look()
        axis.command = 0
        run = bw.run("cart_constrained", duration=0.1, controller=axis)
        np.testing.assert_array_equal([y.position for y in axis.seen], run["position_measured_m"])
        np.testing.assert_array_equal(axis.setup.C, [[1, 0]])
        self.assertEqual(axis.setup.reference(1e3), 0.0)

        quadrotor = Look()
        quadrotor.command = (1, 1, 1, 1)
        run = bw.run("quadrotor_waves", duration=0.1, controller=quadrotor,
                     set={"wave.significant_height_m": 0, "plant.added_mass_coefficient": 0.7})
        poses = np.array([[*y.position_m, *y.attitude_rad] for y in quadrotor.seen])
        np.testing.assert_array_equal(poses, run["pose_measured"])
        self.assertEqual(quadrotor.setup.thruster_matrix.shape, (4, 4))
        # Heave from rest in still water: a = F/(m + rho V C_a), and hardly any drag.
        self.assertAlmostEqual(quadrotor.setup.mass_kg, 1.38 + 1.1 * 0.7, 12)
        speed = (4 - quadrotor.setup.net_weight_N) / (1.38 + 1.1 * 0.7) * 0.09
        self.assertAlmostEqual(run["motion_true"][9, 8] / speed, 1, 2)

    def test_published_signals_are_logged(self):
        class Count(bw.Controller):
            def __init__(self):
                self.count = np.zeros(2)

            def signals(self):
                return {"count": ("1", "how often it was called", self.count)}

            def update(self, t, y):
                self.count += 1, 2
                return 0.0

        run = bw.run("motor_estimation", duration=0.05, controller=Count())
        np.testing.assert_array_equal(run["count"], np.outer(np.arange(1, len(run.time_s) + 1), [1, 2]))
        self.assertEqual(run.unit("count"), "1")

    def test_what_set_gives_without_effect_is_warned_of(self):
        class Rest(bw.Controller):
            def update(self, t, y):
                return np.zeros(3)

        run = bw.run("arm_push", duration=0.01, controller=Rest(), set={"controller.k_position": 3.0})
        self.assertEqual(len(run.warnings), 1)
        self.assertRegex(run.warnings[0], "set: controller.k_position: has an effect only where controller.name is hpfc")

    def test_an_estimator_beside_a_controller_is_not_silently_unused(self):
        run = bw.run("motor_estimation", "stf", duration=0.01, controller=Returns(0.0), set={"observer.name": "qvff"})
        self.assertIn("set: observer.name: has no effect: a controller in Python uses no estimator", run.warnings)
        self.assertEqual(bw.run("motor_estimation", "stf", duration=0.01, controller=Returns(0.0)).warnings, [])


class InEachScenario(unittest.TestCase):
    def test_a_spring_holds_every_axis_without_metrics_of_an_estimate(self):
        class Spring(bw.Controller):
            def update(self, t, y):
                return -4.0 * y.position

        for scenario in ("motor_estimation", "cart_estimation", "cart_position", "cart_offset_free",
                         "cart_constrained"):
            run = bw.run(scenario, duration=5, controller=Spring())
            self.assertNotRegex(" ".join(run.metrics), "disturbance|estimate")
        for scenario, count in (("arm_wall_contact", 3), ("quadrotor_waves", 4)):
            run = bw.run(scenario, duration=1, controller=Returns(np.zeros(count)))
            self.assertGreater(len(run.time_s), 99)

    def test_the_law_yields_by_the_error_of_an_estimate(self):
        """With a step of 10 N m and an estimate of 6 the PD control yields by 4/K_p."""
        class Constant(bw.Estimator):
            def update(self, u, y):
                return [y.position, 0.0, 6.0]

        run = bw.run("motor_estimation", duration=10, estimator=Constant(), set={
            "encoder.bits": 0, "controller.kd": 0, "plant.viscous_friction_Nms_rad": 20})
        self.assertAlmostEqual(run.metrics["rmse_disturbance_Nm"], 4.0, delta=1e-9)
        self.assertAlmostEqual(abs(run["position_true_rad"][-1]), 0.4, delta=0.02)

    def test_friction_holds_each_joint_of_the_arm(self):
        """Each joint has 80 % of its friction as a load, and so has a shelf that is no joint of
        the chain. By the formula of friction.h the shelf creeps 0.2 um in 2 s, and the joints less
        than 0.1 urad. Beyond its friction a joint moves."""
        mjcf = (pathlib.Path(__file__).parents[2] / "models/arm.xml").read_text()
        mjcf = mjcf.replace("<worldbody>", """<worldbody><body name="shelf">
            <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
            <joint name="lift" type="slide" axis="0 0 1" armature="0" frictionloss="24.525"/>
            </body>""")
        with temporary_folder() as folder:
            (folder / "shelf.xml").write_text(mjcf.replace('qpos="0 0 0"', 'qpos="0 0 0 0"'))
            crept, moved = (np.abs(run["qpos"][-1] - run["qpos"][0]) for run in (
                bw.run("arm_push", duration=2, controller=Returns(3 * [torque]),
                       set={"model.mjcf": str(folder / "shelf.xml")}) for torque in (3.2, 4.2)))
        self.assertAlmostEqual(crept[0], 1.962e-7, delta=1e-9)
        self.assertLess(crept[1:].max(), 1e-7)
        self.assertGreater(moved[1], 0.01)


class Nonsense(unittest.TestCase):
    def test_of_a_controller_is_named_and_numbers_of_any_kind_are_taken(self):
        for value in (np.zeros(3, np.float32), [0, 0, 0], (0.0, 0.0, 0.0), np.zeros(6)[::2]):
            bw.run("arm_push", duration=0.01, controller=Returns(value))
        for value in (0, 0.0, [0.0], np.zeros(1), np.float32(0.0), np.array(0)):
            bw.run("motor_estimation", duration=0.02, controller=Returns(value))
        with self.assertRaisesRegex(bw.RunFailed, "command of actuator 2 is not finite") as caught:
            bw.run("arm_push", duration=0.01, controller=Returns([0, np.nan, 0]))
        self.assertEqual(caught.exception.time_s, 0.0)
        with self.assertRaisesRegex(bw.RunFailed, "command of actuator 2 is not finite"):
            bw.run("arm_push", duration=0.01, controller=Returns(np.ma.array([0.0, 1.0, 0.0], mask=[0, 1, 0])))

    def test_an_exception_leaves_with_its_own_traceback(self):
        class Breaks(bw.Controller):
            def update(self, t, y):
                if t > 0.005:
                    raise ZeroDivisionError("at last")
                return np.zeros(3)

        try:
            bw.run("arm_push", duration=0.1, controller=Breaks())
            self.fail("nothing was raised")
        except ZeroDivisionError as error:
            frame = traceback.extract_tb(error.__traceback__)[-1]
            self.assertEqual((frame.name, frame.line), ("update", 'raise ZeroDivisionError("at last")'))
        # The next run does not contain it.
        bw.run("arm_push", duration=0.01, controller=Returns([0, 0, 0]))

        class BreaksAtOnce(bw.Controller):
            def reset(self, t, y):
                raise KeyError("reset")

        self.assertRaisesRegex(KeyError, "reset", bw.run, "arm_push", duration=0.1, controller=BreaksAtOnce())
        with self.assertRaisesRegex(NotImplementedError, "Controller has no update"):
            bw.run("arm_push", duration=0.1, controller=bw.Controller())

        class WrongSignature(bw.Controller):
            def update(self, t):
                return 0

        with self.assertRaisesRegex(TypeError, "update"):
            bw.run("arm_push", duration=0.1, controller=WrongSignature())

        class Exits(bw.Controller):
            def update(self, t, y):
                raise SystemExit(3)

        self.assertRaises(SystemExit, bw.run, "arm_push", duration=0.1, controller=Exits())

    def test_of_a_signal_that_is_resized_is_named(self):
        class Resizes(Returns):
            def __init__(self, value, again):
                super().__init__(value)
                self.a, self.again = np.full(2, 7.0), again

            def signals(self):
                return {"a_m": ("m", "x", self.a)}

            def update(self, t, y):
                self.a.resize(10**6, refcheck=False)  # moves it
                self.a.resize(self.again, refcheck=False)
                return self.value

        moved = bw.run("motor_estimation", duration=0.01, controller=Resizes(0.0, 2))
        np.testing.assert_array_equal(moved["a_m"], np.full((len(moved.time_s), 2), 7.0))
        with self.assertRaisesRegex(bw.InputError, r"a_m: must keep its 2 numbers of float64, is .*shape \(3,\)"):
            bw.run("motor_estimation", duration=0.01, controller=Resizes(0.0, 3))


if __name__ == "__main__":
    unittest.main()
