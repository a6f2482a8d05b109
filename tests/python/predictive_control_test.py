"""Linear predictive control beside the regulator, its optimality conditions and its bounds."""

import unittest

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

import breakwater as bw
import methods
from linear_test import Program
from methods import CancelAt, DisturbanceUse, Lmpc, LmpcDesign, OnInfeasible, PredictedBound, QpSolverKind
from support import near

INF, NOTHING, WEIGHTS = np.inf, [0.0], np.diag([10.0, 1])


def regulator(A, B, Q, R):
    P = solve_discrete_are(A, B, Q, R)
    return np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A), P


def bound(lower, upper, steps, component=0):
    return [PredictedBound(component=component, lower=lower, upper=upper, steps=steps)]


def design_of(prediction_steps, control_steps, **fields):
    """A cart of 0.625 kg at 50 ms."""
    cart = bw.zero_order_hold(*bw.damped_inertia(0.625, 0.78), 0.05)
    return LmpcDesign(**{"A": cart.A, "B": cart.B, "prediction_steps": prediction_steps, "control_steps": control_steps,
                         "Q": WEIGHTS, "Q_last": WEIGHTS, "R": [[0.1]], "max_iterations": 60, "softness": 1e-6} | fields)


def impossible_design(**fields):
    """From 1 m/s an input of 1 N cannot reach 0.5 m/s, or a position below 0, at the next step."""
    return design_of(10, 10, input_bounds=bound(-1, 1, range(10)),
                     state_bounds=bound(-0.5, 0.5, range(1, 11), 1) + bound(-9, 0, range(1, 11)), **fields)


class LinearPredictiveControl(unittest.TestCase):
    def test_with_the_riccati_penalty_it_equals_the_regulator(self):
        random = np.random.default_rng(1)
        for horizon in (1, 2, 5, 20, 114):
            design = design_of(horizon, horizon, R=[[0]], S=[[0.3]])
            K, design.Q_last = regulator(design.A, design.B, WEIGHTS, design.S)
            lmpc = Lmpc(design)
            for _ in range(5):
                x, last = random.uniform(-1, 1, 2), random.uniform(-1, 1, 1)
                near(last + lmpc.optimise(x, last, np.zeros(2 * horizon), NOTHING), -K @ x, atol=1e-9)

    def test_a_long_horizon_in_changes_equals_the_regulator_of_the_extended_plant(self):
        """The thesis' form weights the change of the input. With the last input as a state it is a regulator too, but
        with the Riccati solution of this extended plant."""
        design = design_of(400, 400)
        A = np.block([[design.A, design.B], [np.zeros((1, 2)), np.eye(1)]])
        K, _ = regulator(A, np.vstack([design.B, [[1]]]), block_diag(WEIGHTS, 0), design.R)
        state = np.array([0.4, -0.2, 0.7])
        near(Lmpc(design).optimise(state[:2], state[2:], np.zeros(800), NOTHING), -K @ state, atol=1e-9)

    def test_it_minimises_the_cost_along_a_trajectory(self):
        random, design = np.random.default_rng(1), design_of(20, 5, Q_last=3 * WEIGHTS)
        start, last, reference = random.uniform(-1, 1, 2), random.uniform(-1, 1), random.uniform(-1, 1, (20, 2))

        def cost(changes):
            x, u, total = start, last, 0.1 * changes @ changes
            for i in range(20):
                u += changes[i] if i < 5 else 0
                x = design.A @ x + design.B[:, 0] * u
                error = reference[i] - x
                total += error @ (WEIGHTS if i < 19 else design.Q_last) @ error
            return total

        lmpc = Lmpc(design)
        lmpc.optimise(start, [last], reference.ravel(), NOTHING)
        best = lmpc.solution().z
        for step in 1e-3 * np.eye(5):
            more, less = cost(best + step), cost(best - step)
            self.assertGreater(min(more, less), cost(best))
            near(more - less, 0, atol=1e-9)  # the gradient is 0

    def test_it_is_optimal_at_every_step_of_a_run(self):
        design = design_of(40, 40, change_bounds=bound(-0.5, 0.5, range(40)), input_bounds=bound(-2, 2, range(40)),
                           state_bounds=bound(-0.6, 0.6, range(1, 41), 1))
        lmpc, x, u, at_a_bound = Lmpc(design), np.array([-2.0, 0]), np.zeros(1), 0
        for _ in range(200):
            u = u + lmpc.optimise(x, u, np.zeros(80), NOTHING)
            self.assertEqual(lmpc.solution().status.name, "solved")
            self.assertLessEqual(Program(*lmpc.program()).error(lmpc.solution()), 1e-8)
            x = design.A @ x + design.B @ u
            self.assertTrue(abs(u[0]) <= 2 + 1e-8 and abs(x[1]) <= 0.6 + 1e-8)
            at_a_bound += int(abs(u[0]) > 1.999) + int(abs(x[1]) > 0.599)
        self.assertGreater(at_a_bound, 10)
        self.assertLess(np.linalg.norm(x), 1e-3)
        self.assertEqual(lmpc.statistics().unsolved, 0)

    def test_a_reserved_input_moves_the_bounds(self):
        lmpc = Lmpc(design_of(10, 3, input_bounds=bound(-1, 1, range(3))))
        for reserved, expected in ((0, 1), (0.75, 0.25)):
            near(lmpc.optimise([0, 0], NOTHING, np.full(20, 50), [reserved]), expected, atol=1e-9)

    def test_it_softens_state_bounds_in_their_order_but_never_inputs(self):
        lmpc = Lmpc(impossible_design())
        # As hard as the input may brake.
        near(lmpc.optimise([-5, 1], NOTHING, np.zeros(20), NOTHING), -1, atol=1e-6)
        self.assertEqual(lmpc.solution().status.name, "solved")
        said = lmpc.statistics()
        self.assertEqual((said.unsolved, said.softened, said.optimisations), (1, 1, 1))
        self.assertEqual(lmpc.softened_bounds(), 1)  # the velocity's bounds sufficed
        self.assertEqual((said.iterations, said.most_iterations), (lmpc.iterations(),) * 2)  # both solves count
        soft = lmpc.program()[-1]
        self.assertTrue((soft[10:20] > 0).all() and (soft[-10:] == 0).all())
        lmpc.optimise([0.1, 1], NOTHING, np.zeros(20), NOTHING)
        self.assertEqual(lmpc.statistics().softened, 2)
        soft = lmpc.program()[-1]
        self.assertTrue((soft[-10:] > 0).all() and (soft[:10] == 0).all())  # here both had to, inputs never
        self.assertLessEqual(abs(np.cumsum(lmpc.solution().z)).max(), 1 + 1e-8)
        lmpc.optimise([-5, 0.1], NOTHING, np.zeros(20), NOTHING)  # possible again, and hard again
        self.assertEqual((lmpc.statistics().softened, lmpc.softened_bounds(), lmpc.statistics().capped), (2, 0, 0))

    def test_it_relaxes_input_changes_last(self):
        """The reserved input has moved further than the input may change in a step."""
        design = design_of(10, 3, change_bounds=bound(-0.1, 0.1, range(3)), input_bounds=bound(-1, 1, range(3)),
                           state_bounds=bound(-5, 5, range(1, 11), 1))
        lmpc, arguments = Lmpc(design), ([0, 0], NOTHING, np.full(20, 50), [1.5])
        near(lmpc.optimise(*arguments), -0.5, atol=1e-9)  # no further than the input's bound asks for
        self.assertEqual((lmpc.softened_bounds(), lmpc.statistics().softened), (2, 1))
        self.assertEqual(lmpc.solution().status.name, "solved")
        design.on_infeasible = OnInfeasible.stop
        self.assertRaises(methods.ControlFailure, Lmpc(design).optimise, *arguments)

    def test_at_the_iteration_limit_the_input_stays_within_its_bounds(self):
        """A penalty beyond double precision: the solver stops with an approximate solution."""
        design = impossible_design(change_bounds=bound(-0.7, 0.7, range(10)), softness=1e-8)
        lmpc, random, u = Lmpc(design), np.random.default_rng(1), np.zeros(1)
        for _ in range(2000):
            change = lmpc.optimise(random.uniform(-5, 5, 2), u, np.zeros(20), NOTHING)
            if lmpc.solution().status.name != "solved":
                self.assertTrue(abs(change[0]) <= 0.7 and abs(u[0] + change[0]) <= 1 + 1e-15)
            u = u + change
        self.assertGreater(lmpc.statistics().capped, 10)
        self.assertGreaterEqual(lmpc.statistics().unsolved, lmpc.statistics().capped)

    def test_nan_is_a_failure(self):
        for solver in (QpSolverKind.active_set, QpSolverKind.hildreth):
            lmpc = Lmpc(impossible_design(solver=solver))
            self.assertRaises(methods.ControlFailure, lmpc.optimise, [np.nan, 0], NOTHING, np.zeros(20), NOTHING)

    def test_it_refuses_nonsense(self):
        for fields in (
            {"prediction_steps": 0}, {"control_steps": 0}, {"control_steps": 11}, {"R": [[-1]]}, {"R": [[np.nan]]},
            {"Q": -WEIGHTS}, {"Q_last": np.eye(3)}, {"Q": 0 * WEIGHTS, "Q_last": 0 * WEIGHTS, "R": [[0]]},
            {"input_bounds": bound(1, -1, [0])}, {"input_bounds": bound(np.nan, 1, [0])},
            {"input_bounds": bound(-1, 1, [0], 1)}, {"input_bounds": bound(-1, 1, [3])},
            {"state_bounds": bound(-1, 1, [0])}, {"state_bounds": bound(-1, 1, [1], 2)}, {"max_iterations": 0},
            {"softness": 0}):
            self.assertRaises(ValueError, Lmpc, design_of(**{"prediction_steps": 10, "control_steps": 3} | fields))

    def test_the_prediction_equals_stepping_the_plant(self):
        random = np.random.default_rng(1)
        for k in range(30):
            n, m, N_p = 1 + k % 4, 1 + k % 2, 1 + k % 12
            N_u = 1 + k * 7 % N_p
            A, B, x, u = (random.uniform(-1, 1, size) for size in ((n, n), (n, m), n, m))
            changes = random.uniform(-1, 1, (N_u, m))
            Psi, Gamma, Theta = methods.predict(A, B, N_p, N_u)
            for i, predicted in enumerate((Psi @ x + Gamma @ u + Theta @ changes.ravel()).reshape(N_p, n)):
                u = u + changes[i] if i < N_u else u
                x = A @ x + B @ u
                self.assertLess(np.linalg.norm(predicted - x), 1e-10 * (1 + np.linalg.norm(x)))
        for rows, N_p, N_u in ((1, 0, 1), (1, 1, 0), (1, 2, 3), (2, 2, 2)):
            self.assertRaises(ValueError, methods.predict, np.ones((rows, 1)), np.eye(1), N_p, N_u)
        methods.predict(np.eye(1), np.eye(1), 2, 2)


class ContactProblem(unittest.TestCase):
    def test_without_bounds_it_is_the_regulator(self):
        design = methods.ContactMpcDesign(q_velocity=50)
        problem = methods.contact_problem(design, 2)
        problem.input_bounds, problem.state_bounds = [], []
        K, _ = regulator(problem.A, problem.B, problem.Q, np.array([[design.r]]))
        target, lmpc = np.array([0.002, 0]), Lmpc(problem)
        for x in ([-0.09, 0], [0.001, -0.2]):
            expected = -K @ (x - target)
            change = lmpc.optimise(x, [3], np.tile(target, design.prediction_steps), NOTHING)
            near((3 + change) / expected, 1, atol=1e-6)

    def test_the_predicted_force_stays_below_the_peak(self):
        design = methods.ContactMpcDesign()
        problem = methods.contact_problem(design, 2)
        lmpc, x, u, deepest = Lmpc(problem), np.array([-0.089, 0]), np.zeros(1), -1
        for _ in range(200):
            u = u + lmpc.optimise(x, u, np.tile([0.002, 0], design.prediction_steps), NOTHING)
            self.assertLessEqual(abs(u[0]), design.acceleration_m_s2 + 1e-8)
            x = problem.A @ x + problem.B @ u
            deepest = max(deepest, x[0])
        self.assertLessEqual(1000 * deepest, 4.2 + 1e-3)
        near(1000 * x[0], 2, atol=1e-3)


PERIOD_S, SAMPLES_PER_MOVE, LIMIT, DISTURBANCE = 0.01, 10, 2, 5


def predictive(use, lmpc_fields={}, force_limit=INF, **fields):
    plant = bw.zero_order_hold(*bw.damped_inertia(1, 0.5), PERIOD_S * SAMPLES_PER_MOVE)
    lmpc = design_of(20, 5, A=plant.A, B=plant.B, **lmpc_fields)
    return methods.PredictiveControl(methods.PredictiveControlDesign(
        lmpc=lmpc, disturbance_use=use, samples_per_move=SAMPLES_PER_MOVE,
        loop=methods.AxisLoopDesign(reference=methods.Reference(value=1), force_limit=force_limit), **fields), PERIOD_S)


def largest_command(controller, drive_limit, noise, samples):
    """On the exactly sampled plant, behind a drive with a limit."""
    plant, random = bw.zero_order_hold(*bw.damped_inertia(1, 0.5), PERIOD_S), np.random.default_rng(1)
    x, u, largest = np.zeros(2), np.zeros(1), 0
    controller.reset(np.zeros(3))
    for k in range(samples):
        u = controller.update(k * PERIOD_S, [x[0] + random.uniform(-noise, noise), *x], u)
        largest = max(largest, abs(u[0]))
        x = plant.A @ x + plant.B @ (np.clip(u, -drive_limit, drive_limit) - DISTURBANCE)
    return largest


class Controllers(unittest.TestCase):
    """Inputs that regulators and predictive controllers pass to their estimators and to the drive."""

    def test_the_estimator_gets_the_drives_limits(self):
        """The drive's limit is too small for the disturbance. The estimate must stay bounded."""
        plant = bw.zero_order_hold(*bw.damped_inertia(1, 0.5), PERIOD_S)
        K, _ = regulator(plant.A, plant.B, np.eye(2), np.eye(1))
        for controller in (predictive(DisturbanceUse.cancel, force_limit=LIMIT),
                           methods.LqrControl(PERIOD_S, K[0], False, LIMIT), methods.LqrControl(PERIOD_S, K[0], True, LIMIT)):
            self.assertGreater(largest_command(controller, LIMIT, 0, 300), LIMIT)
            near(controller.disturbance(), DISTURBANCE, atol=1e-3)
            if isinstance(controller, methods.LqrControl):
                signals = controller.signals()
                self.assertEqual(signals[1][0], "position_hat_m")
                self.assertEqual(signals[3][1], list(controller.disturbance()))
        self.assertRaises(ValueError, predictive, DisturbanceUse.cancel, force_limit=0)
        self.assertRaises(ValueError, methods.LqrControl, PERIOD_S, K[0], False, 0)

    def test_it_cancels_at_each_sample_or_at_each_decision(self):
        """Under noise the estimate changes at each sample."""
        def changes(cancel_at):
            controller, random = predictive(DisturbanceUse.cancel, cancel_at=cancel_at), np.random.default_rng(1)
            controller.reset(np.zeros(3))
            u, count = np.zeros(1), 0
            for k in range(10 * SAMPLES_PER_MOVE):
                before, u = u, controller.update(0, [random.uniform(-0.1, 0.1), 0, 0], u)
                count += int(u[0] != before[0])
                self.assertTrue(u[0] != before[0] or k % SAMPLES_PER_MOVE or k == 0, k)
            return count

        self.assertGreater(changes(CancelAt.sample), 9 * SAMPLES_PER_MOVE)
        self.assertLessEqual(changes(CancelAt.decision), 10)

    def test_moved_bounds_hold_between_the_optimisations_too(self):
        """The estimate changes ten times between two optimisations, and strongly under noise."""
        bounds = {"input_bounds": bound(-LIMIT, 1.5 * LIMIT, range(5))}
        within = predictive(DisturbanceUse.cancel_within_bounds, bounds)
        self.assertLessEqual(largest_command(within, INF, 0.02, 500), 1.5 * LIMIT)
        # The noise would break them.
        self.assertGreater(largest_command(predictive(DisturbanceUse.cancel, bounds), INF, 0.02, 500), 3 * LIMIT)


if __name__ == "__main__":
    unittest.main()
