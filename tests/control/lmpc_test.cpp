// Linear predictive control against the regulator, its optimality conditions and its bounds.
#include <Eigen/LU>

#include <breakwater/control/controller.h>
#include <breakwater/control/lmpc.h>
#include <breakwater/control/predictive_control.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/observers/idob.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::lmpc_test {

// Linear predictive control against the regulator, its optimality conditions and its bounds.
const Eigen::MatrixXd kOne = Eigen::MatrixXd::Ones(1, 1);
const Eigen::VectorXd kNothing = Eigen::VectorXd::Zero(1);

StateSpace cart(double period_s) {
  return zero_order_hold(damped_inertia(0.625, 0.78), period_s);
}

std::vector<int> steps(int first, int last) {
  std::vector<int> list(static_cast<std::size_t>(last - first + 1));
  std::iota(list.begin(), list.end(), first);
  return list;
}

LmpcDesign cart_design(int prediction_steps, int control_steps, double period_s = 0.05) {
  const StateSpace plant = cart(period_s);
  LmpcDesign design;
  design.A = plant.A;
  design.B = plant.B;
  design.prediction_steps = prediction_steps;
  design.control_steps = control_steps;
  design.Q = Eigen::Vector2d(10.0, 1.0).asDiagonal();
  design.Q_last = design.Q;
  design.R = 0.1 * kOne;
  design.max_iterations = 60;
  design.softness = 1e-6;
  return design;
}

TEST(Lmpc, WithTheRiccatiPenaltyEqualsTheRegulator) {
  testing::Random random;
  for (const int horizon : {1, 2, 5, 20, 114}) {
    LmpcDesign design = cart_design(horizon, horizon);
    const LqrDesign lqr = dlqr(design.A, design.B, design.Q, 0.3 * kOne);
    design.Q_last = lqr.P;
    design.R = 0.0 * kOne;
    design.S = 0.3 * kOne;
    Lmpc lmpc(design);
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd x = random.vector(2);
      const Eigen::VectorXd last_input = random.vector(1);
      const Eigen::VectorXd reference = Eigen::VectorXd::Zero(2 * horizon);
      const double u = (last_input + lmpc.optimise(x, last_input, reference, kNothing))(0);
      EXPECT_NEAR(u, -(lqr.K * x)(0), 1e-9) << horizon;
    }
  }
}

// The thesis' form weights the change of the input. With the last input as a state it is a
// regulator too, but with the Riccati solution of this extended plant.
TEST(Lmpc, LongHorizonInChangesEqualsTheRegulatorOfTheExtendedPlant) {
  LmpcDesign design = cart_design(400, 400);
  Eigen::MatrixXd A = Eigen::Matrix3d::Identity();
  A.topLeftCorner(2, 2) = design.A;
  A.topRightCorner(2, 1) = design.B;
  Eigen::MatrixXd B(3, 1);
  B << design.B, 1.0;
  Eigen::MatrixXd Q = Eigen::Matrix3d::Zero();
  Q.topLeftCorner(2, 2) = design.Q;
  const LqrDesign lqr = dlqr(A, B, Q, design.R);
  Lmpc lmpc(design);
  const Eigen::Vector3d state(0.4, -0.2, 0.7);
  const double change =
      lmpc.optimise(state.head(2), state.tail(1), Eigen::VectorXd::Zero(800), kNothing)(0);
  EXPECT_NEAR(change, -(lqr.K * state)(0), 1e-9);
}

// The cost summed along the plant. ΔU must minimise it.
double cost(const LmpcDesign& design, Eigen::VectorXd x, double u, const Eigen::VectorXd& reference,
            const Eigen::VectorXd& changes) {
  double sum = 0.0;
  for (int i = 0; i < design.prediction_steps; ++i) {
    if (i < design.control_steps) {
      u += changes(i);
      sum += design.R(0, 0) * changes(i) * changes(i);
    }
    x = design.A * x + design.B * u;
    const Eigen::VectorXd error = reference.segment(2 * i, 2) - x;
    sum += error.dot((i + 1 < design.prediction_steps ? design.Q : design.Q_last) * error);
  }
  return sum;
}

TEST(Lmpc, MinimisesTheCostAlongATrajectory) {
  testing::Random random;
  LmpcDesign design = cart_design(20, 5);
  design.Q_last = 3.0 * design.Q;
  Lmpc lmpc(design);
  const Eigen::VectorXd x = random.vector(2);
  const Eigen::VectorXd last_input = random.vector(1);
  const Eigen::VectorXd reference = random.vector(40);
  lmpc.optimise(x, last_input, reference, kNothing);
  const Eigen::VectorXd best = lmpc.solution().z;
  const double lowest = cost(design, x, last_input(0), reference, best);
  for (Eigen::Index i = 0; i < 5; ++i) {
    const Eigen::VectorXd step = 1e-3 * Eigen::VectorXd::Unit(5, i);
    const double more = cost(design, x, last_input(0), reference, best + step);
    const double less = cost(design, x, last_input(0), reference, best - step);
    EXPECT_GT(more, lowest);
    EXPECT_GT(less, lowest);
    EXPECT_NEAR(more - less, 0.0, 1e-9) << "the gradient is 0";
  }
}

// A run under active input limits satisfies the optimality conditions at every step.
TEST(Lmpc, SatisfiesOptimalityAtEveryStepOfARun) {
  LmpcDesign design = cart_design(40, 40);
  design.change_bounds = {{0, -0.5, 0.5, steps(0, 39)}};
  design.input_bounds = {{0, -2.0, 2.0, steps(0, 39)}};
  design.state_bounds = {{1, -0.6, 0.6, steps(1, 40)}};
  Lmpc lmpc(design);
  Eigen::VectorXd x = Eigen::Vector2d(-2.0, 0.0);
  Eigen::VectorXd u = kNothing;
  int at_limit = 0;
  int at_speed = 0;
  Eigen::VectorXd gradient;
  for (int k = 0; k < 200; ++k) {
    u += lmpc.optimise(x, u, Eigen::VectorXd::Zero(80), kNothing);
    ASSERT_EQ(lmpc.solution().status, QpStatus::solved);
    ASSERT_LE(kkt_residual(lmpc.qp_model(), lmpc.qp_input(), lmpc.solution(),
                           lmpc.qp_model().Omega * lmpc.solution().z, gradient),
              1e-8);
    ASSERT_LE(std::abs(u(0)), 2.0 + 1e-8);
    x = design.A * x + design.B * u;
    ASSERT_LE(std::abs(x(1)), 0.6 + 1e-8);
    at_limit += std::abs(u(0)) > 1.999 ? 1 : 0;
    at_speed += std::abs(x(1)) > 0.599 ? 1 : 0;
  }
  EXPECT_GT(at_limit + at_speed, 10);
  EXPECT_LT(x.norm(), 1e-3);
  EXPECT_EQ(lmpc.statistics().unsolved, 0);
}

TEST(Lmpc, ReservedInputMovesTheBounds) {
  LmpcDesign design = cart_design(10, 3);
  design.input_bounds = {{0, -1.0, 1.0, steps(0, 2)}};
  Lmpc lmpc(design);
  const Eigen::VectorXd reference = Eigen::VectorXd::Constant(20, 50.0);
  EXPECT_NEAR(lmpc.optimise(Eigen::Vector2d::Zero(), kNothing, reference, kNothing)(0), 1.0, 1e-9);
  EXPECT_NEAR(lmpc.optimise(Eigen::Vector2d::Zero(), kNothing, reference,
                            Eigen::VectorXd::Constant(1, 0.75))(0),
              0.25, 1e-9);
}

LmpcDesign impossible_design() {
  // From 1 m/s an input of 1 N cannot reach 0.5 m/s, or a position below 0, at the next step.
  LmpcDesign design = cart_design(10, 10);
  design.input_bounds = {{0, -1.0, 1.0, steps(0, 9)}};
  design.state_bounds = {{1, -0.5, 0.5, steps(1, 10)}, {0, -9.0, 0.0, steps(1, 10)}};
  return design;
}

TEST(Lmpc, SoftensStateBoundsInTheirOrderButNeverInputs) {
  LmpcDesign design = impossible_design();
  Lmpc lmpc(design);
  const Eigen::VectorXd reference = Eigen::VectorXd::Zero(20);
  const double change = lmpc.optimise(Eigen::Vector2d(-5.0, 1.0), kNothing, reference, kNothing)(0);
  EXPECT_EQ(lmpc.solution().status, QpStatus::solved);
  EXPECT_NEAR(change, -1.0, 1e-6) << "as hard as the input may brake";
  EXPECT_EQ(lmpc.statistics().unsolved, 1);
  EXPECT_EQ(lmpc.statistics().softened, 1);
  EXPECT_EQ(lmpc.statistics().optimisations, 1);
  EXPECT_EQ(lmpc.softened_bounds(), 1) << "the velocity's bounds sufficed";
  EXPECT_EQ(lmpc.statistics().iterations, lmpc.iterations()) << "of both solves";
  EXPECT_EQ(lmpc.statistics().most_iterations, lmpc.iterations());
  const Eigen::VectorXd softness = lmpc.qp_input().softness;
  EXPECT_GT(softness.segment(10, 10).minCoeff(), 0.0);
  EXPECT_EQ(softness.tail(10).maxCoeff(), 0.0);

  lmpc.optimise(Eigen::Vector2d(0.1, 1.0), kNothing, reference, kNothing);
  EXPECT_EQ(lmpc.statistics().softened, 2);
  EXPECT_GT(lmpc.qp_input().softness.tail(10).minCoeff(), 0.0) << "here both had to";
  EXPECT_EQ(lmpc.qp_input().softness.head(10).maxCoeff(), 0.0) << "inputs never";
  Eigen::VectorXd u = kNothing;
  for (Eigen::Index i = 0; i < 10; ++i) {
    u += lmpc.solution().z.segment(i, 1);
    EXPECT_LE(std::abs(u(0)), 1.0 + 1e-8);
  }

  lmpc.optimise(Eigen::Vector2d(-5.0, 0.1), kNothing, reference, kNothing);
  EXPECT_EQ(lmpc.statistics().softened, 2) << "possible again, and hard again";
  EXPECT_EQ(lmpc.softened_bounds(), 0);
  EXPECT_EQ(lmpc.statistics().capped, 0);
}

// The reserved input has moved further than the input may change in a step.
TEST(Lmpc, RelaxesInputChangesLast) {
  LmpcDesign design = cart_design(10, 3);
  design.change_bounds = {{0, -0.1, 0.1, steps(0, 2)}};
  design.input_bounds = {{0, -1.0, 1.0, steps(0, 2)}};
  design.state_bounds = {{1, -5.0, 5.0, steps(1, 10)}};
  Lmpc lmpc(design);
  const Eigen::VectorXd reference = Eigen::VectorXd::Constant(20, 50.0);
  const Eigen::VectorXd reserved = Eigen::VectorXd::Constant(1, 1.5);
  const double change = lmpc.optimise(Eigen::Vector2d::Zero(), kNothing, reference, reserved)(0);
  EXPECT_NEAR(change, -0.5, 1e-9) << "no further than the input's bound asks for";
  EXPECT_EQ(lmpc.softened_bounds(), 2);
  EXPECT_EQ(lmpc.statistics().softened, 1);
  EXPECT_EQ(lmpc.solution().status, QpStatus::solved);

  design.on_infeasible = OnInfeasible::stop;
  EXPECT_THROW(Lmpc(design).optimise(Eigen::Vector2d::Zero(), kNothing, reference, reserved),
               ControlFailure);
}

// A penalty beyond double precision: the solver stops with an approximate solution.
TEST(Lmpc, AtTheIterationLimitTheInputStaysWithinItsBounds) {
  LmpcDesign design = impossible_design();
  design.change_bounds = {{0, -0.7, 0.7, steps(0, 9)}};
  design.softness = 1e-8;
  Lmpc lmpc(design);
  testing::Random random;
  Eigen::VectorXd u = kNothing;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::VectorXd x = 5.0 * random.vector(2);
    const double change = lmpc.optimise(x, u, Eigen::VectorXd::Zero(20), kNothing)(0);
    if (lmpc.solution().status != QpStatus::solved) {
      EXPECT_LE(std::abs(change), 0.7);
      EXPECT_LE(std::abs(u(0) + change), 1.0 + 1e-15);
    }
    u(0) += change;
  }
  EXPECT_GT(lmpc.statistics().capped, 10);
  EXPECT_GE(lmpc.statistics().unsolved, lmpc.statistics().capped);
}

TEST(Lmpc, NanIsAFailure) {
  for (const QpSolverKind solver : {QpSolverKind::active_set, QpSolverKind::hildreth}) {
    LmpcDesign design = impossible_design();
    design.solver = solver;
    Lmpc lmpc(design);
    EXPECT_THROW(
        lmpc.optimise(Eigen::Vector2d(NAN, 0.0), kNothing, Eigen::VectorXd::Zero(20), kNothing),
        ControlFailure);
  }
}

TEST(Lmpc, DetectsAnEmptyInputSet) {
  LmpcDesign design = cart_design(10, 3);
  design.change_bounds = {{0, -0.1, 0.1, steps(0, 2)}};
  design.input_bounds = {{0, 1.0, 2.0, steps(0, 2)}};
  EXPECT_FALSE(Lmpc(design).inputs_are_feasible(kNothing));
  EXPECT_TRUE(Lmpc(design).inputs_are_feasible(kOne.col(0)));
}

TEST(Lmpc, RefusesNonsense) {
  const auto refuses = [](const std::function<void(LmpcDesign&)>& spoil) {
    LmpcDesign design = cart_design(10, 3);
    spoil(design);
    EXPECT_REFUSED(Lmpc{design});
  };
  refuses([](LmpcDesign& d) { d.prediction_steps = 0; });
  refuses([](LmpcDesign& d) { d.control_steps = 0; });
  refuses([](LmpcDesign& d) { d.control_steps = 11; });
  refuses([](LmpcDesign& d) { d.R = -kOne; });
  refuses([](LmpcDesign& d) { d.R = NAN * kOne; });
  refuses([](LmpcDesign& d) { d.Q = -d.Q; });
  refuses([](LmpcDesign& d) { d.Q_last = Eigen::MatrixXd::Identity(3, 3); });
  refuses([](LmpcDesign& d) {
    d.Q = d.Q_last = Eigen::Matrix2d::Zero();
    d.R = 0.0 * kOne;
  });
  refuses([](LmpcDesign& d) { d.input_bounds = {{0, 1.0, -1.0, {0}}}; });
  refuses([](LmpcDesign& d) { d.input_bounds = {{0, NAN, 1.0, {0}}}; });
  refuses([](LmpcDesign& d) { d.input_bounds = {{1, -1.0, 1.0, {0}}}; });
  refuses([](LmpcDesign& d) { d.input_bounds = {{0, -1.0, 1.0, {3}}}; });
  refuses([](LmpcDesign& d) { d.state_bounds = {{0, -1.0, 1.0, {0}}}; });
  refuses([](LmpcDesign& d) { d.state_bounds = {{2, -1.0, 1.0, {1}}}; });
  refuses([](LmpcDesign& d) { d.max_iterations = 0; });
  refuses([](LmpcDesign& d) { d.softness = 0.0; });
}

TEST(Prediction, EqualsSteppingThePlant) {
  testing::Random random;
  for (int k = 0; k < 30; ++k) {
    const Eigen::Index n = 1 + k % 4;
    const Eigen::Index m = 1 + k % 2;
    const int N_p = 1 + k % 12;
    const int N_u = 1 + (k * 7) % N_p;
    const Eigen::MatrixXd A = random.matrix(n, n);
    const Eigen::MatrixXd B = random.matrix(n, m);
    const Eigen::VectorXd x = random.vector(n);
    const Eigen::VectorXd last_input = random.vector(m);
    const Eigen::VectorXd changes = random.vector(N_u * m);
    const Prediction p = predict(A, B, N_p, N_u);
    const Eigen::VectorXd predicted = p.Psi * x + p.Gamma * last_input + p.Theta * changes;

    Eigen::VectorXd state = x;
    Eigen::VectorXd input = last_input;
    for (int i = 0; i < N_p; ++i) {
      if (i < N_u) input += changes.segment(i * m, m);
      state = A * state + B * input;
      EXPECT_LT((predicted.segment(i * n, n) - state).norm(), 1e-10 * (1.0 + state.norm()));
    }
  }
}

TEST(Prediction, RefusesAnEmptyHorizon) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  EXPECT_REFUSED(predict(one, one, 0, 1));
  EXPECT_REFUSED(predict(one, one, 1, 0));
  EXPECT_REFUSED(predict(one, one, 2, 3));
  EXPECT_REFUSED(predict(Eigen::MatrixXd::Ones(2, 1), one, 2, 2));
  EXPECT_NO_THROW(predict(one, one, 2, 2));
}

// Inputs that regulators and predictive controllers pass to their estimators and to the drive.

constexpr double kPeriod = 0.01;
constexpr int kSamplesPerMove = 10;
constexpr double kLimit = 2.0;
constexpr double kDisturbance = 5.0;

std::unique_ptr<DisturbanceEstimator> idob() {
  return std::make_unique<Idob>(damped_inertia(1.0, 0.5),
                                std::vector<PoleGroup>{{-20.0, -25.0, -30.0}}, kPeriod);
}

PredictiveControlDesign design(DisturbanceUse use) {
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.5), kPeriod * kSamplesPerMove);
  PredictiveControlDesign design;
  design.lmpc.A = plant.A;
  design.lmpc.B = plant.B;
  design.lmpc.prediction_steps = 20;
  design.lmpc.control_steps = 5;
  design.lmpc.Q = design.lmpc.Q_last = Eigen::Vector2d(10.0, 1.0).asDiagonal();
  design.lmpc.R = Eigen::MatrixXd::Constant(1, 1, 0.1);
  design.lmpc.max_iterations = 60;
  design.lmpc.softness = 1e-6;
  design.disturbance_use = use;
  design.samples_per_move = kSamplesPerMove;
  design.reference = {1.0, 0.0};
  design.start_state = Eigen::Vector2d::Zero();
  return design;
}

// The largest commanded |u| on the exactly sampled plant, behind a drive with a limit.
double run_loop(Controller& controller, double drive_limit, double noise, int samples) {
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.5), kPeriod);
  testing::Random random;
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  Sample sample{0.0, Eigen::VectorXd::Zero(3)};
  controller.reset(sample);
  double largest = 0.0;
  for (int k = 0; k < samples; ++k) {
    sample.time_s = k * kPeriod;
    sample.y << x(0) + random.uniform(-noise, noise), x;
    controller.update(sample, u);
    largest = std::max(largest, std::abs(u(0)));
    x = plant.A * x + plant.B * (std::clamp(u(0), -drive_limit, drive_limit) - kDisturbance);
  }
  return largest;
}

// The drive's limit is too small for the disturbance. The estimate must stay bounded.
TEST(PredictiveControl, PassesTheDriveLimitsToTheEstimator) {
  PredictiveControlDesign limited = design(DisturbanceUse::cancel);
  limited.force_limit = kLimit;
  PredictiveControl controller(idob(), limited);
  EXPECT_GT(run_loop(controller, kLimit, 0.0, 300), kLimit);
  EXPECT_NEAR(controller.estimator().disturbance()(0), kDisturbance, 1e-3);

  limited.force_limit = 0.0;
  EXPECT_REFUSED(PredictiveControl(idob(), limited));
}

// Under noise the estimate changes at each sample. The cancellation follows at each sample or only
// at decisions.
TEST(PredictiveControl, CancelsAtEachSampleOrAtEachDecision) {
  const auto changes = [](CancelAt at) {
    PredictiveControlDesign cancelling = design(DisturbanceUse::cancel);
    cancelling.cancel_at = at;
    PredictiveControl controller(idob(), cancelling);
    Sample sample{0.0, Eigen::VectorXd::Zero(3)};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
    testing::Random random;
    controller.reset(sample);
    int count = 0;
    for (int k = 0; k < 10 * kSamplesPerMove; ++k) {
      const double before = u(0);
      sample.y(0) = random.uniform(-0.1, 0.1);
      controller.update(sample, u);
      count += u(0) != before ? 1 : 0;
      if (k % kSamplesPerMove == 0 && k > 0) {
        EXPECT_NE(u(0), before) << k;
      }
    }
    return count;
  };
  EXPECT_GT(changes(CancelAt::sample), 9 * kSamplesPerMove);
  EXPECT_LE(changes(CancelAt::decision), 10);
}

TEST(LqrControl, PassesTheDriveLimitsToTheEstimator) {
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.5), kPeriod);
  const Eigen::MatrixXd K =
      dlqr(plant.A, plant.B, Eigen::Matrix2d::Identity(), Eigen::MatrixXd::Ones(1, 1)).K;
  for (const bool uses_true_state : {false, true}) {
    LqrControl controller(idob(), K, Eigen::Vector2d::Zero(), uses_true_state, kLimit);
    EXPECT_GT(run_loop(controller, kLimit, 0.0, 300), kLimit);
    EXPECT_NEAR(controller.estimator().disturbance()(0), kDisturbance, 1e-3);
    ASSERT_GE(controller.signals().size(), 3U);
    EXPECT_EQ(controller.signals()[0].name, "position_hat_m");
    EXPECT_EQ(controller.signals()[2].values.data(), controller.estimator().disturbance().data());
  }
  EXPECT_REFUSED(LqrControl(idob(), K, Eigen::Vector2d::Zero(), false, 0.0));
}

// The estimate changes ten times between two optimisations, and strongly under noise.
TEST(PredictiveControl, MovedBoundsHoldBetweenTheOptimisationsToo) {
  PredictiveControlDesign bounded = design(DisturbanceUse::cancel_within_bounds);
  bounded.lmpc.input_bounds = {{0, -kLimit, 1.5 * kLimit, {0, 1, 2, 3, 4}}};
  PredictiveControl controller(idob(), bounded);
  EXPECT_LE(run_loop(controller, INFINITY, 0.02, 500), 1.5 * kLimit);

  bounded.disturbance_use = DisturbanceUse::cancel;
  PredictiveControl unbounded(idob(), bounded);
  EXPECT_GT(run_loop(unbounded, INFINITY, 0.02, 500), 3.0 * kLimit) << "the noise would break them";
}

}  // namespace breakwater::lmpc_test
