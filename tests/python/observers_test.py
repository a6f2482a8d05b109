"""The observers of an axis, compared with textbook recursions in dense matrices, with closed forms,
and with each other."""

import functools
import unittest

import numpy as np
import scipy.linalg

import breakwater as bw
from support import near

INF, NAN = np.inf, np.nan
T, NOISE = 0.01, 0.02


def axis(inertia=1.0, friction=0.4, period_s=T):
    return dict(zip("ABC", bw.damped_inertia(inertia, friction)), period_s=period_s)


def extended(plant, order=0):
    """A, B and C of a plant, which is sampled if it has no period, with the disturbance."""
    A, B, C, period_s = (plant.get(key) for key in ("A", "B", "C", "period_s"))
    sampled = bw.zero_order_hold(A, B, C, period_s) if period_s else (A, B, C)
    return bw.extend_by_disturbance_model(*sampled, order, period_s or 1.0)


def random_plant(random, n, m, p):
    """A stable sampled plant."""
    A = random.uniform(-1, 1, (n, n))
    A *= random.uniform(0.5, 0.98) / np.abs(np.linalg.eigvals(A)).max()
    return {"A": A, "B": random.uniform(-1, 1, (n, m)), "C": random.uniform(-1, 1, (p, n))}


def plain(e, S):
    """A Kalman filter without adaptation: see textbook()."""
    return 1.0, None, np.subtract, 1.0


def textbook(plant, u, y, Q, R, P0, adapt=plain):
    """x, e, lambda and A - K C of a Kalman filter. adapt(e, C P C') returns the factor of P(k|k-1),
    R, P(k|k) as a function of P and K C P, and lambda."""
    A, B, C = plant
    x, P, rows = np.zeros(len(A)), P0, []
    for k in range(len(y)):
        if k > 0:
            x, P = A @ x + B @ u[k - 1], A @ P @ A.T + Q
        e = y[k] - C @ x
        factor, noise, forget, forgetting = adapt(e, C @ P @ C.T)
        P = factor * P
        K = P @ C.T @ np.linalg.inv(C @ P @ C.T + (R if noise is None else noise))
        x = x + K @ e
        P = forget(P, K @ C @ P)
        rows.append((x, e, forgetting))
    x, e, forgetting = (np.array(column) for column in zip(*rows))
    return x, e, forgetting, A - K @ C


def record(random, samples=300, m=1, p=1, scale=1.0):
    """Inputs and measurements, with outliers."""
    y = scale * random.uniform(-1, 1, (samples, p))
    y[::50] *= 30
    return random.uniform(-3, 3, (samples, m)) * scale, y


def sensor(delta=0.0, sigma=0.0):
    return {"delta": delta, "sigma": sigma}


NOISY = sensor(0.0, NOISE)


def published(name, error, q=0.1, plant=None, unit=1, **keys):
    """A published filter of an axis, with P0 = diag(1e-2, 0.5, 2)."""
    P0 = [unit**2 * variance for variance in (1e-2, 0.5, 2.0)]
    return bw.Observer(name, **(plant or axis()), **error, disturbance_order=0, process_noise=q,
                       initial_covariance=P0, **keys)


def mhe(error, q=0.1, **keys):
    return bw.Observer("mhe", **axis(), **error, disturbance_order=0, process_noise=q, **keys)


def step(f, u, y):
    """A sample of any numbers."""
    return f._core.update(np.array([float(u)]), np.array([float(y)]))


class Estimators(unittest.TestCase):
    def expect_same(self, a, b, tolerance):
        for ours, its in zip(a, b):
            size = 1 + np.linalg.norm(its.reshape(len(its), -1), axis=1)
            off = np.linalg.norm((ours - its).reshape(len(its), -1), axis=1) / size
            self.assertLess(off.max(), tolerance, np.argmax(off))

    def expect_textbook(self, f, u, y, found, tolerance=1e-8):
        x, d, innovation, forgetting = f.filter(u, y, x0=np.zeros(f._states))
        its_x, e, its_forgetting, F = found
        both = np.hstack([x, d])
        self.expect_same((both, innovation, forgetting),
                         (its_x[:, :both.shape[1]], e, its_forgetting), tolerance)
        if len(f.pole_matrix):
            self.expect_same([f.pole_matrix[None]], [F[None]], tolerance)


class Forgetting(Estimators):
    def test_each_filter_is_its_equation(self):
        """Random plants of 1 to 4 states, 1 or 2 inputs and outputs and all orders of the
        disturbance. One output with up to six states has a recursion of its own."""
        random = np.random.default_rng(3)
        low, high = 1.0, 0.0
        for k in range(24):
            n, p = 1 + k % 4, 1 + k // 4 % 2
            m = min(n, p) if k < 16 else 1
            plant, order = random_plant(random, n, m, p), k % 3 if p == 1 and n < 4 else 0
            if k % 2 == 0:
                plant["C"] = np.eye(p, n)
            model = extended(plant, order)
            N, keys = len(model.A), {**plant, "order": order}
            u, y = record(random, 300, m, p)
            R, q, P0 = random.uniform(0.1, 2), random.uniform(0.01, 1), random.uniform(0.1, 1, N)
            on = ("input", "all", "disturbance")[k % 3]
            last = np.zeros((N, m))
            last[-m:] = np.eye(m)
            Q = q * {"input": model.B @ model.B.T, "all": np.eye(N),
                     "disturbance": last @ last.T}[on]
            noise = dict(Q=q, R=R, P0=P0.tolist(), noise_on=on)
            all_of_kfd = (model, u, y, Q, R * np.eye(p), np.diag(P0))
            close = 1e-11 if n < 4 and order == 0 else 1e-8
            same = functools.partial(self.expect_textbook, tolerance=close)
            with self.subTest(n=n, m=m, p=p, order=order):
                same(bw.Kfd(**keys, **noise), u, y, textbook(*all_of_kfd))
                G = 1.05 * np.diag([1.0] * n + [1.1] * (N - n))
                root = np.sqrt(G)
                forms = {"symmetric": lambda P, KCP: root @ (P - KCP) @ root,
                         "printed": lambda P, KCP: G @ P - KCP,
                         "left": lambda P, KCP: G @ (P - KCP)}
                for form, forget in forms.items():
                    if form == "symmetric" or p == 1:
                        f = bw.Fakfd(**keys, **noise, gamma=1.05, gamma_d=1.1, covariance_form=form)
                        same(f, u, y, textbook(
                            *all_of_kfd, lambda e, S: (1, None, forget, 1 / 1.05 / 1.1)))
                delta, sigma = random.uniform(0.1, 0.3, p), random.uniform(0, 0.1, p)

                def variable(dead_zone, alpha, least, most):
                    def adapt(e, S):
                        size = np.sign(e) * np.maximum(np.abs(e) - dead_zone, 0) / np.sqrt(alpha)
                        value = most - size @ np.linalg.inv(np.eye(p) + S) @ size
                        value = np.clip(value, least, most)
                        return 1, value * np.eye(p), lambda P, KCP: (P - KCP) / value, value
                    return adapt

                alpha = np.maximum((delta / 2) ** 2, (1.5 * sigma) ** 2)
                found = textbook(model, u, y, 0, None, 1e-6 * np.eye(N),
                                 variable(delta + 4.5 * sigma, alpha, 0.8, 1))
                same(bw.Qvff(**keys, delta=delta, sigma=sigma), u, y, found)
                low, high = min(low, found[2].min()), max(high, found[2].max())
                if n == 2 and m == p == 1:
                    del noise["R"]
                    f = bw.Vfakfd(**keys, **noise, alpha=4.0, dead_zone=0.2, lambda_min=0.6,
                                  lambda_max=0.98)
                    same(f, u, y, textbook(*all_of_kfd, variable(0.2, 4.0, 0.6, 0.98)))

                R = np.diag(delta**2 / 12 + sigma**2)

                def tracking(e, S):
                    is_open = np.abs(e) > delta + 5 * sigma + 2 * np.sqrt(np.diag(S))
                    factor = np.where(is_open, 4 * e**2 / np.diag(S + R), 1).clip(1, 1e6).max()
                    return factor, R, np.subtract, 1 / factor

                if order == 0:  # with more its inflations lose all digits of P
                    prior = 0.01 * R.max() * np.eye(N)
                    same(bw.Stf(**keys, delta=delta, sigma=sigma), u, y,
                         textbook(model, u, y, 0, R, prior, tracking), tolerance=1e-5)
        self.assertEqual((low, high), (0.8, 1.0))

    def test_the_priors_of_a_sampled_axis(self):
        """STF's P0 is R/100 diag(1, 1, 1/T^2); without an alpha VFAKFD has 1/(b_reso T)."""
        u, y = record(np.random.default_rng(1), 50)
        for truncates, share in ((False, 12), (True, 3)):
            R = 0.02**2 / share
            f = bw.Stf(**axis(), delta=0.02, rounding="truncate" if truncates else "nearest")
            wide = 1e-9 * y  # within the gate
            self.expect_textbook(f, u[:5] * 0, wide[:5], textbook(
                extended(axis()), u * 0, wide[:5], 0, R, R / 100 * np.diag([1, 1, 1 / T**2])))
        both = [bw.Vfakfd(**axis(), P0=1e-8, **more).filter(u, y).x
                for more in (dict(alpha=0.0, pulses_per_revolution=400), dict(alpha=1 / (400 * T)))]
        np.testing.assert_array_equal(*both)

    def test_one_output_is_two_of_which_one_is_idle(self):
        """Over regular and irregular intervals, with gaps and uncertain times."""
        random = np.random.default_rng(5)
        masses = [[0, 0, 1, 0], [0, 0, 0, 1], [-50, 50, -1, 1], [50, -50, 1, -1]]
        for A, B in (([[-0.4]], [[1]]), bw.damped_inertia(0.5, 0.2)[:2],
                     (masses, [[0], [0], [1], [0]])):
            for order in range(3) if len(A) > 1 else [0]:
                one = {"A": A, "B": B, "C": np.eye(1, len(A)), "period_s": T, "order": order}
                two = {**one, "C": np.vstack([one["C"], 0 * one["C"]])}
                lengths = T * random.uniform(0.5, 1.5, 300)
                lengths[100:] *= random.choice([1, 1, 1, 4], 200)
                t, u = np.cumsum(lengths), random.uniform(-1, 1, 300)
                y = 1e-3 * np.column_stack([np.arange(300) // 7, np.zeros(300)])
                for name, keys in {
                    "kfd": dict(Q=1e-2, R=1e-6, noise_on="disturbance"),
                    "fakfd": dict(Q=1e-2, R=1e-6, noise_on="disturbance", gamma=1.05),
                    "qvff": sensor(1e-3, 1e-4), "stf": sensor(1e-3, 1e-4)}.items():
                    for more in ({}, {"t": t}, {"t": t, "time_std_s": 1e-4}):
                        with self.subTest(name, n=len(A), order=order, more=list(more)):
                            a, b = (bw.Observer(name, **plant, **keys).filter(u, measured, **more)
                                    for plant, measured in ((one, y[:, 0]), (two, y)))
                            self.expect_same((a.x, a.d), (b.x, b.d), 1e-8)

    def test_they_settle_at_the_solution_of_riccatis_equation(self):
        """A factor G makes it the solution for A sqrt(G)."""
        random = np.random.default_rng(21)
        for k in range(12):
            n, p = 1 + k % 3, 1 + k % 2
            plant, order = random_plant(random, n, 1, p), k % 3 if p == 1 else 0
            model, q, R = extended(plant, order), random.uniform(0.01, 1), random.uniform(0.1, 2)
            N = len(model.A)
            for gamma, gamma_d in ((1.0, 1.0), (1.05, 1.0), (1.0, 1.1)):
                f = bw.Fakfd(**plant, order=order, Q=q, noise_on="all", R=R, gamma=gamma,
                             gamma_d=gamma_d)
                f.filter(np.zeros(5000), np.zeros((5000, p)))
                root = np.sqrt(gamma * np.array([1.0] * n + [gamma_d] * (N - n)))
                X = scipy.linalg.solve_discrete_are((model.A * root).T, model.C.T, q * np.eye(N),
                                                    R * np.eye(p))
                K = X @ model.C.T @ np.linalg.inv(model.C @ X @ model.C.T + R * np.eye(p))
                np.testing.assert_allclose(f.pole_matrix, model.A - K @ model.C, atol=1e-7)

    def test_they_find_a_constant_disturbance(self):
        random = np.random.default_rng(10)
        for _ in range(10):  # a damped mass on a spring
            mass = random.uniform(0.2, 2)
            A = np.array([[0, 1], -random.uniform(0, [5, 2]) / mass])
            plant = {"A": A, "B": [[0], [1 / mass]], "C": [[1, 0]], "period_s": 0.1}
            model, x, y = extended(plant), np.array([0, 0, 2.5]), []
            u = random.uniform(-1, 1, (2000, 1))
            for held in u:
                y.append(model.C @ x)
                x = model.A @ x + model.B @ held
            for f in (bw.Kfd(**plant, Q=0.01), bw.Fakfd(**plant, Q=0.01, gamma=1.05),
                      bw.Fakfd(**plant, Q=0.01, gamma_d=1.05), bw.Vfakfd(**plant, alpha=1e-4, P0=1),
                      bw.Qvff(**plant, delta=1e-2), bw.Stf(**plant, delta=1e-2),
                      bw.Idob(**plant, poles=[-1, -2, -3])):
                self.assertAlmostEqual(f.filter(u, y).d[-1, 0], 2.5, delta=0.05)


class Placed(unittest.TestCase):
    def test_the_error_follows_the_error_dynamics(self):
        """e(k+1) = (A - H C) e(k) with a constant disturbance, for any input. The estimate at a
        sample does not include its measurement (Eqs. 2.21, 2.22)."""
        plant, d, random = axis(2.0, 0.0), 3.0, np.random.default_rng(1)
        model, f = extended(plant), bw.Idob(**plant, poles=[-10, -20, -30])
        f.reset([0.1, 0.0])
        x, error, u = np.array([0.4, -0.2, d]), np.array([0.3, -0.2, d]), NAN
        for k in range(500):
            found, d_hat = step(f, u, x[0])
            self.assertEqual(f.innovation, x[0] - found[0])
            near(x - [*found, *d_hat], error, atol=1e-10)
            u = random.uniform(-5, 5)
            x, error = model.A @ x + model.B[:, 0] * u, f.pole_matrix @ error
        self.assertAlmostEqual(f.d[0], d, delta=1e-8)

    def test_the_error_has_the_placed_poles(self):
        """By Cayley and Hamilton the product of all F - z is 0 if the z are the eigenvalues of F.
        This stays accurate for a plant that is hard to observe."""
        random = np.random.default_rng(22)
        for k in range(40):
            is_plain = k >= 20
            n = 1 + is_plain + k % 3
            plant = {key: random.uniform(-1, 1, size) for key, size in
                     zip("ABC", ((n, n), (n, 1), (1, n)))}
            plant["period_s"] = random.uniform(0.05, 0.3)
            poles = -2 - 1.5 * np.arange(n + 1 - is_plain)
            F = (bw.StateObserver if is_plain else bw.Idob)(**plant, poles=poles).pole_matrix
            factors = [F - np.exp(pole * plant["period_s"]) * np.eye(len(F)) for pole in poles]
            size = np.prod([np.linalg.norm(factor) for factor in factors])
            product = functools.reduce(np.matmul, factors)
            self.assertLessEqual(np.linalg.norm(product), 1e-11 * size)

    def test_a_state_observer_is_biased_by_a_disturbance(self):
        plant = axis(0.625, 0.78)
        A, B, C = bw.zero_order_hold(*(plant[key] for key in ("A", "B", "C", "period_s")))
        f = bw.StateObserver(**plant, poles=[-20, -25])
        for d, is_found in ((0.0, True), (1.0, False)):
            x = np.array([0.3, -0.2])
            f.reset()
            for _ in range(400):
                found, d_hat = f.update(0.7, C @ x)
                off = np.linalg.norm(found - x)
                self.assertEqual(d_hat, 0)
                x = A @ x + B[:, 0] * (0.7 - d)
            self.assertEqual(off < (1e-9 if is_found else 1e-3), is_found)

    def test_the_mdob(self):
        def mdob(J, cutoff, derivative, period_s):
            f = bw.Mdob(J, low_pass_cutoff_rad_s=cutoff, derivative_cutoff_rad_s=derivative,
                        period_s=period_s)
            step(f, NAN, 0)
            return f

        # At rest under a torque: the disturbance is it, its estimate a low-pass, exact at samples.
        f = mdob(1.5, 80, 300, 1e-3)
        for k in range(1, 101):
            self.assertAlmostEqual(f.update(7, 0)[1][0], -7 * np.expm1(-80 * k * 1e-3), delta=1e-12)
        # Free acceleration needs no disturbance. The error vanishes with the period.
        J, torque, previous = 0.8, 2.0, INF
        for period_s in (1e-3, 1e-4, 1e-5):
            f = mdob(J, 100, 1e4, period_s)
            t = period_s * np.arange(1, round(0.3 / period_s))
            d = [f.update(torque, q)[1][0] for q in 0.5 * torque / J * t**2]
            error = np.abs(np.array(d)[t > 0.2]).max()
            self.assertLess(error, 0.5 * previous)
            previous = error
        self.assertLess(previous, 0.02 * torque)
        # J dv/dt = u - d with u = 0: a positive disturbance pushes the joint back.
        f = mdob(1, 50, 2000, 1e-4)
        for k in range(1, 10001):
            x, d = f.update(0, -5 * (1e-4 * k) ** 2)
        self.assertAlmostEqual(d[0], 10, delta=0.05)
        self.assertAlmostEqual(x[1], -10, delta=0.02)
        # Without a derivative's cut-off it is the raw difference; one sample gives none.
        f = bw.Mdob(1.0, low_pass_cutoff_rad_s=50, period_s=1e-3)
        np.testing.assert_array_equal(f.update(0, 0.5)[0], [0.5, 0])
        np.testing.assert_allclose(f.update(0, 0.7)[0], [0.7, 200])

    def test_models_of_a_disturbance(self):
        plant = axis(0.625, 0.78, 0.1)
        A, B, C, _ = plant.values()
        ours = extended(plant)
        held = bw.zero_order_hold(np.block([[A, -B], [np.zeros((1, 3))]]), np.vstack([B, [[0]]]),
                                  np.hstack([C, [[0]]]), 0.1)
        for part, its in zip(ours, held):
            near(part, its, atol=1e-14)
        # Eq. 4.3: d(k) = d + k T d' + k (k - 1)/2 T^2 d''.
        A, B, C = bw.zero_order_hold(A, B, C, 0.1)
        for order in range(3):
            model = extended(plant, order)
            x, truth = np.array([0, 0, 0.7, -0.3, 0.2][:3 + order]), np.zeros(2)
            for k in range(50):
                terms = [0.7, -0.3 * 0.1 * k, 0.2 * 0.01 * k * (k - 1) / 2]
                d = sum(terms[:order + 1])
                near(x[:3], [*truth, d], atol=1e-12)
                x, truth = model.A @ x, A @ truth - B[:, 0] * d
        # Each input has its own chain.
        model = bw.extend_by_disturbance_model(*np.eye(2)[None].repeat(3, axis=0), 1, 0.5)
        np.testing.assert_array_equal(model.A @ [0, 0, 1, 2, 10, 20], [-1, -2, 6, 12, 10, 20])
        hidden = np.diag([1, 0.5]), [[1], [0]], [[1, 0]]
        self.assertRaisesRegex(bw.InputError, "rank 2 of 3",
                               bw.extend_by_disturbance_model, *hidden, 0, 0.01)
        for wrong in ((3, 0.1), (-1, 0.1), (0, 0.0)):
            self.assertRaises(bw.InputError, bw.extend_by_disturbance_model, A, B, C, *wrong)


class Published(Estimators):
    def test_they_are_the_kalman_filter_in_their_limits(self):
        random = np.random.default_rng(3)
        u, y = record(random)
        y *= 0.1
        model, Q, P0 = extended(axis()), np.diag([0, 0, 0.1]), np.diag([1e-2, 0.5, 2])
        found = textbook(model, u, y, Q, NOISE**2, P0)
        for name, keys in {"immkf": dict(noise_ratio=1.0), "mckf": dict(kernel_width=1e12),
                           "vbakf": dict(forgetting=1.0, prior_samples=1e15),
                           "gsf": dict(parts=1)}.items():
            with self.subTest(name):
                self.expect_textbook(published(name, NOISY, **keys), u, y, found, 1e-10)
        steady = bw.dare(model.A.T, model.C.T, Q, NOISE**2).S
        found = textbook(model, u, y, Q, NOISE**2, steady)
        for horizon in (1, 2, 7):
            for code_constraints in (True, False):  # without an encoder there are none
                f = mhe(NOISY, horizon=horizon, code_constraints=code_constraints)
                self.expect_textbook(f, u, y, found, 1e-6)

    def walk(self, seed, samples, jump, every, after):
        """Inputs and noisy measurements with jumps."""
        random = np.random.default_rng(seed)
        k = np.arange(samples)
        y = np.where(k % every > after, jump, 0) + random.uniform(-NOISE, NOISE, samples)
        return random.uniform(-1, 1, (samples, 1)), y[:, None]

    def logged(self, case, **own):
        """The model, inputs, measurements, R, Q of d and P0 of a run's observer, and the run."""
        run = bw.run("motor_estimation", case, duration=2, set={
            "disturbance.start_s": 1, "disturbance.amplitude_Nm": 100,
            **{f"observer.{key}": value for key, value in own.items()}})
        R, own = (2 * np.pi / 4096) ** 2 / 3, run.config["observer"]
        y, u = run["position_measured_rad"][:, None], run["command_Nm"][:, None]
        return (extended(axis(1.0, 0.0, 1e-3)), u, y, R, own["process_noise"],
                np.diag(own["initial_covariance"]), run)

    def immkf(self, model, u, y, R, q, P0, stays):
        """x, innovation and weight of the busy model."""
        A, B, _ = model
        stay = np.array([[stays[0], 1 - stays[0]], [1 - stays[1], stays[1]]])
        x, mu, rows, P = np.zeros((2, 3)), np.full(2, 0.5), [], np.array([P0, P0])
        for k in range(len(y)):
            c, x0, P0 = mu, x, P
            if k > 0:
                c = mu @ stay
                share = stay * mu[:, None] / c
                x0 = share.T @ x
                P0 = [sum(share[i, j] * (P[i] + np.outer(x[i] - x0[j], x[i] - x0[j]))
                          for i in range(2)) for j in range(2)]
                P0 = np.array([A @ P0[j] @ A.T + np.diag([0, 0, q[j]]) for j in range(2)])
                x0 = x0 @ A.T + B[:, 0] * u[k - 1]
            S, e = P0[:, 0, 0] + R, y[k] - x0[:, 0]
            K = P0[:, :, 0] / S[:, None]
            x = x0 + K * e[:, None]
            P = P0 - K[:, :, None] * P0[:, None, 0]
            far = e**2 / S
            mu = c * np.exp(0.5 * (far.min() - far)) / np.sqrt(S)
            mu = mu / mu.sum()
            rows.append((mu @ x, c @ e, mu[1]))
        return (np.array(column) for column in zip(*rows))

    def test_immkf_is_the_textbook_recursion(self):
        u, y = self.walk(8, 400, 0.3, 80, 60)
        y += 0.03 * np.sin(0.2 * np.arange(400))[:, None]
        x, e, mu = self.immkf(extended(axis()), u, y, NOISE**2, (1e-3, 1e5),
                              np.diag([1e-2, 0.5, 2]), (0.95, 0.6))
        self.assertTrue(mu.max() > 0.9 and mu.min() < 0.1)
        f = published("immkf", NOISY, 1e-3, noise_ratio=1e8, stays_quiet=0.95, stays_busy=0.6)
        found = f.filter(u, y, x0=[0, 0])
        self.expect_same([found.x, found.d, found.innovation],
                         [x[:, :2], x[:, 2:], e[:, None]], 1e-9)
        *inputs, q, P0, run = self.logged("immkf", noise_ratio=1e8)
        *_, mu = self.immkf(*inputs, (q, 1e8 * q), P0, (0.999, 0.5))
        self.assertGreater(np.ptp(mu), 0.5)
        near(run["model_weight"][:, 1], mu, atol=1e-9)

    def test_mckf_is_the_multi_kernel_filter_of_the_paper(self):
        """It has a kernel for each row of the Cholesky factor of P(k|k-1), d first."""
        u, y = self.walk(9, 300, 0.4, 60, 45)
        first = [2, 0, 1]
        A, B, C = extended(axis())
        A, B, C = A[first][:, first], B[first, 0], C[:, first]
        x, P, rows = np.zeros(3), np.diag([2, 1e-2, 0.5]), []
        for k in range(300):
            if k > 0:
                x, P = A @ x + B * u[k - 1], A @ P @ A.T + np.diag([1e-2, 0, 0])
            L, last = np.linalg.cholesky(P), x
            for _ in range(5):
                e = np.linalg.solve(L, x - last)
                weight = max(1e-4, np.exp(-e[0] ** 2 / (2 * 1.5**2)))
                raised = L @ np.diag([1 / weight, 1, 1]) @ L.T
                K = raised @ C.T / (C @ raised @ C.T + NOISE**2)
                last = x + K @ (y[k] - C @ x)
            rest = np.eye(3) - K @ C
            x, P = last, rest @ P @ rest.T + K @ K.T * NOISE**2
            rows.append((x, weight))
        x, weight = (np.array(column) for column in zip(*rows))
        self.assertLess(weight.min(), 0.1)
        found = published("mckf", NOISY, 1e-2, kernel_width=1.5).filter(u, y, x0=[0, 0])
        self.expect_same([found.x, found.d, found.forgetting], [x[:, 1:], x[:, :1], weight], 1e-7)

    def vbakf(self, model, u, y, R, q, P0, rho, tau, iterations):
        """x, R, and how far the prior differs from P, in parts of it, at most."""
        A, B, C = model
        x, P, farthest, rows = np.zeros(3), P0, 0.0, []
        u_R = 2 + 1 / (1 - rho)
        U_R = (u_R - 2) * R
        for k in range(len(y)):
            if k > 0:
                x, P = A @ x + B[:, 0] * u[k - 1], A @ P @ A.T + np.diag([0, 0, q])
            u_before, U_before = rho * (u_R - 2) + 2, rho * U_R
            now, variance = x, P
            for _ in range(iterations):
                prior = (tau * P + variance + np.outer(now - x, now - x)) / (tau + 1)
                U_R = U_before + (y[k, 0] - now[0]) ** 2 + variance[0, 0]
                u_R = u_before + 1
                R = U_R / (u_R - 2)
                variance = np.linalg.inv(np.linalg.inv(prior) + C.T @ C / R)
                now = x + variance @ C.T @ (y[k] - C @ x) / R
            farthest = max(farthest, np.linalg.norm(prior - P) / np.linalg.norm(P))
            x, P = now, variance
            rows.append((x, R))
        return *(np.array(column) for column in zip(*rows)), farthest

    def test_vbakf_is_the_filter_of_both_covariances(self):
        """Huang et al., with the dense parameters of both inverse Wishart distributions. With a
        strong prior of P it is the filter of the noise alone (Sarkka and Nummenmaa)."""
        u, y = self.walk(12, 300, 0.4, 60, 45)
        for rho, tau, iterations in ((0.9, 1e15, 4), (0.9, 3.0, 6)):
            x, _, farthest = self.vbakf(extended(axis()), u, y, NOISE**2, 1e-2,
                                        np.diag([1e-2, 0.5, 2]), rho, tau, iterations)
            self.assertEqual(farthest > 0.02, tau < 10)
            found = published("vbakf", NOISY, 1e-2, forgetting=rho, prior_samples=tau,
                              iterations=iterations).filter(u, y, x0=[0, 0])
            self.expect_same([np.hstack([found.x, found.d])], [x], 1e-7 if tau < 10 else 1e-9)
        *inputs, run = self.logged("vbakf")
        _, R, _ = self.vbakf(*inputs, 0.999, 3.0, 10)
        np.testing.assert_allclose(run["noise_variance"], R, rtol=1e-8)

    def test_the_likelihood_of_a_code(self):
        random = np.random.default_rng(3)
        u, y = record(random)

        def both(a, b, scale, tolerance):
            found = [f.filter(scale * u, scale * y, x0=[0, 0]) for f in (a, b)]
            self.expect_same(found[0][:3], found[1][:3], tolerance)
            self.expect_same([a.pole_matrix[None]], [b.pole_matrix[None]], tolerance)

        # Two ways through the same filter. Jumps leave the interval of the code.
        coarse = sensor(0.05, 1e-3)
        both(published("mckf", coarse, 1e-2, kernel_width=1e12, likelihood="code"),
             published("immkf", coarse, 1e-2, noise_ratio=1.0, likelihood="code"), 0.1, 1e-7)
        # It is a density behind white noise.
        for name, keys in (("immkf", dict(noise_ratio=1e3)), ("mckf", dict(kernel_width=1.0))):
            y[::50] /= 30  # within the gate of the code
            both(published(name, NOISY, 1e-3, likelihood="code", **keys),
                 published(name, NOISY, 1e-3, **keys), 0.01, 1e-9)

    def test_the_likelihood_of_a_code_reduces_the_error_behind_a_coarse_encoder(self):
        """A step of 10 N m at 1 s behind 8 bits that round, in the loop of Eq. 4.22."""
        quantum, h = 2 * np.pi / 256, 1e-3
        plant = axis(1.0, 0.0, h)

        def error(f):
            q = v = squares = 0.0
            u = np.zeros(1)
            for k in range(10001):
                y = quantum * np.round(q / quantum - 0.2) + 0.2 * quantum
                x, d = f.update(u, y)
                squares += (x[1] - v) ** 2 if k >= 5000 else 0.0
                u = -10 * x[0] - np.sqrt(10) * x[1] + d
                a = u[0] - (10.0 if k >= 1000 else 0.0)
                q, v = q + h * (v + 0.5 * h * a), v + h * a
            return squares

        for name, q, keys in (("immkf", 1e-8, dict(noise_ratio=1e4, stays_quiet=0.999)),
                              ("mckf", 1e-6, dict(kernel_width=3.0))):
            gauss, code = (
                error(published(name, sensor(quantum), q, plant, likelihood=kind, **keys))
                for kind in ("gauss", "code"))
            self.assertLess(code, 0.3**2 * gauss)

    def test_the_first_code_after_a_gap_is_a_whole_interval(self):
        """An edge passed in a gap of measurements is not dated to the last period."""
        quantum, speed = 0.1, 0.3
        for name in ("immkf", "mckf"):
            q = 0.0
            f = published(name, sensor(quantum), 1e-8, axis(1.0, 0.0), likelihood="code")

            def go_on(is_measured=True):
                nonlocal q
                q += speed * T
                code = quantum * np.round(q / quantum)
                return code, step(f, 0, code if is_measured else NAN)[0]

            for _ in range(1000):
                before, _ = go_on()
            while before > q:  # to the middle of a code
                before, _ = go_on()
            for _ in range(20):
                go_on(False)
            code, x = go_on()
            self.assertAlmostEqual(code - before, quantum)
            self.assertAlmostEqual(x[0], q, delta=2e-3)
            self.assertAlmostEqual(x[1], speed, delta=0.05 * speed)

    def test_mhe_keeps_the_estimate_within_the_code(self):
        quantum, k = 0.1, np.arange(600)
        y = quantum * np.round(0.8 * np.sin(0.01 * k) / quantum)
        outside = [np.max(np.abs(mhe(sensor(quantum), 1e-4, horizon=12, code_constraints=bounded)
                                 .filter(0 * y, y, x0=[0, 0]).x[:, 0] - y) - quantum / 2)
                   for bounded in (True, False)]
        self.assertLess(outside[0], 0.01 * quantum)
        self.assertGreater(outside[1], 0.1 * quantum)

    def test_eso_is_its_equation(self):
        """Linear, and with Han's gains beyond the linear zone."""
        u, y = record(np.random.default_rng(4))
        for plant, bandwidth, zone in ((axis(2.0, 0.3), 20, 0), (axis(), 30, 0.4),
                                       (axis(), 30, 1e-3)):
            A, B, C = extended(plant)
            pole = np.exp(-bandwidth * T)
            gain = bw.place_observer_poles(A, C @ A, 3 * [pole])[:, 0]
            f = bw.Observer("eso", **plant, bandwidth_rad_s=bandwidth, linear_zone=zone)
            np.testing.assert_allclose(f.pole_matrix, A - np.outer(gain, C @ A), atol=1e-12)
            x, rows = np.zeros(3), []
            for k in range(300):
                x = A @ x + B[:, 0] * u[k - 1] if k > 0 else x
                e = y[k, 0] - x[0]
                fal = [e if zone == 0 or abs(e) <= zone
                       else np.sign(e) * abs(e) ** a * zone ** (1 - a) for a in (1.0, 0.5, 0.25)]
                x = x + gain * fal
                rows.append(x)
            found = f.filter(u, y, x0=[0, 0])
            self.expect_same([np.hstack([found.x, found.d])], [np.array(rows)], 1e-9)
        # (s^2 + 3 w s + 3 w^2) s/(s + w)^3 of a ramp ends at 3 slope/w.
        plant = axis(2.0, 0.3, 1e-4)
        A, B, C = bw.zero_order_hold(plant["A"], plant["B"], plant["C"], 1e-4)
        f, x = bw.Observer("eso", **plant, bandwidth_rad_s=20), np.zeros(2)
        for k in range(20000):
            d_hat, d = f.update(0, x[0])[1][0], 5 * k * 1e-4
            x = A @ x - B[:, 0] * d
        self.assertAlmostEqual((d - d_hat) / (3 * 5 / 20), 1, delta=0.01)

    def test_the_tracking_differentiator(self):
        """Its double integrator reaches 1 in the time 2 sqrt(1/r), with the acceleration r half of
        it."""
        h, r = 1e-3, 4.0
        plant = axis(1.0, 0.0, h)
        f = bw.Observer("tracking_differentiator", **plant, largest_acceleration=r,
                        filter_samples=1, low_pass_cutoff_rad_s=10)
        x = f.filter(np.zeros(2001), np.ones(2001), x0=[0, 0]).x
        self.assertLessEqual(np.abs(np.diff(x[:, 1], prepend=0)).max(), r * h * (1 + 1e-9))
        self.assertLessEqual(x[:, 0].max(), 1 + 1e-5)
        reached = np.argmax(x[:, 0] > 1 - r * h * h)
        self.assertAlmostEqual(reached * h, 2 * np.sqrt(1 / r), delta=5 * h)
        self.assertAlmostEqual(x[:, 1].max(), np.sqrt(r), delta=5 * r * h)
        # A constant disturbance: 2 (-0.25) = 1 - 1.5. It stays without measurements.
        f = bw.Observer("tracking_differentiator", **axis(2.0, 0.0, h), largest_acceleration=100,
                        filter_samples=3, low_pass_cutoff_rad_s=10)
        for t in h * np.arange(3000):
            found = f.update(1, -0.125 * t * t)[1][0]
        self.assertAlmostEqual(found, 1.5, delta=0.01)
        for _ in range(500):
            step(f, 5, NAN)
        self.assertEqual(f.d[0], found)

    def every(self, error, q=0.1):
        for likelihood in ("gauss", "code"):
            for name in ("immkf", "mckf"):
                yield published(name, error, q, likelihood=likelihood)
        yield published("vbakf", error, q)
        yield published("gsf", error, q, parts=4)
        yield mhe(error, q, horizon=5)
        yield bw.Observer("eso", **axis(), bandwidth_rad_s=20)

    def test_they_only_predict_without_a_measurement_and_start_again_after_an_overflow(self):
        A, B, _ = bw.zero_order_hold(*(axis()[key] for key in ("A", "B", "C", "period_s")))
        for i, f in enumerate(self.every(sensor(0.01, 1e-3))):
            with self.subTest(i):
                f.reset([0.1, 0.2])
                for k in range(20):
                    before, d = step(f, 0.3, 0.1 + 0.002 * k)
                x, d_hat = step(f, 0.7, NAN)
                near(x, A @ before + B[:, 0] * (0.7 - d), atol=1e-6)
                near(d_hat, d, atol=1e-12)
                for u, y in ((NAN, 0.15), (0, 1e308), (0, -1e308), (0, 0.1)):
                    self.assertTrue(np.isfinite(np.concatenate(step(f, u, y))).all(), y)

    def test_they_do_not_depend_on_the_unit(self):
        """In metres and in millimetres."""
        k = np.arange(300)
        u, y = np.sin(0.1 * k), 0.05 * np.round(6 * np.sin(0.05 * k))
        for name, keys in (("immkf", {}), ("mckf", {}), ("immkf", {"likelihood": "code"}),
                           ("mckf", {"likelihood": "code"}), ("gsf", {"parts": 5})):
            found = [published(name, sensor(0.05 * unit, 1e-3 * unit), 1e-2 * unit**2, unit=unit,
                               **keys).filter(unit * u, unit * y, x0=[0, 0]).x / unit
                     for unit in (1, 1000)]
            np.testing.assert_allclose(*found, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
