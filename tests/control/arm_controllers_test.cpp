// The three controllers of the arm, one sample at a time, against their equations.

#include <Eigen/Dense>
#include <cmath>

#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/workspace_control.h>
#include "control/controller_signal.h"
#include "support.h"

namespace breakwater::arm_controllers_test {
namespace {

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

}  // namespace
}  // namespace breakwater::arm_controllers_test
