"""Quadratic programs, Riccati's equation, placed poles and sampled plants, compared with their
definitions, closed forms, CVXOPT, SciPy, and 60 digits of mpmath."""

import os
import types
import unittest

import cvxopt
import mpmath
import numpy as np
import scipy.linalg
import scipy.signal

import breakwater as bw
from breakwater import _core
from support import near

INF, NAN = np.inf, np.nan
STATUSES = ("solved", "iteration_cap", "infeasible", "not_finite", "inaccurate")
EYE = np.eye(2)


def count(few):
    """The number of random inputs of a property: BREAKWATER_PROPERTIES, or a few for CI."""
    return int(os.environ.get("BREAKWATER_PROPERTIES", few))


def powers_of_two(random, *size):
    return 2.0 ** np.round(random.uniform(-27, 27, size))


class Program(types.SimpleNamespace):
    """minimise z' H z / 2 + g' z with lower <= Omega z <= upper."""

    def __init__(self, H, Omega, g, lower=-INF, upper=INF, soft=0.0, **more):
        H, Omega = np.array(H, float), np.array(Omega, float)
        rows = [np.array(np.broadcast_to(x, len(Omega)), float) for x in (lower, upper, soft)]
        super().__init__(H=H, Omega=Omega, g=np.array(g, float), lower=rows[0], upper=rows[1],
                         soft=rows[2], **more)

    def solver(self, exact=True, cap=300):
        return _core.Qp(self.H, self.Omega, exact, cap)

    def solve(self, exact=True, cap=300, solver=None):
        solver = solver or self.solver(exact, cap)
        return bw.QpSolution(*solver.solve(self.g, self.lower, self.upper, self.soft))

    def error(self, s):
        """The KKT residual from the definition, in units in which H has a diagonal of ones and
        rows have the size 1."""
        root = np.sqrt(np.diag(self.H))
        size = np.maximum(np.abs(self.Omega / root).max(axis=1, initial=0.0), np.sqrt(self.soft))
        mu = s.mu * size
        slope = max(np.abs(self.g / root).max(), np.abs(mu).max(initial=0.0))
        bounds = np.abs(np.array([self.lower, self.upper]))[:, size > 0] / size[size > 0]
        bound = bounds[np.isfinite(bounds)].max(initial=0.0)
        reach = size * max(min(np.abs(s.z * root).max(), bound), 1e-9 * slope)
        gradient = np.abs(self.H @ s.z + self.g + self.Omega.T @ s.mu) / root
        values = self.Omega @ s.z - self.soft * s.mu
        above, below = values - self.upper, self.lower - values
        slack = np.where(mu == 0, 0.0, np.abs(np.where(mu > 0, above, below)))
        outside = np.maximum(0.0, np.maximum(above, below))
        with np.errstate(invalid="ignore"):
            shares = np.concatenate([gradient / slope, outside / reach, np.abs(mu) / slope * slack / reach])
        return np.where(np.isnan(shares), 0.0, shares).max(initial=0.0)

    def certificate_error(self, y):
        """0 if y proves that no z satisfies the rows (Farkas), infinity if it proves nothing."""
        root = np.sqrt(np.diag(self.H))
        y, used = y.astype(np.longdouble), y != 0
        bound = np.where(y > 0, self.upper, self.lower)[used]
        size = np.abs(self.Omega / root).max(axis=1)[used]
        reach = max(1e-9 * np.abs(self.g / root).max(),
                    np.abs(bound[size > 0] / size[size > 0]).max(initial=0.0))
        gap = -(y[used] * bound).sum()
        return reach * np.abs((self.Omega.T @ y) / root).sum() / gap if gap > 0 else INF


def cart_program(random, n, m):
    """Rows are random, sums of consecutive variables as in predictive control, or multiples."""
    root = random.uniform(-1, 1, (n, n))
    Omega = random.uniform(-1, 1, (m, n))
    for i, kind in enumerate(random.random(m)):
        if kind < 0.3:
            Omega[i] = np.arange(n) < random.integers(1, n + 1)
        elif kind < 0.35 and i > 0:
            Omega[i] = random.uniform(-2, 2) * Omega[i - 1]
    return Program(root.T @ root + 10 ** random.uniform(-3, 1) * np.eye(n), Omega, np.zeros(n))


def fill(random, p):
    """Bounds that some z satisfies. Some rows have no bounds, some have equal ones."""
    p.g = 10 ** random.uniform(-1, 2) * random.uniform(-1, 1, len(p.H))
    values = p.Omega @ random.uniform(-1, 1, len(p.H))
    kind = random.random(len(values))
    width = np.where(kind < 0.02, 0.0, random.random(len(values)))
    p.lower = np.where(kind < 0.9, values - width, -INF)
    p.upper = np.where((kind < 0.8) | (kind >= 0.95), values + width, INF)


def hard_program(random):
    """2 to 24 variables, 1 to 60 rows, H of any scale with a condition of 1 to 1e8. Rows are
    random, sums of consecutive variables, single variables, zero, or copies, multiples, sums and
    near copies (1e-9 to 1e-3) of others. One z satisfies all, many with equality."""
    n, m = random.integers(2, 25), random.integers(1, 61)
    def rounded(rows):  # few digits make sums of rows exact
        return np.round(2.0**36 * rows) / 2.0**36
    decades = random.uniform(0, 8)
    below = np.concatenate([[0, decades], random.uniform(0, decades, n - 2)])
    axes = np.linalg.qr(random.normal(size=(n, n)))[0]
    H = axes * 10 ** (random.uniform(0, decades) - below) @ axes.T
    Omega = rounded(random.uniform(-1, 1, (m, n)))
    for i, kind in enumerate(random.random(m)):
        if kind < 0.15:
            Omega[i] = np.arange(n) < random.integers(1, n + 1)
        elif kind < 0.2:
            Omega[i] = np.arange(n) == random.integers(n)
        elif kind < 0.35 and i > 0:
            off = rounded(10 ** random.uniform(-9, -3) * Omega[i]) if kind >= 0.31 else 0.0
            Omega[i] = (-0.75 if 0.25 <= kind < 0.28 else 1.0) * Omega[random.integers(i)] + off
            Omega[i] += 0.5 * Omega[random.integers(i)] if 0.28 <= kind < 0.31 else 0.0
        elif kind > 0.995:
            Omega[i] = 0
    values, kind = Omega @ random.uniform(-1, 1, n), random.random(m)
    lower = np.where(kind < 0.3, values, values - random.random(m))
    upper = np.where(kind < random.uniform(0, 0.2), values, values + random.random(m))
    return Program((H + H.T) / 2, Omega, 10 ** random.uniform(-1, 2) * random.uniform(-1, 1, n),
                   np.where(kind > 0.95, -INF, lower),
                   np.where((kind > 0.9) & (kind < 0.95), INF, upper))


def infeasible_program(random):
    """The last row is an exact sum of others, and its bound exceeds theirs by 1e-6 to 10."""
    p = hard_program(random)
    while len(p.Omega) < 2:
        p = hard_program(random)
    p.Omega[-1], most = 0, 0.0
    for row in random.integers(len(p.Omega) - 1, size=random.integers(1, 9)):
        is_upper = p.lower[row] == -INF or (p.upper[row] < INF and random.random() < 0.5)
        weight = (0.125 if is_upper else -0.125) * random.integers(1, 9)
        p.Omega[-1] += weight * p.Omega[row]
        most += weight * (p.upper if is_upper else p.lower)[row]
    p.lower[-1] = most + 10 ** random.uniform(-6, 1)
    p.upper[-1] = INF if random.random() < 0.5 else p.lower[-1] + 1
    return p


def any_program(random):
    """A hard program, or with a bound too many, or with one input that is wrong."""
    p = hard_program(random)
    row, kind, is_nan = random.integers(len(p.lower)), random.random(), random.random() < 0.5
    if kind < 0.2:
        p.lower[row] = p.upper[row] + random.uniform(-1, 1)
    elif kind < 0.3:
        p.soft[row] = 10 ** random.uniform(-6, 2)
    elif kind < 0.4:
        p.g[random.integers(len(p.g))] = NAN if is_nan else random.choice([-INF, INF])
    elif kind < 0.45:
        p.upper[row] = NAN if is_nan else -INF
    elif kind < 0.5:
        p.soft[row] = -1 if is_nan else INF
    elif kind < 0.6:
        p.g *= 10 ** random.uniform(-12, 12)
    return p


FAMILIES = ("box", "dense rows", "a degenerate vertex", "copies of rows", "multiples of rows",
            "near copies", "equations", "narrow bounds", "soft rows", "sums of variables",
            "condition 1e6", "nothing active", "far bounds", "zero rows", "a solution of 0",
            "a weak cost", "no common point")


def known_program(random, family):
    """A program whose solution z comes first: g follows from the multipliers of the rows that are
    active there. z is None if there is no solution."""
    n = random.integers(1, 10)
    m = n if family == "box" else random.integers(2, 25)
    axes = np.linalg.qr(random.normal(size=(n, n)))[0]
    decades = 6 if family == "condition 1e6" else 2
    H = axes * 10 ** random.uniform(-decades, 0, n) @ axes.T
    Omega = np.eye(n) if family == "box" else random.uniform(-1, 1, (m, n))
    z = {"a solution of 0": 0.0, "far bounds": 1e4}.get(family, 1.0) * random.uniform(-1, 1, n)
    new_row = {"copies of rows": lambda other: other, "zero rows": lambda other: 0 * other,
               "multiples of rows": lambda other: random.uniform(-2, 2) * other,
               "near copies": lambda other: other + 1e-2 * random.uniform(-1, 1, n),
               "sums of variables": lambda other: np.arange(n) < random.integers(1, n + 1)}.get(family)
    for i in range(1, m if new_row else 0):
        if random.random() < 0.5 or family == "sums of variables":
            Omega[i] = new_row(Omega[random.integers(i)])
    soft = 10 ** random.uniform(-3, 1, m) if family == "soft rows" else np.zeros(m)
    # Up to n rows are active; at a degenerate vertex, more of them, some without a multiplier.
    active = np.arange(m) < {"nothing active": 0, "a degenerate vertex": m}.get(
        family, random.integers(min(n, m) + 1))
    mu = random.uniform(0.1, 1, m) * random.choice([-1, 1], m) * active
    mu[(np.arange(m) >= n) & (random.random(m) < 0.7)] = 0
    mu[~Omega.any(axis=1)] = 0
    values = Omega @ z - soft * mu
    width = np.where(family == "narrow bounds", 1e-9, random.uniform(0.1, 2, m))
    is_upper = (mu > 0) | ((mu == 0) & (random.random(m) < 0.5))
    is_equation = active & (family == "equations")
    upper = values + np.where(is_equation | (active & is_upper), 0, width)
    lower = values - np.where(is_equation | (active & ~is_upper), 0, width)
    upper[~active & (random.random(m) < 0.2)] = INF
    weight = 1e-5 if family == "a weak cost" else 1.0
    H = weight * (H + H.T) / 2
    p = Program(H, Omega, -H @ z - weight * (Omega.T @ mu), lower, upper, soft / weight, z=z)
    if family == "no common point":  # two rows of one direction contradict each other
        p.Omega[1], p.z = p.Omega[0], None
        p.upper[:2], p.lower[:2] = [values[0], INF], [-INF, values[0] + 10 ** random.uniform(-4, 1)]
    return p


def in_other_units(random, p):
    """z_j = 2^a z_j', rows times 2^b and a cost times 2^c, with a, b, c of -27 to 27."""
    def units(size):
        some = powers_of_two(random, 1) if random.random() < 0.3 else powers_of_two(random, size)
        return np.where(random.random() < 0.7, some, 1.0)
    d, r, c = units(len(p.g)) * np.ones(len(p.g)), units(len(p.lower)), units(1)[0]
    z = None if p.z is None else p.z / d
    return Program(c * p.H * d * d[:, None], (p.Omega.T * r).T * d, c * p.g * d, r * p.lower,
                   r * p.upper, r * r * p.soft / c, z=z)


class QuadraticPrograms(unittest.TestCase):
    def both(self, test):
        for exact in (True, False):
            with self.subTest("active_set" if exact else "hildreth"):
                test(exact)

    def test_by_hand(self):
        def test(exact):
            p = Program(EYE, EYE, [-1, -1], upper=[0.5, 2])
            solver = p.solver(exact, 10000)
            s = p.solve(solver=solver)
            self.assertEqual((s.status, s.mu[1]), ("solved", 0.0))
            near([*s.z, s.mu[0]], [0.5, 1, 0.5], atol=1e-12)
            self.assertLess(s.kkt_residual, 1e-12)
            # The other side of a constraint has a multiplier with the opposite sign.
            s = Program(EYE, EYE, [-1, -1], [1.5, -INF], [2, INF]).solve(solver=solver)
            near([s.z[0], s.mu[0]], [1.5, -0.5], atol=1e-12)
            # z1 + z2 = 2 excludes the minimiser (2, 2). Lagrange gives (2/3, 4/3).
            name = "active_set" if exact else "hildreth"
            qp = bw.QpSolver(np.diag([2, 4]), [[1, 1], [1, -1]], solver=name)
            s = qp.solve([-4, -8], None, [2, INF])
            np.testing.assert_allclose([*s.z, *s.mu], [2 / 3, 4 / 3, 8 / 3, 0], atol=1e-6)
            self.assertGreater(qp.solve([-4, -8], None, [2, INF], softness=[1e3, 0]).z.sum(), 3.9)
            # A soft row is a quadratic penalty: z^2/2 + v^2/(2 s) with v = 1 - z.
            for soft in (0, 0.25, 4):
                s = Program([[1]], [[1]], [0], 1, soft=soft).solve(exact, 10000)
                self.assertEqual(s.status, "solved")
                self.assertAlmostEqual(s.z[0], 1 / (1 + soft), delta=1e-9)
            for row, cost in ((1e-9, 1.0), (2.0**27, 1.0), (1.0, 1e-8), (2.0**-27, 2.0**27)):
                s = bw.solve_qp([[cost]], [-cost], [[row]], None, [0.5 * row], solver=name)
                self.assertAlmostEqual(s.z[0], 0.5, delta=1e-12)
            for p in (Program(EYE, EYE, [0, 0], [1, 0], [0.5, 1]), Program([[1]], [[0]], [-1], 1)):
                s = p.solve(exact, 10000)
                self.assertEqual(s.status, "infeasible")
                self.assertGreater(s.kkt_residual, 0.1)
        self.both(test)
        self.assertRaises(bw.InputError, _core.Qp, EYE, EYE, False, 0)
        for H, Omega in ((-EYE, EYE), (0 * EYE, EYE), (EYE, np.eye(3)), (np.eye(0), np.eye(0)),
                         (NAN * EYE, EYE), (EYE, NAN * EYE), (EYE + [[1, 1], [0, 1]], EYE)):
            for exact in (True, False):
                self.assertRaises(bw.InputError, _core.Qp, H, Omega, exact, 100)

    def test_without_active_rows_it_is_the_newton_step(self):
        def test(exact):
            random = np.random.default_rng(1)
            for rows in (30, 0):
                p = cart_program(random, 5, 30)
                p = Program(p.H, p.Omega[:rows], p.g)
                solver = p.solver(exact)
                for p.g in random.uniform(-1, 1, (2, 5)):
                    s = p.solve(solver=solver)
                    self.assertEqual((s.status, s.mu.any()), ("solved", False))
                    near(p.H @ s.z, -p.g, atol=1e-12)
        self.both(test)

    def test_what_is_not_finite_is_never_solved(self):
        def test(exact):
            random = np.random.default_rng(1)
            p = cart_program(random, 5, 30)
            fill(random, p)
            solver = p.solver(exact, 10000)
            for name, wrong in {"g": (NAN, INF, -INF), "lower": (NAN, INF), "upper": (NAN, -INF),
                                "soft": (NAN, -1.0)}.items():
                values = getattr(p, name)
                for value in wrong:
                    for i in range(len(values)):
                        p.solve(solver=solver)  # warm
                        kept, values[i] = values[i], value
                        s = p.solve(solver=solver)
                        values[i] = kept
                        self.assertEqual((s.status, s.kkt_residual), ("not_finite", INF))
                        self.assertFalse(s.z.any())
            self.assertNotEqual(p.solve(solver=solver).status, "not_finite")
        self.both(test)

    def test_programs_of_the_carts_sizes_are_solved(self):
        """Cold and along a slowly changing sequence. A solution is found again at once."""
        random = np.random.default_rng(101)
        some = count(20_000) // 150
        for n, m, models in ((5, 30, some), (3, 26, some), (3, 106, some), (114, 228, some // 33 + 1)):
            changes = 0
            for _ in range(models):
                p = cart_program(random, n, m)
                solver = p.solver()
                for i in range(50):
                    if i % 8 == 0:
                        fill(random, p)
                    else:
                        p.g += 0.1 * np.abs(p.g).max() * random.uniform(-1, 1, n)
                    s = p.solve(solver=solver)
                    self.assertEqual(s.status, "solved")
                    self.assertLessEqual(p.error(s), 1e-8)
                    changes += s.iterations
                    self.assertEqual(p.solve(solver=solver).iterations, 0)
            self.assertGreater(changes, models * 50 / 4)

    def test_cvxopt_agrees(self):
        """Interior-point solutions are less accurate, and need an interior."""
        cvxopt.solvers.options.update(show_progress=False, abstol=1e-11, reltol=1e-11,
                                      feastol=1e-11, maxiters=100)
        random = np.random.default_rng(11)
        for k in range(1000):
            sizes = (114, 228) if k % 100 == 99 else ((5, 30), (3, 26), (3, 106))[k % 3]
            p = cart_program(random, *sizes)
            fill(random, p)
            p.upper += np.where(p.upper - p.lower < 1e-3, 1e-3, 0)
            above, below = np.isfinite(p.upper), np.isfinite(p.lower)
            rows = np.vstack([p.Omega[above], -p.Omega[below]])
            theirs = cvxopt.solvers.qp(*(cvxopt.matrix(x) for x in (
                p.H, p.g, rows, np.concatenate([p.upper[above], -p.lower[below]]))))
            x, s = np.array(theirs["x"]).ravel(), p.solve()
            self.assertEqual(s.status, "solved")
            self.assertLess(np.linalg.norm(s.z - x), 1e-5 * (1 + np.linalg.norm(x)))
            ours, its = (0.5 * z @ p.H @ z + p.g @ z for z in (s.z, x))
            self.assertAlmostEqual(ours, its, delta=1e-6 * (1 + abs(its)))

    def test_rounding_does_not_exhaust_the_iterations(self):
        """Two equations contradict each other by less than the rounding error of their sums."""
        bound = 1e12 / 3 + np.array([0, 1e-4])
        p = Program(EYE, [[0.3, 0.7], [0.3, 0.7]], [0, 0], bound, bound)
        s = p.solve()
        self.assertEqual(s.status, "solved")
        self.assertLess(s.kkt_residual, 1e-14)
        self.assertLess(np.abs(p.Omega @ s.z - bound).max(), 1e-3)

    def test_a_result_is_optimal_or_says_that_it_is_not(self):
        def test(exact):
            random = np.random.default_rng(11)
            found = dict.fromkeys(STATUSES, 0)
            for k in range(count(2000)):
                p = any_program(random)
                s = p.solve(exact)
                found[s.status] += 1
                is_valid = np.isfinite(p.g).all() and (
                    (p.lower < INF) & (p.upper > -INF) & (p.soft >= 0) & (p.soft < INF)).all()
                self.assertEqual(s.status == "not_finite", not is_valid, k)
                self.assertTrue(np.isfinite(s.z).all() and np.isfinite(s.mu).all(), k)
                if s.status == "infeasible" and not (p.lower > p.upper).any():
                    self.assertLessEqual(p.certificate_error(s.mu), 1e-5, k)
                if s.status in ("infeasible", "not_finite"):
                    continue
                # The residual that is reported is the error, whatever the status.
                error = p.error(s)
                scale = max(np.abs(M).sum(axis=1).max() for M in (p.H, p.Omega))
                rounding = 1e-12 * (1 + np.abs(s.z).max() * scale)
                self.assertAlmostEqual(s.kkt_residual, error, delta=rounding + 1e-9 * error, msg=k)
                if s.status == "solved" and exact:
                    self.assertLessEqual(error, 1.01e-8 + rounding, k)
            print("active_set" if exact else "hildreth", found)
            # Hildreth's method seldom ends within the sweeps on these conditions.
            self.assertGreater(found["solved"], count(2000) / (4 if exact else 20))
            self.assertGreater(found["not_finite"], count(2000) / 20)
        self.both(test)

    def test_hard_programs_are_solved_or_proven_infeasible(self):
        """None with a solution may be called infeasible, at most 0.3 % be unsolved, and 1.5 % have
        an error above 1e-9. No other one may be solved, and all but 1 in 1e4 must have a
        certificate: rounding hides a few. With the last row softened they are solved."""
        random = np.random.default_rng(301)
        unsolved = {"feasible": 0, "softened": 0}
        refined = {"feasible": 0, "softened": 0}
        unproven = 0

        def expect_solved(p, kind):
            s = p.solve()
            self.assertNotIn(s.status, ("infeasible", "not_finite"))
            unsolved[kind] += s.status != "solved"
            if s.status == "solved":
                self.assertLessEqual(p.error(s), 1e-8)
                refined[kind] += p.error(s) <= 1e-9

        for _ in range(count(4000)):
            expect_solved(hard_program(random), "feasible")
            p = infeasible_program(random)
            s = p.solve()
            self.assertNotEqual(s.status, "solved")
            unproven += s.status != "infeasible"
            if s.status == "infeasible":
                self.assertLessEqual(p.certificate_error(s.mu), 1e-5)
            p.soft[-1] = 0.1
            expect_solved(p, "softened")
        print(unsolved, refined, f"{unproven} without a certificate")
        self.assertLessEqual(max(unsolved.values()), 0.003 * count(4000))
        self.assertGreaterEqual(min(refined.values()), 0.985 * count(4000))
        self.assertLessEqual(unproven, 1e-4 * count(4000))

    def test_a_known_solution_is_found_in_any_units(self):
        def test(exact):
            random = np.random.default_rng(12)
            wrong = dict.fromkeys(FAMILIES, 0)
            for k in range(count(3400)):
                family = FAMILIES[k % len(FAMILIES)]
                p = in_other_units(random, known_program(random, family))
                s = p.solve(exact)
                wrong[family] += s.status != ("infeasible" if p.z is None else "solved")
                if s.status != "solved":
                    continue
                self.assertIsNotNone(p.z, family)
                # In the cost's own metric, relative to the solution or, near 0, to the gradient.
                least = 1e-9 * np.abs(p.g / np.sqrt(np.diag(p.H))).max()
                off, length = (np.sqrt(max(0, x @ p.H @ x)) for x in (s.z - p.z, p.z))
                self.assertLessEqual(off, 1e-4 * max(length, least), f"{k} {family}")
            print("active_set" if exact else "hildreth", "without the right status:", wrong)
            if exact:
                self.assertLessEqual(max(wrong.values()), 1e-3 * count(3400))
        self.both(test)


SLOW = [[1, 0.05], [-1, 0.05]]  # two rows that nearly contradict each other


class Hildreth(unittest.TestCase):
    def test_a_capped_answer_says_so_and_violates_rows(self):
        p = Program(EYE, SLOW, [-1, -1], upper=[-1, 0.9])
        s = p.solve(False, 3)
        self.assertEqual((s.status, s.iterations), ("iteration_cap", 3))
        self.assertGreater((p.Omega @ s.z - p.upper).max(), 1e-3)
        self.assertGreater(s.kkt_residual, 1e-3)
        self.assertLess(p.solve().kkt_residual, 1e-12)

    def test_it_starts_cold_after_an_infeasible_program(self):
        """Its multipliers grow without bound: the next solve must not start with them."""
        p = Program(EYE, [[1, 0], [-1, 0]], [-1, 0], upper=[0.5, 0.6])
        cold, solver = p.solve(False, 40), p.solver(False, 40)
        s = Program(EYE, p.Omega, p.g, upper=-10).solve(solver=solver)
        self.assertNotEqual(s.status, "solved")
        self.assertGreater(np.abs(s.mu).max(), 100)
        s = p.solve(solver=solver)
        self.assertEqual((s.status, s.iterations), ("solved", cold.iterations))
        np.testing.assert_array_equal(s.z, cold.z)

    def test_it_goes_on_after_a_capped_cold_start(self):
        p = Program(EYE, SLOW, [-1, -1], upper=[-0.5, 0.51])
        for cap in (1, 3, 40):
            solver = p.solver(False, cap)
            self.assertEqual(p.solve(solver=solver).status, "iteration_cap")
            for solves in range(2, 6):
                near(p.solve(solver=solver).z, p.solve(False, solves * cap).z, atol=1e-9)

    def test_it_goes_on_where_multipliers_grow_together(self):
        """Nearly opposite rows: both multipliers grow together, from small values."""
        for second in (0.1, 0.05, 0.005):  # violation at z_free = (1, 1)
            p = Program(EYE, SLOW, [-1, -1], upper=[1.05 - max(second, 0.01), -0.95 - second])
            for cap in (10, 40, 60):
                solver = p.solver(False, cap)
                self.assertIn("solved", (p.solve(solver=solver).status for _ in range(2000)))

    def test_multipliers_stay_small_after_infeasible_programs(self):
        """For any number of sweeps and any previous multipliers."""
        random = np.random.default_rng(1)
        for k in range(12):
            p = cart_program(random, *((5, 30), (3, 26), (3, 106))[k % 3])
            fill(random, p)
            rows = random.integers(len(p.Omega) - 1, size=3)
            p.upper[rows] = np.where(np.isinf(p.upper[rows]), 200, p.upper[rows])  # never active
            weights = random.uniform(0.1, 1, 3)
            p.Omega[-1], p.lower[-1], p.upper[-1] = weights @ p.Omega[rows], -INF, INF
            least = weights @ p.upper[rows] + 10
            contradiction = Program(p.H, p.Omega, p.g, np.append(p.lower[:-1], least),
                                    np.append(p.upper[:-1], least + 1))
            for cap in (1, 5, 40):
                solver = p.solver(False, cap)
                before = np.abs(p.solve(solver=solver).mu).max()
                solves = [contradiction.solve(solver=solver) for _ in range(12000 // cap)]
                self.assertNotIn("solved", [s.status for s in solves])
                largest = [np.abs(s.mu).max() for s in solves]
                soon = max(largest[:4000 // cap])
                self.assertLessEqual(max(largest[4000 // cap:]), 1.5 * max(before, soon))

    def test_it_is_the_textbooks_algorithm(self):
        """With every residual anew, from a cold start, and one-sided rows."""
        random = np.random.default_rng(1)
        capped = 0
        for k in range(50):
            p = cart_program(random, *((5, 30), (3, 26), (3, 106))[k % 3])
            fill(random, p)
            s = p.solve(False, 7)
            if s.status != "iteration_cap":
                continue
            capped += 1
            sides = np.stack([p.Omega, -p.Omega], axis=1).reshape(-1, len(p.H))
            inverse = np.linalg.inv(p.H)
            P = sides @ inverse @ sides.T
            d = np.stack([p.upper, -p.lower], axis=1).ravel() + sides @ inverse @ p.g
            mu = np.zeros(len(d))
            for i in 7 * list(range(len(d))):
                mu[i] = max(0, -(P[i] @ mu - P[i, i] * mu[i] + d[i]) / P[i, i])
            z = -inverse @ (p.g + sides.T @ mu)
            self.assertLess(np.linalg.norm(s.z - z), 1e-9 * (1 + np.linalg.norm(z)))
        self.assertGreater(capped, 20)


def radius(M):
    return np.abs(np.linalg.eigvals(M)).max()


class Riccati(unittest.TestCase):
    def test_scipy_agrees_in_any_units(self):
        """SciPy solves plants in one unit: it is exact only relative to the largest entry. Its
        own error grows with the condition."""
        random = np.random.default_rng(3)
        for k in range(count(500)):
            n, m = 1 + k % 6, 1 + k % 2
            root = random.uniform(-1, 1, (n, n if k % 3 == 0 else 1 + k % n))
            A, B = 1.5 * random.uniform(-1, 1, (n, n)), random.uniform(-1, 1, (n, m))
            Q, R = root @ root.T, random.uniform(0.01, 10) * np.eye(m)
            P = scipy.linalg.solve_discrete_are(A, B, Q, R)
            K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
            x, u, cost = (powers_of_two(random, size) for size in (n, m, 1))
            mixed = bw.dare((A * x).T.T / x[:, None], B * u / x[:, None], cost * Q * x * x[:, None],
                            cost * R * u * u[:, None])
            scale = np.sqrt(np.diag(P))
            tolerance = 1e-13 * np.linalg.cond(P / scale / scale[:, None], "fro") + 1e-9
            for ours in (bw.dare(A, B, Q, R),
                         bw.Regulator((mixed.K / x) * u[:, None], mixed.S / x / x[:, None] / cost)):
                self.assertLess(radius(A - B @ ours.K), 1 - 1e-9)
                error = np.linalg.norm(ours.K - K) / (1 + np.linalg.norm(K))
                self.assertLess(error, tolerance)
                self.assertLess(np.linalg.norm(ours.S - P), tolerance * np.linalg.norm(P))
                S = ours.S
                residual = A.T @ S @ (A - B @ np.linalg.solve(R + B.T @ S @ B, B.T @ S @ A)) + Q - S
                size = np.linalg.norm(S)
                self.assertLess(np.linalg.norm(residual), 1e-10 * size)
                self.assertLess(np.linalg.norm(S - S.T), 1e-12 * size)
        Q, R = np.diag([1.0, 2, 3, 4]), np.array([[2.0, 0.5], [0.5, 1.0]])
        A, B = random.normal(size=(4, 4)), random.normal(size=(4, 2))
        K, S = bw.lqr(A, B, Q, R)
        np.testing.assert_allclose(S, scipy.linalg.solve_discrete_are(A, B, Q, R), rtol=1e-9)
        np.testing.assert_allclose(K, np.linalg.solve(R + B.T @ S @ B, B.T @ S @ A), rtol=1e-9)

    def test_closed_forms(self):
        for q in (1e-3, 1, 50):  # a = 1: P = (q + sqrt(q^2 + 4 q r))/2
            np.testing.assert_allclose(bw.dare(1, 1, q, 2).S, 0.5 * (q + np.sqrt(q * q + 8 * q)),
                                       rtol=1e-12)
        self.assertEqual(bw.dare(0.5, 1, 0, 1).S, 0)
        # Without a weight P = (a^2 - 1) r stabilises, though P = 0 is cheaper: the pole is mirrored
        # at the unit circle.
        for a in (1.01, 2, -30):
            K, P = bw.dare(a, 1, 0, 0.5)
            np.testing.assert_allclose([P[0, 0], a - K[0, 0]], [0.5 * (a * a - 1), 1 / a], 1e-10)
        random = np.random.default_rng(4)
        for k in range(50):  # one unstable state has no weight
            n = 2 + k % 4
            A = random.uniform(-1, 1, (n, n))
            A[:, 0] = 1.5 * np.eye(n)[0]
            B = random.uniform(0, 2, (n, 1))
            Q = np.diag([0.0] + [1.0] * (n - 1))
            self.assertLess(radius(A - B @ bw.dare(A, B, Q, 1).K), 1)
        # Parts with unlike costs do not disturb each other: P^2 + (1 - a^2 - q) P - q = 0.
        both = bw.dare(np.diag([0.5, 0.999]), EYE, np.diag([1e12, 1e-3]), EYE)
        for i, (a, q) in enumerate(((0.5, 1e12), (0.999, 1e-3))):
            b = 1 - a * a - q
            P = 0.5 * (np.sqrt(b * b + 4 * q) - b)
            np.testing.assert_allclose([both.S[i, i], both.K[i, i]], [P, a * P / (1 + P)], 1e-10)

    def test_it_predicts_the_cost(self):
        A, B, _ = bw.zero_order_hold(*bw.damped_inertia(0.625, 0.78), 0.01)
        K, P = bw.dare(A, B, EYE, 1)
        x, cost = first, _ = np.array([0.1, 0.1]), 0.0
        for _ in range(5000):
            u = -K @ x
            cost += x @ x + u @ u
            x = A @ x + B @ u
        self.assertAlmostEqual(cost / (first @ P @ first), 1, delta=1e-10)

    def test_refusals_name_the_mode_without_a_solution(self):
        turn = [[0.6, -0.8], [0.8, 0.6]]
        seen, moved = "Q has {} effect on the mode with the eigenvalue {} of A", \
            "the input has no effect on the mode with the eigenvalue 2 of A"
        for A, B, Q, line in (
            (np.diag([0.5, 1]), [[1], [1]], np.diag([1, 0]), seen.format("no", 1)),
            (turn, [[1], [0]], 0 * EYE, seen.format("no", "0.6 ± 0.8i")),
            (2 * EYE, [[1], [1]], EYE, moved),
            (2 * EYE, [[0], [0]], EYE, moved),
            (1, 1, 1e-19, seen.format("too little", 1)),
        ):
            with self.assertRaises(bw.InputError) as refusal:
                bw.dare(A, B, Q, 1)
            self.assertEqual(str(refusal.exception),
                             f"Riccati: there is no stabilising solution: {line}")
        self.assertRaisesRegex(bw.InputError, "the solution is too large", bw.dare, 2, 1e-154, 1, 1)
        singular = np.full((2, 2), 5.6953125)  # although rounding gives it a Cholesky factor
        for wrong in ((1, 1, 1, -1), (1, 1, 1, 0), (1, 1, -1, 1), (EYE, 1, EYE, 1), (2, 0, 1, 1),
                      (EYE, EYE, np.diag([1e12, -1e-3]), EYE), (1, 1, 0, 1), (1, 0, 1, 1),
                      (np.diag([1, 2]), EYE, np.diag([0, 1]), EYE), (EYE, EYE, EYE, singular),
                      (EYE, EYE, [[1, 0.5], [0, 1]], EYE)):
            self.assertRaises(bw.InputError, bw.dare, *wrong)
        for wrong in np.where(np.eye(4), NAN, 1).reshape(4, 4, 1, 1):
            self.assertRaises(bw.InputError, _core.dare, *wrong)


class Plants(unittest.TestCase):
    def test_a_sampled_plant_is_that_of_scipy(self):
        random = np.random.default_rng(3)
        A, B, C = np.array([[0, 1], [0, 0]]), np.array([[0], [1 / 0.8]]), np.array([[1, 0]])
        T = 1e-3
        sampled = bw.zero_order_hold(A, B, C, T)
        np.testing.assert_allclose(sampled.A, [[1, T], [0, 1]], rtol=1e-15)
        np.testing.assert_allclose(sampled.B, [[T * T / 1.6], [T / 0.8]], rtol=1e-14)
        for _ in range(20):
            A, B, C = (random.normal(size=size) for size in ((4, 4), (4, 2), (2, 4)))
            theirs = scipy.signal.cont2discrete((A, B, C, np.zeros((2, 2))), 0.3)
            for ours, its in zip(bw.zero_order_hold(A, B, C, 0.3), theirs):
                np.testing.assert_allclose(ours, its, rtol=1e-10, atol=1e-12)
            whole, half = (bw.zero_order_hold(A, B, C, period_s) for period_s in (0.3, 0.15))
            near(half.A @ half.A, whole.A, atol=1e-13)
            near(half.A @ half.B + half.B, whole.B, atol=1e-13)
        for period in (0.0, NAN):
            self.assertRaises(bw.InputError, bw.zero_order_hold, EYE, [[0], [1]], [[1, 0]], period)
        self.assertRaises(bw.InputError, bw.zero_order_hold, EYE, np.eye(3), [[1, 0]], 0.1)
        for wrong in range(3):
            plant = [np.array(M, float) for M in (EYE, [[0], [1]], [[1, 0]])]
            plant[wrong][0, 0] = INF
            with self.assertRaisesRegex(bw.InputError, "state space: A, B and C must be finite"):
                _core.zero_order_hold(*plant, 0.1)

    def test_the_rank_of_observability(self):
        # Eq. 2.14: the extended motor is observable unless the input has no effect.
        for effect, rank in ((-2.0, 3), (0.0, 2)):
            A = [[0, 1, 0], [0, -0.3, effect], [0, 0, 0]]
            self.assertEqual(bw.observability_rank(A, [[1, 0, 0]]), rank)
        # Two separate oscillators. Velocity alone does not determine a position.
        A = scipy.linalg.block_diag([[0, 1], [-4, 0]], [[0, 1], [-9, 0]])
        for C, rank in (([1, 0, 0, 0], 2), ([1, 0, 1, 0], 4), ([0, 0, 0, 0], 0)):
            self.assertEqual(bw.observability_rank(A, [C]), rank)
        self.assertEqual(bw.observability_rank([[0, 1], [0, 0]], [[0, 1]]), 1)
        # It depends neither on the period nor on the unit of the disturbance.
        for T in (1e-1, 1e-3, 1e-5):
            for J in (1e-6, 1.0, 1e6):
                A = [[0, 1, 0], [0, 0, -1 / J], [0, 0, 0]]
                A, _, C = bw.zero_order_hold(A, np.zeros((3, 1)), [[1, 0, 0]], T)
                self.assertEqual(bw.observability_rank(A, C), 3)

    def expect_poles(self, F, poles):
        ours, given = (sorted(values, key=lambda z: (np.round(np.real(z), 6), np.imag(z)))
                       for values in (np.linalg.eigvals(F), poles))
        np.testing.assert_allclose(ours, given, atol=1e-6)

    def test_poles_are_where_they_were_asked_for(self):
        random = np.random.default_rng(1)
        groups = [[-2, -3 + 1.5j, -3 - 1.5j], [-2.5, -3.5, -5]]
        for _ in range(50):
            A, B, C = (random.uniform(-1, 1, size) for size in ((6, 6), (6, 2), (2, 6)))
            self.expect_poles(A - bw.place_observer_poles(A, C, groups) @ C, sum(groups, []))
            self.expect_poles(A - B @ bw.place_poles(A, B, groups), sum(groups, []))
        # Two double integrators: each output corrects its own chain only.
        A, C = np.zeros((4, 4)), np.eye(2, 4)
        A[0, 2], A[1, 3] = 1, 5
        near(bw.place_observer_poles(A, C, [[-1, -2], [-3, -4]]),
             [[3, 0], [0, 7], [2, 0], [0, 12 / 5]], atol=1e-14)
        # A pole of one group may be an eigenvalue of its own chain, of another one, or of both.
        # Here s^2 + (3 + h1) s + (3 h1 + h2) = (s + 3)(s + 5).
        A, C = np.array([[0, 1], [0, -3]]), np.array([[1, 0]])
        near(bw.place_observer_poles(A, C, [-3, -5]), [[5], [0]], atol=1e-14)
        near(bw.place_poles(A, [[0], [1]], [-3, -5]), [[15, 5]], atol=1e-13)
        both = bw.place_observer_poles(*(scipy.linalg.block_diag(M, M) for M in (A, C)),
                                       [[-3, -5], [-1, -2]])
        near(both, [[5, 0], [0, 0], [0, 0], [0, 2]], atol=1e-12)

    def test_impossible_poles_are_refused(self):
        A, C = np.array([[0, 1], [0, 0]]), np.array([[1, 0]])
        for poles in ([[-1]], [[-1], [-2]], [[-1 + 1j, -2]], [[NAN, -2]]):
            self.assertRaises(bw.InputError, _core.place_observer_poles, A, C, poles)
        infinite = [[complex(-1, INF), complex(-1, -INF)]]
        self.assertRaisesRegex(bw.InputError, "^pole placement: a pole is not finite$",
                               _core.place_observer_poles, A, C, infinite)
        self.assertRaises(bw.InputError, bw.place_observer_poles, A, [[0, 1]], [-1, -2])
        self.assertRaises(bw.InputError, bw.place_observer_poles, 1, 1e-309, [-1])  # it overflows

    def test_ackermanns_formula_with_60_digits_agrees(self):
        """Poles of the plant, deadbeat poles of a singular plant, poles 1e-7 apart and units of
        1e-8 to 1e8."""
        random = np.random.default_rng(5)
        with mpmath.workdps(60):
            for k in range(count(300)):
                n, kind = 1 + k % 6, k // 6 % 5
                A, C = random.uniform(-1, 1, (n, n)), random.uniform(-1, 1, (1, n))
                unit, close = np.ones(n), random.uniform(-1, 1)
                poles = random.uniform(-1, 1, n).astype(complex)
                if kind == 1:
                    A[:, 0], poles = 0, 0 * poles
                if kind == 2:
                    A = np.triu(A)
                    poles = np.diag(A).astype(complex)
                if kind == 3:
                    poles = close + 1e-7 * np.arange(n) + 0j
                if kind == 4 and n > 1:
                    poles[:2] = close + 0.5j, close - 0.5j
                if random.random() < 0.5:
                    time, unit = powers_of_two(random, 1), powers_of_two(random, n)
                    A, C, poles = time * A * unit[:, None] / unit, C / unit, time * poles
                    unit = time * unit
                rows = [mpmath.matrix(C)]
                for _ in range(n - 1):
                    rows.append(rows[-1] * mpmath.matrix(A))
                h = mpmath.inverse(mpmath.matrix([list(row) for row in rows]))[:, n - 1]
                for pole in poles:
                    h = mpmath.matrix(A) * h - mpmath.mpc(pole) * h
                exact = np.array([float(mpmath.re(value)) for value in h])
                off = (bw.place_observer_poles(A, C, [poles])[:, 0] - exact) / unit
                size = np.linalg.norm(exact / unit)
                self.assertLessEqual(np.linalg.norm(off), 1e-8 * size + 1e-12)


if __name__ == "__main__":
    unittest.main()
