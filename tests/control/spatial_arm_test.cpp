// The arm's controllers on chains in space.
#include <cmath>

#include <breakwater/control/energy_admittance.h>
#include <breakwater/control/implicit_force_pfc.h>
#include <breakwater/control/soft_contact.h>
#include <breakwater/control/workspace_control.h>
#include <breakwater/plants/tip_chain.h>
#include "control/controller_signal.h"
#include "support.h"

namespace breakwater::spatial_arm_test {
namespace {

constexpr double kPeriod = 1e-3;

// Joints that its state is written to: the estimates are exact.
class KnownState final : public DisturbanceEstimator {
 public:
  explicit KnownState(Eigen::Index joints)
      : state_(Eigen::VectorXd::Zero(2 * joints)), none_(Eigen::VectorXd::Zero(joints)) {}
  void reset(const Vector&) override {}
  void update(const Vector&, const Vector&) override {}
  View state() const override { return {state_.data(), state_.size()}; }
  View disturbance() const override { return {none_.data(), none_.size()}; }
  Eigen::VectorXd state_;

 private:
  Eigen::VectorXd none_;
};

struct Arm : ArmSetup {
  std::shared_ptr<KnownState> known;

  Arm(TipChain its_chain, const Eigen::VectorXd& start, double limit_Nm)
      : ArmSetup{std::move(its_chain), {}, {}, kPeriod},
        known(std::make_shared<KnownState>(start.size())) {
    acceleration.nominal_inertia_kgm2 = Eigen::VectorXd::Ones(start.size());
    acceleration.torque_limit_Nm = Eigen::VectorXd::Constant(start.size(), limit_Nm);
    acceleration.observer = known;
    task.start_angles_rad = start;
    task.start_pose = chain->tip_pose(start);
    task.force_reference_N = 2.0;
    task.convert_gain_N_m = 20.0;
    task.force_control_from_s = 0.0;
  }
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  Eigen::VectorXd torque(Controller& law, const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                         double force_N, double time_s) {
    Sample sample;
    sample.time_s = time_s;
    sample.y.resize(q.size() + 2);
    sample.y << q, force_N, force_N;
    known->state_ << q, dq;
    if (time_s == 0.0) law.reset(sample);
    Eigen::VectorXd u(q.size());
    law.update(sample, u);
    return u;
  }
};

std::vector<std::unique_ptr<Controller>> controllers(const Arm& arm) {
  const auto joints = static_cast<std::size_t>(arm.chain->joints());
  LmDesign inverse;
  inverse.form = LmForm::sugihara;
  inverse.damping = 1e-4;
  const PathDesign path{Positioning::workspace, std::vector<Pfc>(joints), {}, {}, {}, {}};
  std::vector<std::unique_ptr<Controller>> all;
  for (const WorkspaceLaw law : {WorkspaceLaw::hpfc, WorkspaceLaw::drac}) {
    all.push_back(std::make_unique<WorkspaceControl>(arm, WorkspaceControlDesign{.law = law}));
  }
  all.push_back(std::make_unique<ImplicitForcePfc>(
      arm, ImplicitForcePfcDesign{std::vector<Pfc>(joints), inverse, Positioning::workspace}));
  all.push_back(std::make_unique<EnergyAdmittance>(arm, EnergyAdmittanceDesign{path, {}}));
  SoftContactDesign soft;
  soft.path = path;
  all.push_back(std::make_unique<SoftContact>(arm, soft));
  return all;
}

SpatialJoint link_after(double length_m, const Eigen::Vector3d& axis) {
  SpatialJoint joint;
  joint.frame.translation().x() = length_m;
  joint.axis = axis;
  return joint;
}

TEST(SpatialArm, OfParallelHingesIsThePlanarArm) {
  const PlanarChain planar = load_planar_chain(testing::source_file("models/arm.urdf"));
  const double bend = std::acos(0.625);
  const Eigen::Vector3d start(bend, -2.0 * bend, bend);
  std::vector<SpatialJoint> joints;
  for (const double length_m : {0.0, 0.2, 0.2}) {
    joints.push_back(link_after(length_m, Eigen::Vector3d::UnitZ()));
  }
  Arm flat(planar, start, 20.0);
  Arm space(TipChain(std::make_shared<SpatialChain>(joints, link_after(0.2, {0, 0, 1}).frame,
                                                    Eigen::Isometry3d::Identity(), start)),
            start, 20.0);
  const auto of_plane = controllers(flat), of_space = controllers(space);
  testing::Random random;
  for (int k = 0; k < 50; ++k) {
    const Eigen::VectorXd q = start + random.vector(3, 0.1), dq = random.vector(3, 0.5);
    const double force_N = random.uniform(0.0, 4.0);
    for (std::size_t i = 0; i < of_plane.size(); ++i) {
      const Eigen::VectorXd u = flat.torque(*of_plane[i], q, dq, force_N, k * kPeriod);
      EXPECT_LT((space.torque(*of_space[i], q, dq, force_N, k * kPeriod) - u).norm(),
                1e-9 * (1.0 + u.norm()));
    }
  }
}

// With M_n the path controllers keep the torques within their limits.
TEST(SpatialArm, CoupledJointsKeepTheirLimits) {
  testing::Random random;
  std::vector<SpatialJoint> joints;
  for (int i = 0; i < 7; ++i) {
    joints.push_back(link_after(i == 0 ? 0.0 : 0.2, random.vector(3).normalized()));
  }
  const Eigen::VectorXd start = random.vector(7);
  Arm arm(TipChain(std::make_shared<SpatialChain>(joints, link_after(0.2, {0, 0, 1}).frame,
                                                  Eigen::Isometry3d::Identity(), start)),
          start, 2.0);
  const Eigen::MatrixXd root = random.matrix(7, 7);
  arm.acceleration.nominal_mass_matrix_kgm2 =
      root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(7, 7);
  arm.task.k_posture = 0.0;
  const PathDesign path{Positioning::workspace, std::vector<Pfc>(7), {}, {}, {}, {}};
  EnergyAdmittance law(arm, EnergyAdmittanceDesign{path, {}});
  for (int k = 0; k < 200; ++k) {
    const Eigen::VectorXd u =
        arm.torque(law, start + random.vector(7, 0.2), random.vector(7), 0.0, k * kPeriod);
    const Eigen::VectorXd a = testing::signal(law, "ddq_ref_rad_s2");
    // M a is the torque: nothing disturbs the joints.
    EXPECT_LT((u - arm.acceleration.nominal_mass_matrix_kgm2 * a).norm(), 1e-9);
  }
}

// Seven joints return to their start angles, and the tip does not notice.
TEST(SpatialArm, PostureMovesWithoutTheTip) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  std::vector<SpatialJoint> joints;
  for (const Eigen::Vector3d& axis : {z, y, z, Eigen::Vector3d(-y), z, y, z}) {
    SpatialJoint joint;
    joint.frame.translation().z() = joints.empty() ? 0.0 : 0.18;
    joint.axis = axis;
    joints.push_back(joint);
  }
  SpatialJoint flange;
  flange.frame.translation().z() = 0.1;
  Eigen::VectorXd start(7);
  start << 0.1, 0.4, 0.0, -1.5, 0.2, -0.6, 0.0;
  const auto chain =
      std::make_shared<SpatialChain>(joints, flange.frame, Eigen::Isometry3d::Identity(), start);
  Arm arm(TipChain(chain), start, 1e6);
  // Another posture with the same tip: along the null space, and back to the tip by Newton's
  // method.
  Eigen::VectorXd q = start;
  TaskJacobian J(6, 7);
  for (int k = 0; k < 400; ++k) {
    chain->tip_jacobian(q, J);
    const Eigen::MatrixXd pinv = J.completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::VectorXd along = (Eigen::MatrixXd::Identity(7, 7) - pinv * J).col(2);
    q += (k < 200 ? 2e-3 : 0.0) * along.normalized() - pinv * chain->tip_pose(q);
    q += pinv * arm.task.start_pose;
  }
  const double away = (q - start).norm();
  ASSERT_GT(away, 0.1);
  ASSERT_LT((chain->tip_pose(q) - arm.task.start_pose).norm(), 1e-12);
  arm.task.force_control_from_s = 1e9;
  WorkspaceControl law(arm, {});
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(7);
  constexpr double h = 1e-4;
  double largest = 0.0;
  for (int k = 0; k < 30000; ++k) {
    // The midpoint rule: Euler's would add an error of the order of h.
    const Eigen::VectorXd half_q = q + 0.5 * h * dq;
    const Eigen::VectorXd half_dq = dq + 0.5 * h * arm.torque(law, q, dq, 0.0, k * h);
    q += h * half_dq;
    dq += h * arm.torque(law, half_q, half_dq, 0.0, (k + 0.5) * h);
    largest = std::max(largest, (chain->tip_pose(q) - arm.task.start_pose).norm());
  }
  EXPECT_LT((q - start).norm(), 1e-3 * away);
  EXPECT_LT(largest, 1e-6);
}

}  // namespace
}  // namespace breakwater::spatial_arm_test
