// Inputs that regulators and predictive controllers pass to their estimators and to the drive.
#include <breakwater/control/predictive_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <breakwater/control/lqr_control.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/observers/idob.h>
#include <breakwater/plants/damped_inertia.h>
#include "support.h"

namespace breakwater::predictive_control_test {
namespace {

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
  EXPECT_THROW(PredictiveControl(idob(), limited), std::invalid_argument);
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
  EXPECT_THROW(LqrControl(idob(), K, Eigen::Vector2d::Zero(), false, 0.0), std::invalid_argument);
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

}  // namespace
}  // namespace breakwater::predictive_control_test
