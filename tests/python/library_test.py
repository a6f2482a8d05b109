"""The library on arrays, compared with runs of the programs."""

import copy
import ctypes
import pickle
import signal
import sys
import threading
import unittest

import numpy as np
import scipy.linalg

import breakwater as bw
from breakwater import _core
from support import temporary_folder

A = np.array([[0.0, 1.0], [0.0, -0.3]])
B = np.array([[0.0], [2.0]])
C = np.array([[1.0, 0.0]])
PERIOD = 0.01


def record(samples, seed=1):
    """A record of a motor with a step disturbance and an encoder."""
    random = np.random.default_rng(seed)
    A_d, B_d, _ = bw.zero_order_hold(A, B, C, PERIOD)
    u = random.normal(size=samples)
    x = np.zeros(2)
    y = np.empty(samples)
    for k in range(samples):
        y[k] = np.round(x[0] / 1e-3) * 1e-3
        x = A_d @ x + B_d[:, 0] * (u[k] - (0.5 if k > samples // 2 else 0.0))
    return u, y


def every_filter():
    plant = dict(A=A, B=B, C=C, period_s=PERIOD)
    return {
        "Stf": bw.Stf(**plant, delta=1e-3, sigma=1e-5),
        "Stf of order 1": bw.Stf(**plant, delta=1e-3, order=1),
        "Qvff": bw.Qvff(**plant, delta=1e-3),
        "Vfakfd": bw.Vfakfd(**plant, alpha=1e-6, P0=1e-8),
        "Fakfd": bw.Fakfd(**plant, Q=0.0, gamma=1.01, gamma_d=1.02),
        "Kfd": bw.Kfd(**plant, Q=100.0, P0=[1.0, 2.0, 3.0]),
        "Idob": bw.Idob(**plant, poles=[-10, -20, -25]),
        "StateObserver": bw.StateObserver(**plant, poles=[-10, -20]),
        "Vfakfd by its name": bw.Observer("vfakfd", **plant, alpha=1e-6, initial_covariance=[1e-8]),
        "qbank": bw.Observer("qbank", **plant, delta=1e-3, largest_disturbance=1.0),
        "stf": bw.Observer("stf", **plant, delta=1e-3, sigma=1e-5, disturbance_order=0),
        **{
            name: bw.Observer(name, **plant, delta=1e-3, disturbance_order=0, process_noise=1e-2,
                                  initial_covariance=[1.0, 1.0, 1.0])
            for name in ("immkf", "mckf", "vbakf", "gsf")
        },
        "mhe": bw.Observer("mhe", **plant, delta=1e-3, disturbance_order=0, process_noise=1e-2),
        "eso": bw.Observer("eso", **plant, delta=1e-3),
        "Mdob": bw.Mdob(0.5, cutoff_rad_s=20, derivative_cutoff_rad_s=50, period_s=PERIOD),
    }


class Kinematics(unittest.TestCase):
    def test_the_arms_kinematics(self):
        chain = bw.PlanarChain("models/arm.urdf")
        q = np.array([0.3, -0.4, 0.5])
        J = chain.tip_jacobian(q)
        for i, step in enumerate(1e-6 * np.eye(3)):
            difference = (chain.tip_pose(q + step) - chain.tip_pose(q - step)) / 2e-6
            np.testing.assert_allclose(J[:, i], difference, atol=1e-8)
        M = chain.mass_matrix(q)
        np.testing.assert_allclose(M, M.T)
        self.assertGreater(np.linalg.eigvalsh(M)[0], 0)


class Filters(unittest.TestCase):
    def test_a_record_is_the_steps_one_by_one(self):
        u, y = record(400)
        for name, f in every_filter().items():
            with self.subTest(name):
                x, d, innovation, forgetting = f.filter(u, y)
                for again in (copy.deepcopy(f), pickle.loads(pickle.dumps(f))):
                    np.testing.assert_array_equal(again.filter(u, y).x, x)
                self.assertEqual((x.shape, d.shape, forgetting.shape), ((400, 2), (400, 1), (400,)))
                f.reset([y[0], 0.0])
                for k in range(400):
                    x_k, d_k = f.update(u[k - 1] if k else 0.0, y[k])
                    np.testing.assert_array_equal(x_k, x[k])
                    np.testing.assert_array_equal(d_k, d[k])
                    np.testing.assert_array_equal(f.innovation, innovation[k])
                np.testing.assert_array_equal(f.x, x[-1])
                np.testing.assert_array_equal(f.d, d[-1])

    def test_they_find_the_disturbance(self):
        u, y = record(4000)
        for name, f in every_filter().items():
            if name in ("StateObserver", "Kfd", "Mdob"):  # no disturbance, forgetting it, no friction
                continue
            with self.subTest(name):
                self.assertAlmostEqual(np.median(f.filter(u, y).d[-500:]), 0.5, delta=0.1)

    def test_the_estimates_of_a_run_come_out_of_its_own_record(self):
        run = bw.run("motor_estimation", case="stf", duration=2)
        plant = bw.damped_inertia(1.0)
        quantum = 2 * np.pi / 2**12
        period_s = run.config["control"]["period_s"]
        f = bw.Stf(*plant, delta=quantum, rounding="truncate", period_s=period_s)
        estimates = f.filter(run["applied_Nm"], run["position_measured_rad"], x0=[0.0, 0.0])
        np.testing.assert_array_equal(estimates.x[:, 0], run["position_hat_rad"])
        np.testing.assert_array_equal(estimates.x[:, 1], run["velocity_hat_rad_s"])
        np.testing.assert_array_equal(estimates.d[:, 0], run["d_hat_Nm"])
        np.testing.assert_array_equal(estimates.innovation[:, 0], run["innovation"])
        np.testing.assert_array_equal(estimates.forgetting, run["lambda"])
        # The plant may be sampled. The period then only scales the prior.
        sampled = bw.Stf(*bw.zero_order_hold(*plant, period_s), delta=quantum, rounding="truncate")
        again = sampled.filter(run["applied_Nm"], run["position_measured_rad"], x0=[0.0, 0.0])
        self.assertLess(np.abs(again.d[-1] - estimates.d[-1])[0], 0.5)

    def test_several_inputs_and_outputs(self):
        A2, B2, C2 = (scipy.linalg.block_diag(M, M) for M in (A, B, C))
        poles = [[-10, -11, -12], [-10, -11, -12]]
        u, y = record(300)
        one = bw.Idob(A, B, C, poles=poles[0], period_s=PERIOD).filter(u, y)
        two = bw.Idob(A2, B2, C2, poles=poles, period_s=PERIOD).filter(
            np.column_stack([u, 0 * u]), np.column_stack([y, 0 * y]))
        np.testing.assert_allclose(two.d[:, 0], one.d[:, 0], atol=1e-9)
        np.testing.assert_allclose(two.d[:, 1], 0.0, atol=1e-12)

    def test_the_quadrotors_filter_gives_the_estimates_of_its_run(self):
        run = bw.run("quadrotor_waves", case="resonator", duration=1)
        settings = run.config["estimator"]
        self.assertEqual(settings["filter"], "ukf")
        f = bw.QuadrotorFilter("ukf", disturbance="none", position_std_m=0.1, angle_std_rad=0.01)
        motion, force = f.filter(run["thrust_applied_N"], run["pose_measured"])
        self.assertEqual((motion.shape, force.shape), ((100, 12), (100, 3)))
        f.reset(run["pose_measured"][0])
        for k in range(100):
            one, _ = f.update(run["thrust_applied_N"][max(k - 1, 0)], run["pose_measured"][k])
            np.testing.assert_array_equal(one, motion[k])
        within_pi = run["pose_measured"].copy()
        within_pi[50:, 3:] -= 2 * np.pi
        np.testing.assert_allclose(f.filter(run["thrust_applied_N"], within_pi).motion, motion, atol=1e-12)
        off = motion[:, :3] - run["motion_true"][:, :3]
        self.assertLess(np.sqrt((off[50:] ** 2).mean()), 0.1)  # better than the measurement

    def test_lists_float32_and_strides_are_taken(self):
        u, y = record(50)
        f = every_filter()["Stf"]
        x = f.filter(u, y).x
        np.testing.assert_array_equal(f.filter(list(u), y.tolist()).x, x)
        np.testing.assert_array_equal(f.filter(np.repeat(u, 2)[::2], y.reshape(-1, 1)).x, x)
        f.filter(u.astype(np.float32), np.round(1e3 * y).astype(int))
        self.assertEqual(f.filter([], []).x.shape, (0, 2))
        masked = np.ma.array([0.1, 9e9, 0.3], mask=[False, True, False])
        np.testing.assert_array_equal(f.filter(np.zeros(2), masked[::2]).x, f.filter(np.zeros(2), [0.1, 0.3]).x)

    def test_one_filter_in_two_threads_does_not_crash(self):
        u, y = record(20000)
        f = every_filter()["Stf"]
        expected = f.filter(u, y).x[-1]
        results = []
        threads = [threading.Thread(target=lambda: results.append(f.filter(u, y).x[-1])) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for result in results:
            np.testing.assert_array_equal(result, expected)


class Interrupted(Exception):
    pass


class Work(unittest.TestCase):
    def switch(self, seconds):
        self.addCleanup(sys.setswitchinterval, sys.getswitchinterval())
        sys.setswitchinterval(seconds)

    def test_threads_with_one_object_do_not_hang(self):
        self.switch(1e-6)
        u, y = record(2000)
        qp = bw.QpSolver(np.eye(2), np.eye(2))
        every = {name: (f, [0.0, 0.0], lambda f: f.update(0.1, 0.2), lambda f: f.filter(u, y))
                 for name, f in every_filter().items() if name in ("Stf", "qbank")}
        every["quadrotor"] = (bw.QuadrotorFilter(), np.zeros(6), lambda f: f.update(np.ones(4), np.zeros(6)),
                              lambda f: f.filter(np.ones((50, 4)), np.zeros((50, 6))))
        every["qp"] = (qp, None, lambda f: f.solve([-1.0, -1.0], None, [0.5, 0.5]), lambda f: None)
        for name, (f, start, update, whole) in every.items():
            def work(k):
                for i in range(400):
                    (update, lambda f: f.reset() if start is None else f.reset(start), update)[k](f)
                    if i % 100 == k:
                        whole(f)

            with self.subTest(name):
                threads = [threading.Thread(target=work, args=(k,)) for k in range(3)]
                for thread in threads:
                    thread.start()
                for thread in threads:
                    thread.join()

    def test_others_go_on(self):
        self.switch(1000)  # nobody gets the interpreter's lock who is not given it
        random = np.random.default_rng(1)
        wide, narrow, eye = random.normal(size=(60, 60)) / 8, random.normal(size=(60, 1)), np.eye(60)
        poles = [[0.01 * k for k in range(60)]]
        run = bw.run("motor_estimation", case="stf", duration=1)
        u, y = record(20000)
        laps, is_over = [0], threading.Event()

        def others():
            while not is_over.wait(1e-6):
                laps[0] += 1

        with temporary_folder() as folder:
            run.save(folder / "run")
            thread = threading.Thread(target=others)
            thread.start()
            try:
                for name, work in {
                    "dare": lambda: _core.dare(wide, wide, eye, eye),
                    "place_poles": lambda: _core.place_observer_poles(wide.T, narrow.T, poles),
                    "zero_order_hold": lambda: _core.zero_order_hold(wide, wide, wide, 0.1),
                    "QpSolver": lambda: _core.Qp(eye, eye, True, 10),
                    "filter": lambda f=every_filter()["Stf"]: f.filter(u, y),
                    "load": lambda: _core.SavedRun(folder / "run"),
                    "save": lambda: run._core.save(str(folder / "saved")),
                }.items():
                    with self.subTest(name):
                        for _ in range(1000):  # it may not wake before the work is done
                            before = laps[0]
                            try:
                                work()
                            except bw.InputError:
                                pass
                            if laps[0] > before:
                                break
                        else:
                            self.fail("it never went on")
            finally:
                is_over.set()
                thread.join()

    def test_a_signal_is_heard_at_once(self):
        """The handler may use the object at work, and finds the thread at work."""
        stf, quadrotor = every_filter()["Stf"], bw.QuadrotorFilter()
        zeros = np.zeros(4_000_000)
        wide = np.random.default_rng(1).normal(size=(400, 400)) / 20
        others = threading.active_count()

        def threads():
            with open("/proc/self/status") as status:
                return int(next(line for line in status if line.startswith("Threads:")).split()[1])

        alone = threads()

        for name, work, look in (
            ("filter", lambda: stf.filter(zeros, zeros), lambda: stf.reset([0.0, 0.0])),
            ("quadrotor", lambda: quadrotor.filter(np.ones((10**5, 4)), np.zeros((10**5, 6))),
             lambda: quadrotor.reset(np.zeros(6))),
            ("dare", lambda: bw.dare(wide, wide[:, :5], np.eye(400), np.eye(5)),
             lambda: self.assertEqual(threads(), alone + 1)),
        ):
            def handle(*_):
                look()
                raise Interrupted

            with self.subTest(name):
                before = signal.signal(signal.SIGALRM, handle)
                try:
                    signal.setitimer(signal.ITIMER_REAL, 0.2)
                    self.assertRaises(Interrupted, work)
                finally:
                    signal.signal(signal.SIGALRM, before)
        stf.filter(zeros[:9], zeros[:9])  # it still works


class Floats(unittest.TestCase):
    def test_the_callers_rounding_changes_no_bit(self):
        libm = ctypes.CDLL("libm.so.6")
        u, y = record(40)
        A_d, Q = np.array([[1.0, 0.1], [0.0, 0.9]]), np.eye(2)

        def bits():
            found = [bw.dare(A_d, B, Q, 1.0), bw.zero_order_hold(A, B, C, PERIOD)]
            for estimator in every_filter().values():
                found += [estimator.update(*sample) for sample in zip(u, y)]
            return [np.asarray(part).tobytes() for parts in found for part in parts]

        usual = bits()
        before = libm.fegetround()
        for mode in (0x400, 0x800, 0xC00):  # down, up, towards zero
            libm.fesetround(mode)
            try:
                found, still = bits(), libm.fegetround()
            finally:
                libm.fesetround(before)
            self.assertEqual((found, still), (usual, mode))


if __name__ == "__main__":
    unittest.main()
