// Parts of the arm's controllers: accelerations, and inverse kinematics. tests/python/logs_test.py
// has the laws.
#include <Eigen/LU>

#include <breakwater/control/acceleration_control.h>
#include <breakwater/control/inverse_kinematics.h>
#include <breakwater/plants/planar_chain.h>
#include "support.h"

namespace breakwater::arm_controllers_test {

AccelerationControlDesign design() {
  AccelerationControlDesign d;
  d.nominal_inertia_kgm2 = Eigen::Vector2d(2.0, 0.5);
  d.torque_limit_Nm = Eigen::Vector2d(20.0, 10.0);
  d.observer =
      joint_idobs(d.nominal_inertia_kgm2, {{-40.0, -43.0, -46.0}, {-41.0, -44.0, -47.0}}, 1e-3);
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
  const Eigen::Vector2d upper(control.upper(0), control.upper(1));
  const Eigen::Vector2d lower(control.lower(0), control.lower(1));
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
  d.observer = joint_idobs(Eigen::VectorXd::Ones(1), {{-1, -2, -3}}, 1e-3);
  EXPECT_THROW(AccelerationControl{d}, std::invalid_argument) << "an observer of one joint";
  EXPECT_THROW(joint_idobs(Eigen::VectorXd::Ones(2), {{-1, -2, -3}}, 1e-3), std::invalid_argument);
}

PlanarChain chain_of(int n) {
  std::vector<PlanarJoint> joints(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].offset_m = {i == 0 ? 0.0 : 0.2, 0.0};
    joints[i].link_mass_kg = 1.0;
  }
  return {joints, {0.2, 0.0}, 0.0};
}

// Repeats the step, as the position loop does, until the tip stops.
double error_after(LmInverseKinematics& ik, const PlanarChain& chain, Eigen::VectorXd q,
                   const TipVector& goal, int iterations) {
  TaskJacobian J(3, chain.joints());
  for (int i = 0; i < iterations; ++i) {
    chain.tip_jacobian(q, J);
    q += ik.step(J, goal - chain.tip_pose(q));
  }
  return (goal - chain.tip_pose(q)).norm();
}

TEST(LmInverseKinematics, ConvergesFromABentPosture) {
  LmInverseKinematics ik({}, 3);
  EXPECT_LT(error_after(ik, chain_of(3), Eigen::Vector3d(0.9, -1.8, 0.9),
                        Eigen::Vector3d(0.5, 0.05, 0.1), 50),
            1e-9);
}

TEST(LmInverseKinematics, StaysFiniteAtTheStretchedPosture) {
  // A singular posture: x has no first-order reduction. The step must be finite and nonzero.
  LmInverseKinematics ik({}, 3);
  TaskJacobian J(3, 3);
  chain_of(3).tip_jacobian(Eigen::Vector3d::Zero(), J);
  const Eigen::VectorXd step = ik.step(J, Eigen::Vector3d(-0.15, 0.0, 0.0));
  EXPECT_TRUE(step.allFinite());
  EXPECT_GT(step.norm(), 1e-3);
  EXPECT_LE(step.cwiseAbs().maxCoeff(), M_PI);
}

TEST(LmInverseKinematics, SugiharaWorksForAnyNumberOfJoints) {
  LmDesign design;
  design.form = LmForm::sugihara;
  testing::Random random;
  for (const int n : {2, 3, 4, 6}) {
    const PlanarChain chain = chain_of(n);
    const Eigen::VectorXd start = random.vector(n);
    const TipVector goal = chain.tip_pose(start + 0.3 * random.vector(n));
    LmInverseKinematics ik(design, n);
    EXPECT_LT(error_after(ik, chain, start, goal, 300), 1e-6) << n;
  }
}

// {Jᵀ W_e J + W_n} q̃ = M (Eqs. 2.65 to 2.68), for each form, by another factorization.
TEST(LmInverseKinematics, SolvesTheEquationOfItsForm) {
  testing::Random random;
  const PlanarChain arm = chain_of(3);
  int solved = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d X_e = 0.1 * random.vector(3);
    TaskJacobian J(3, 3);
    arm.tip_jacobian(random.vector(3, 3.0), J);
    const Eigen::Matrix3d W_e = LmDesign().weights.asDiagonal();
    const Eigen::Vector3d task = J.transpose() * W_e * X_e;
    const Eigen::Vector3d square = Eigen::Vector3d::Constant(0.5 * X_e.dot(W_e * X_e));
    const struct {
      LmForm form;
      Eigen::Vector3d M, W_n;
    } rows[] = {{LmForm::printed, task + X_e, X_e.cwiseAbs()},
                {LmForm::sugihara_damping, task + X_e, square},
                {LmForm::sugihara, task, square}};
    for (const auto& row : rows) {
      LmDesign design;
      design.form = row.form;
      Eigen::Matrix3d normal = J.transpose() * W_e * J;
      normal.diagonal() += row.W_n + Eigen::Vector3d::Constant(design.damping);
      const Eigen::Vector3d expected = normal.fullPivLu().solve(row.M);
      if (expected.cwiseAbs().maxCoeff() >= design.step_limit_rad) continue;
      ++solved;
      EXPECT_LT((LmInverseKinematics(design, 3).step(J, X_e) - expected).norm(),
                1e-9 * expected.norm())
          << static_cast<int>(row.form);
    }
  }
  EXPECT_GT(solved, 100);
}

TEST(LmInverseKinematics, LimitsEachStep) {
  LmDesign design;
  design.step_limit_rad = 0.01;
  LmInverseKinematics ik(design, 3);
  TaskJacobian J(3, 3);
  chain_of(3).tip_jacobian(Eigen::Vector3d(0.9, -1.8, 0.9), J);
  EXPECT_DOUBLE_EQ(ik.step(J, Eigen::Vector3d(0.5, 0.5, 0.5)).cwiseAbs().maxCoeff(), 0.01);
}

TEST(LmInverseKinematics, RefusesNonsense) {
  EXPECT_THROW(LmInverseKinematics({}, 4), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.weights = Eigen::Vector3d(1, 0, 1)}, 3),
               std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.damping = 0.0}, 3), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.step_limit_rad = 0.0}, 3), std::invalid_argument);
  EXPECT_THROW(LmInverseKinematics({.step_limit_rad = std::nan("")}, 3), std::invalid_argument);
}

}  // namespace breakwater::arm_controllers_test
