// The engine's dynamics of spatial arms and our kinematics of their tips, against KDL.
#include <mujoco/mujoco.h>

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <breakwater/plants/tip_chain.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/model.h>
#include "kdl_support.h"
#include "support.h"

namespace breakwater::arm_dynamics_test {
namespace {

Eigen::Isometry3d frame_of(const mjtNum* position, const mjtNum* quaternion) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() =
      Eigen::Quaterniond(quaternion[0], quaternion[1], quaternion[2], quaternion[3]).matrix();
  frame.translation() = Eigen::Map<const Eigen::Vector3d>(position);
  return frame;
}

// The inertia of a body and of what is fixed to it, in the body's frame.
KDL::RigidBodyInertia inertia_of(const mjModel& m, int body) {
  const Eigen::Isometry3d axes = frame_of(m.body_ipos + 3 * body, m.body_iquat + 4 * body);
  const mjtNum* moments = m.body_inertia + 3 * body;
  KDL::RigidBodyInertia inertia =
      testing::to_kdl(axes) *
      KDL::RigidBodyInertia(m.body_mass[body], KDL::Vector::Zero(),
                            KDL::RotationalInertia(moments[0], moments[1], moments[2]));
  for (int other = body + 1; other < m.nbody; ++other) {
    if (m.body_parentid[other] != body || m.body_jntnum[other] > 0) continue;
    inertia = inertia + testing::to_kdl(frame_of(m.body_pos + 3 * other, m.body_quat + 4 * other)) *
                            inertia_of(m, other);
  }
  return inertia;
}

struct Arm {
  KDL::Chain kdl;
  std::vector<SpatialJoint> joints;
  int tip = 0;  // the last body that a joint moves
};

Arm arm_of(const mjModel& m) {
  Arm arm;
  Eigen::Isometry3d fixed = Eigen::Isometry3d::Identity();
  for (int body = 1; body < m.nbody; ++body) {
    if (m.body_weldid[body] == 0 && m.body_parentid[body] == 0) {
      fixed = frame_of(m.body_pos + 3 * body, m.body_quat + 4 * body);
    }
    if (m.body_jntnum[body] == 0) continue;
    const int joint = m.body_jntadr[body];
    SpatialJoint next;
    next.frame = frame_of(m.body_pos + 3 * body, m.body_quat + 4 * body);
    if (arm.joints.empty() && m.body_parentid[body] != 0) next.frame = fixed * next.frame;
    next.axis = Eigen::Map<const Eigen::Vector3d>(m.jnt_axis + 3 * joint);
    next.anchor_m = Eigen::Map<const Eigen::Vector3d>(m.jnt_pos + 3 * joint);
    arm.joints.push_back(next);
    testing::add_joint(arm.kdl, next, inertia_of(m, body));
    arm.tip = body;
  }
  return arm;
}

class ArmDynamics : public ::testing::TestWithParam<const char*> {};

TEST_P(ArmDynamics, AgreeWithKdl) {
  const std::string file = testing::source_file(GetParam());
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << ": no public model file here";
  const Model model = Model::load(file);
  const mjModel& m = *model.get();
  const int n = m.nv;
  const Arm arm = arm_of(m);
  ASSERT_EQ(arm.joints.size(), static_cast<std::size_t>(n));
  KDL::ChainDynParam dynamics(arm.kdl, testing::to_kdl(Eigen::Vector3d(m.opt.gravity)));
  KDL::ChainJntToJacSolver jacobian(arm.kdl);
  const SpatialChain ours(arm.joints, Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity(),
                          Eigen::VectorXd::Constant(n, 0.3));
  ASSERT_EQ(ours.coordinates.size(), static_cast<std::size_t>(std::min(n, 6)));
  const Eigen::Map<const Eigen::VectorXd> armature(m.dof_armature, n);
  const DataPointer data = model.make_data();
  const unsigned size = static_cast<unsigned>(n);
  testing::Random random;
  for (int state = 0; state < 100; ++state) {
    const Eigen::VectorXd q = random.vector(n, 2.0), dq = random.vector(n, 3.0);
    Eigen::Map<Eigen::VectorXd>(data->qpos, n) = q;
    Eigen::Map<Eigen::VectorXd>(data->qvel, n) = dq;
    mj_forward(&m, data.get());

    KDL::JntSpaceInertiaMatrix M(size);
    ASSERT_EQ(dynamics.JntToMass(testing::to_kdl(q), M), 0);
    const Eigen::MatrixXd expected = M.data + Eigen::MatrixXd(armature.asDiagonal());
    EXPECT_LT((joint_inertia(model, {q.data(), size}) - expected).norm(), 1e-9 * expected.norm());

    KDL::JntArray gravity(size), coriolis(size);
    ASSERT_EQ(dynamics.JntToGravity(testing::to_kdl(q), gravity), 0);
    ASSERT_EQ(dynamics.JntToCoriolis(testing::to_kdl(q), testing::to_kdl(dq), coriolis), 0);
    const Eigen::VectorXd bias = gravity.data + coriolis.data;
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(data->qfrc_bias, n) - bias).norm(), 1e-9 * bias.norm());

    KDL::Jacobian J(size);
    ASSERT_EQ(jacobian.JntToJac(testing::to_kdl(q), J), 0);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> theirs(6, n);
    mj_jacBody(&m, data.get(), theirs.data(), theirs.data() + 3 * n, arm.tip);
    EXPECT_LT((theirs - J.data).norm(), 1e-9 * J.data.norm());
    TaskJacobian own(6, n);
    ours.tip_jacobian(q, own);
    EXPECT_LT((own - J.data).norm(), 1e-9 * J.data.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, ArmDynamics,
                         ::testing::Values("models/robot.xml", "../shared/robots/iiwa14.xml",
                                           "../shared/robots/panda_nohand.xml",
                                           "../shared/robots/ur5e.xml",
                                           "../shared/robots/xarm7_nohand.xml"),
                         [](const auto& one) {
                           return std::filesystem::path(one.param).stem().string();
                         });

}  // namespace
}  // namespace breakwater::arm_dynamics_test
