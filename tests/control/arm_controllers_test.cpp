// Controllers of the arm and their parts: accelerations, and inverse kinematics.
#include <Eigen/Dense>
#include <Eigen/LU>

#include <breakwater/control/acceleration_control.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/inverse_kinematics.h>
#include <breakwater/control/workspace_control.h>
#include "control/controller_signal.h"
#include "support.h"

namespace breakwater::arm_controllers_test {

using testing::signal;

class ArmControllers : public ::testing::Test {
 protected:
  ArmControllers() : chain_(load_planar_chain(testing::source_file("models/arm.urdf"))) {
    acceleration_.nominal_inertia_kgm2 = Eigen::Vector3d(2.6683, 1.6772, 0.8155);
    acceleration_.torque_limit_Nm = chain_.effort_limits_Nm();
    acceleration_.make_observer = [J = acceleration_.nominal_inertia_kgm2] {
      return joint_idobs(J, {{-40.0, -43.0, -46.0}, {-41.0, -44.0, -47.0}, {-42.0, -45.0, -48.0}},
                         1e-3);
    };
    acceleration_.period_s = 1e-3;
    const double bend = std::acos(0.625);
    task_.start_angles_rad = Eigen::Vector3d(bend, -2 * bend, bend);
    task_.start_pose = chain_.tip_pose(task_.start_angles_rad);
    task_.force_control_from_s = 1.0;
    task_.force_reference_N = 2.0;
    task_.convert_gain_N_m = 20.0;
  }

  ImplicitForcePfcDesign pfc_design(Positioning positioning = Positioning::joint) const {
    return {std::vector<PfcDesign>(3, PfcDesign{}), LmDesign{}, positioning};
  }

  // Feeds moving angles, so that q̂, q̇̂ and d̂ are not zero. Then makes one sample at `time_s`
  // with `force`.
  Eigen::VectorXd update(Controller& controller, double time_s, double force) const {
    Sample sample;
    sample.y.resize(4);
    Eigen::VectorXd u(3);
    for (int k = 0; k <= 40; ++k) {
      sample.time_s = time_s + 1e-3 * (k - 40);
      sample.y << task_.start_angles_rad + k * Eigen::Vector3d(4e-4, -7e-4, 3e-4), force;
      if (k == 0) controller.reset(sample);
      controller.update(sample, u);
    }
    return u;
  }

  PlanarChain chain_;
  AccelerationControlDesign acceleration_;
  ArmTask task_;
};

TEST_F(ArmControllers, TorqueIsNominalInertiaTimesAccelerationPlusDisturbance) {
  Hpfc hpfc(chain_, acceleration_, task_, {});
  const Eigen::VectorXd u = update(hpfc, 2.0, 0.5);
  const Eigen::VectorXd expected =
      acceleration_.nominal_inertia_kgm2.cwiseProduct(signal(hpfc, "ddq_ref_rad_s2")) +
      signal(hpfc, "d_hat_Nm");
  EXPECT_TRUE(u.isApprox(expected, 1e-14));
  EXPECT_GT(signal(hpfc, "d_hat_Nm").norm(), 0.1);  // otherwise the test shows nothing
}

TEST_F(ArmControllers, HpfcFollowsEqs289To291) {
  const WorkspaceControlDesign design{30.0, 40.0, 0.02};
  for (const double time_s : {0.5, 2.0}) {
    Hpfc hpfc(chain_, acceleration_, task_, design);
    update(hpfc, time_s, 0.5);
    const Eigen::Vector3d q = signal(hpfc, "q_hat_rad"), dq = signal(hpfc, "dq_hat_rad_s");
    TaskJacobian J(3, 3);
    chain_.tip_jacobian(q, J);
    const Eigen::Matrix3d J_plus = Eigen::Matrix3d(J).inverse();  // nonsingular here
    const bool force_control = time_s > 1.0;
    const Eigen::Matrix3d S = Eigen::Vector3d(force_control ? 0 : 1, 1, 1).asDiagonal();
    const Eigen::Vector3d F_error(force_control ? 2.0 - 0.5 : 0.0, 0, 0);
    const Eigen::Vector3d expected = J_plus * (30.0 * S * (task_.start_pose - chain_.tip_pose(q)) -
                                               2 * std::sqrt(30.0) * (J * dq)) +
                                     40.0 * J.transpose() * F_error;
    EXPECT_TRUE(signal(hpfc, "ddq_ref_rad_s2").isApprox(expected, 1e-9)) << time_s;
  }
}

TEST_F(ArmControllers, DracGivesTheTipTheResolvedAcceleration) {
  // J a + J̇ q̇ must be K_p e − K_d Ẋ (Eq. 2.93), with x's reference from the force error.
  Drac drac(chain_, acceleration_, task_, {15.0, 0.0, 0.02});
  update(drac, 2.0, 0.5);
  const Eigen::Vector3d q = signal(drac, "q_hat_rad"), dq = signal(drac, "dq_hat_rad_s");
  TaskJacobian J(3, 3);
  chain_.tip_jacobian(q, J);
  const Eigen::Vector3d acceleration =
      J * signal(drac, "ddq_ref_rad_s2") + chain_.tip_bias_acceleration(q, dq);
  Eigen::Vector3d error = task_.start_pose - chain_.tip_pose(q);
  error[0] = (2.0 - 0.5) / 20.0;
  const Eigen::Vector3d expected = 15.0 * error - 2 * std::sqrt(15.0) * (J * dq);
  EXPECT_TRUE(acceleration.isApprox(expected, 1e-9));
}

TEST_F(ArmControllers, ProposedChainsItsParts) {
  ImplicitForcePfc proposed(chain_, acceleration_, task_, pfc_design());
  update(proposed, 2.0, 0.5);
  const Eigen::Vector3d q = signal(proposed, "q_hat_rad"), dq = signal(proposed, "dq_hat_rad_s");
  EXPECT_NEAR(signal(proposed, "x_ref_m")(0), chain_.tip_pose(q)[0] + 1.5 / 20.0, 1e-15);
  TaskJacobian J(3, 3);
  chain_.tip_jacobian(q, J);
  TipVector error = task_.start_pose - chain_.tip_pose(q);
  error[0] = 1.5 / 20.0;
  LmInverseKinematics ik({}, 3);
  const Eigen::Vector3d q_ref = q + ik.step(J, error);
  EXPECT_TRUE(signal(proposed, "q_ref_rad").isApprox(q_ref, 1e-12));
  const Pfc pfc({});
  const Eigen::Vector3d d = signal(proposed, "d_hat_Nm");
  for (int i = 0; i < 3; ++i) {
    const double limit = chain_.effort_limits_Nm()(i);
    const double inertia = acceleration_.nominal_inertia_kgm2(i);
    const double expected = std::clamp(pfc.acceleration(q_ref(i), q(i), dq(i)),
                                       (-limit - d(i)) / inertia, (limit - d(i)) / inertia);
    EXPECT_NEAR(signal(proposed, "ddq_ref_rad_s2")(i), expected, 1e-9);
  }
}

TEST_F(ArmControllers, ProposedHoldsItsPostureBeforeForceControl) {
  ImplicitForcePfc by_joint(chain_, acceleration_, task_, pfc_design(Positioning::joint));
  update(by_joint, 0.5, 0.0);
  EXPECT_TRUE(signal(by_joint, "q_ref_rad").isApprox(task_.start_angles_rad));
  ImplicitForcePfc by_tip(chain_, acceleration_, task_, pfc_design(Positioning::workspace));
  update(by_tip, 0.5, 0.0);
  EXPECT_FALSE(signal(by_tip, "q_ref_rad").isApprox(task_.start_angles_rad, 1e-6));
  EXPECT_EQ(signal(by_tip, "x_ref_m")(0), task_.start_pose[0]);
}

TEST_F(ArmControllers, ProposedNeverExceedsTheTorqueLimit) {
  task_.force_reference_N = 2000.0;
  task_.convert_gain_N_m = 20.0;
  ImplicitForcePfc proposed(chain_, acceleration_, task_, pfc_design());
  const Eigen::VectorXd u = update(proposed, 2.0, 0.0);
  const Eigen::ArrayXd ratio = u.cwiseAbs().cwiseQuotient(chain_.effort_limits_Nm());
  EXPECT_LE(ratio.maxCoeff(), 1.0 + 1e-12);
  EXPECT_GE(ratio.maxCoeff(), 1.0 - 1e-12);
}

TEST_F(ArmControllers, ForceControlStartsAtItsSample) {
  // At the sample of the switch, also if its time has a rounding error.
  for (const double time_s : {1.0, 1.0 - 1e-13, 1.0 + 1e-13}) {
    Hpfc hpfc(chain_, acceleration_, task_, {});
    update(hpfc, time_s, 0.5);
    EXPECT_NE(signal(hpfc, "x_ref_m")(0), task_.start_pose[0]);
  }
  Hpfc hpfc(chain_, acceleration_, task_, {});
  update(hpfc, 0.999, 0.5);
  EXPECT_EQ(signal(hpfc, "x_ref_m")(0), task_.start_pose[0]);
}

TEST_F(ArmControllers, RefuseNonsense) {
  for (const WorkspaceControlDesign& gains : std::vector<WorkspaceControlDesign>{
           {-1.0, 0.0, 0.02}, {1.0, -1.0, 0.02}, {1.0, 0.0, -0.02}}) {
    EXPECT_THROW(Hpfc(chain_, acceleration_, task_, gains), std::invalid_argument);
  }
  ImplicitForcePfcDesign two_joints = pfc_design();
  two_joints.joints.pop_back();
  EXPECT_THROW(ImplicitForcePfc(chain_, acceleration_, task_, two_joints), std::invalid_argument);
  task_.convert_gain_N_m = 0.0;
  EXPECT_THROW(Drac(chain_, acceleration_, task_, {}), std::invalid_argument);
  task_.convert_gain_N_m = 20.0;
  task_.start_angles_rad = Eigen::Vector2d(0, 0);
  EXPECT_THROW(Drac(chain_, acceleration_, task_, {}), std::invalid_argument);
}

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
