#include <breakwater/control/acceleration_control.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support.h"

namespace breakwater::acceleration_control_test {
namespace {

AccelerationControlDesign design() {
  AccelerationControlDesign d;
  d.nominal_inertia_kgm2 = Eigen::Vector2d(2.0, 0.5);
  d.torque_limit_Nm = Eigen::Vector2d(20.0, 10.0);
  d.make_observer = [J = d.nominal_inertia_kgm2] {
    return joint_idobs(J, {{-40.0, -43.0, -46.0}, {-41.0, -44.0, -47.0}}, 1e-3);
  };
  d.period_s = 1e-3;
  return d;
}

// The true joints, with a load and an inertia that differs from the nominal one.
struct Plant {
  Eigen::Vector2d inertia{1.2, 0.8};
  Eigen::Vector2d load{3.0, -2.0};
  Eigen::Vector2d q{0.1, -0.2};
  Eigen::Vector2d dq{0.0, 0.0};

  void advance(const Eigen::Vector2d& torque, double duration_s) {
    const Eigen::Vector2d ddq = (torque - load).cwiseQuotient(inertia);
    q += dq * duration_s + 0.5 * ddq * duration_s * duration_s;
    dq += ddq * duration_s;
  }
};

TEST(AccelerationControl, GivesTheCommandedJointAcceleration) {
  // For any inertia and load, q̈ = a once the observer has converged.
  AccelerationControl control(design());
  Plant plant;
  control.reset(plant.q);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(2);
  const Eigen::Vector2d a(0.3, -0.4);
  Eigen::Vector2d velocity_before = Eigen::Vector2d::Zero();
  for (int k = 0; k < 5000; ++k) {
    if (k == 4900) velocity_before = plant.dq;
    control.update(plant.q);
    control.command(a, torque);
    plant.advance(torque, 1e-3);
  }
  const Eigen::Vector2d achieved = (plant.dq - velocity_before) / 0.1;
  EXPECT_TRUE(achieved.isApprox(a, 1e-9));
  // It cancels the load and the effect of the mismatch (Eq. 2.53).
  const Eigen::Vector2d expected =
      plant.load + (plant.inertia - design().nominal_inertia_kgm2).cwiseProduct(achieved);
  EXPECT_LT((control.d_hat() - expected).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(AccelerationControl, AccelerationLimitsKeepTheTorqueLimits) {
  // The ends of Eq. 2.84 give the ends of Eq. 2.81.
  AccelerationControl control(design());
  control.reset(Eigen::Vector2d(0, 0));
  Eigen::VectorXd torque(2);
  for (int k = 0; k < 50; ++k) {  // winds up a disturbance
    control.update(Eigen::Vector2d(0.001 * k, -0.002 * k));
    control.command(Eigen::Vector2d(1, 1), torque);
  }
  ASSERT_GT(control.d_hat().norm(), 0.1);
  const Eigen::Vector2d upper(control.upper_acceleration(0), control.upper_acceleration(1));
  const Eigen::Vector2d lower(control.lower_acceleration(0), control.lower_acceleration(1));
  control.command(upper, torque);
  EXPECT_TRUE(torque.isApprox(Eigen::Vector2d(20, 10), 1e-12));
  control.command(lower, torque);
  EXPECT_TRUE(torque.isApprox(Eigen::Vector2d(-20, -10), 1e-12));
}

TEST(AccelerationControl, OnlyTheUnclippedFeedWindsUp) {
  // A blocked joint and a command of ten times its torque limit.
  const Eigen::Vector2d a(100.0, 200.0);
  double d_hat[2] = {0.0, 0.0};
  for (const ObserverFeed feed : {ObserverFeed::clipped, ObserverFeed::unclipped}) {
    AccelerationControlDesign d = design();
    d.feed = feed;
    AccelerationControl control(d);
    control.reset(Eigen::Vector2d(0, 0));
    Eigen::VectorXd torque = Eigen::VectorXd::Zero(2);
    for (int k = 0; k < 1000; ++k) {
      control.update(Eigen::Vector2d(0, 0));
      control.command(a, torque);
    }
    d_hat[feed == ObserverFeed::unclipped] = control.d_hat()(0);
  }
  EXPECT_NEAR(d_hat[0], 20.0, 1e-3);  // only the limit acts on a blocked joint
  EXPECT_GT(d_hat[1], 200.0);         // J a and everything that the observer adds
}

TEST(AccelerationControl, RefusesNonsense) {
  AccelerationControlDesign d = design();
  d.torque_limit_Nm = Eigen::Vector3d(1, 1, 1);
  EXPECT_THROW(AccelerationControl{d}, std::invalid_argument);
  d = design();
  d.nominal_inertia_kgm2(1) = 0.0;
  EXPECT_THROW(AccelerationControl{d}, std::invalid_argument);
  d = design();
  d.make_observer = [] { return joint_idobs(Eigen::VectorXd::Ones(1), {{-1, -2, -3}}, 1e-3); };
  EXPECT_THROW(AccelerationControl{d}, std::invalid_argument) << "an observer of one joint";
  EXPECT_THROW(joint_idobs(Eigen::VectorXd::Ones(2), {{-1, -2, -3}}, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::acceleration_control_test
