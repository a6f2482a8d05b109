#include <breakwater/control/disturbance_cancelling_pd.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include <breakwater/observers/idob.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/plants/damped_inertia.h>

namespace breakwater::disturbance_cancelling_pd_test {
namespace {

constexpr double kPeriod = 0.01;

std::unique_ptr<DisturbanceEstimator> idob(const StateSpace& plant) {
  return std::make_unique<Idob>(plant, std::vector<PoleGroup>{{-20.0, -25.0, -30.0}}, kPeriod);
}

DisturbanceCancellingPdDesign design() {
  return {.k_p = 10.0,
          .k_d = 5.0,
          .reference = {0.5, 1.0},
          .period_s = kPeriod,
          .units = rotation_units()};
}

// Runs the loop on the exactly sampled plant with a constant disturbance. Returns the last state.
Eigen::Vector2d run_loop(DisturbanceCancellingPd& controller, double disturbance, double limit,
                         int samples) {
  const StateSpace plant = zero_order_hold(damped_inertia(1.0, 0.0), kPeriod);
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  Sample sample{0.0, Eigen::VectorXd::Zero(1)};
  controller.reset(sample);
  for (int k = 0; k < samples; ++k) {
    sample.time_s = k * kPeriod;
    sample.y(0) = x(0);
    controller.update(sample, u);
    x = plant.A * x + plant.B * (std::clamp(u(0), -limit, limit) - disturbance);
  }
  return x;
}

TEST(DisturbanceCancellingPd, ReachesItsReferenceUnderAnyDisturbance) {
  for (const double d : {0.0, 7.0, -3.0}) {
    DisturbanceCancellingPd controller(idob(damped_inertia(1.0, 0.0)), design());
    const Eigen::Vector2d x = run_loop(controller, d, INFINITY, 1500);
    EXPECT_NEAR(x(0), 0.5, 1e-9) << d;
    EXPECT_NEAR(controller.disturbance(), d, 1e-9);
  }
}

TEST(DisturbanceCancellingPd, FollowsEquation422) {
  DisturbanceCancellingPd controller(idob(damped_inertia(1.0, 0.0)), design());
  Sample sample{0.0, Eigen::VectorXd::Zero(1)};
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  controller.reset(sample);
  for (int k = 0; k < 200; ++k) {
    sample.time_s = k * kPeriod;
    sample.y(0) = 0.1 * std::sin(0.3 * k);
    controller.update(sample, u);
    const double reference = k < 100 ? 0.0 : 0.5;
    EXPECT_EQ(controller.reference(), reference);
    EXPECT_DOUBLE_EQ(u(0), 10.0 * (reference - controller.position()) -
                               5.0 * controller.velocity() + controller.disturbance());
  }
}

TEST(DisturbanceCancellingPd, PassesTheDriveLimitsToTheEstimator) {
  // The drive's limit is too small for d = 5. The estimate must stay bounded.
  auto limited = design();
  limited.force_limit = 2.0;
  DisturbanceCancellingPd controller(idob(damped_inertia(1.0, 0.0)), limited);
  run_loop(controller, 5.0, 2.0, 300);
  EXPECT_NEAR(controller.disturbance(), 5.0, 1e-3);
}

TEST(DisturbanceCancellingPd, RefusesNonsense) {
  auto bad = design();
  bad.force_limit = 0.0;
  EXPECT_THROW(DisturbanceCancellingPd(idob(damped_inertia(1.0, 0.0)), bad), std::invalid_argument);
  bad = design();
  bad.period_s = 0.0;
  EXPECT_THROW(DisturbanceCancellingPd(idob(damped_inertia(1.0, 0.0)), bad), std::invalid_argument);
  const StateSpace two{Eigen::MatrixXd::Zero(3, 3), Eigen::Vector3d(0, 0, 1),
                       Eigen::RowVector3d(1, 0, 0)};
  StateSpace chain = two;
  chain.A(0, 1) = chain.A(1, 2) = 1.0;
  EXPECT_THROW(
      DisturbanceCancellingPd(
          std::make_unique<Idob>(chain, std::vector<PoleGroup>{{-1.0, -2.0, -3.0, -4.0}}, kPeriod),
          design()),
      std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::disturbance_cancelling_pd_test
