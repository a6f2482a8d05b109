#include <breakwater/plants/planar_chain.h>

#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "support.h"

namespace breakwater {
namespace {

// A random chain, and the same chain in KDL as a second implementation.
struct RandomChain {
  PlanarChain ours;
  KDL::Chain kdl;
};

RandomChain random_chain(testing::Random& random, int n) {
  std::vector<PlanarJoint> joints;
  KDL::Chain kdl;
  for (int i = 0; i < n; ++i) {
    PlanarJoint joint;
    joint.name = "joint" + std::to_string(i);
    joint.offset_m = random.vector(2);
    joint.yaw_rad = random.uniform(-3, 3);
    joint.sense = random.uniform(-1, 1) > 0 ? 1.0 : -1.0;
    joint.effort_limit_Nm = joint.velocity_limit_rad_s = 1.0;
    joint.link_mass_kg = random.uniform(0.1, 2);
    joint.link_com_m = random.vector(2);
    joint.link_inertia_kgm2 = random.uniform(0.01, 1);
    joints.push_back(joint);
    // KDL: a fixed frame up to the joint, then the joint with its link's inertia.
    kdl.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::None),
                     KDL::Frame(KDL::Rotation::RotZ(joint.yaw_rad),
                                KDL::Vector(joint.offset_m.x(), joint.offset_m.y(), 0))));
    const KDL::RotationalInertia inertia(0.1, 0.1, joint.link_inertia_kgm2);
    kdl.addSegment(KDL::Segment(
        KDL::Joint(KDL::Vector(0, 0, 0), KDL::Vector(0, 0, joint.sense), KDL::Joint::RotAxis),
        KDL::Frame::Identity(),
        KDL::RigidBodyInertia(joint.link_mass_kg,
                              KDL::Vector(joint.link_com_m.x(), joint.link_com_m.y(), 0),
                              inertia)));
  }
  const Eigen::Vector2d tip = random.vector(2);
  const double tip_yaw = random.uniform(-3, 3);
  kdl.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::None),
                   KDL::Frame(KDL::Rotation::RotZ(tip_yaw), KDL::Vector(tip.x(), tip.y(), 0))));
  return {PlanarChain(joints, tip, tip_yaw), kdl};
}

KDL::JntArray to_kdl(const Eigen::VectorXd& q) {
  KDL::JntArray array(static_cast<unsigned>(q.size()));
  array.data = q;
  return array;
}

TEST(PlanarChain, AgreesWithKdl) {
  testing::Random random;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 1 + trial % 6;
    const RandomChain chain = random_chain(random, n);
    const Eigen::VectorXd q = random.vector(n, 3.0);
    const Eigen::VectorXd dq = random.vector(n, 3.0);

    KDL::Frame tip;
    KDL::ChainFkSolverPos_recursive fk(chain.kdl);
    ASSERT_EQ(fk.JntToCart(to_kdl(q), tip), 0);
    const TipPose X = chain.ours.tip_pose(q);
    EXPECT_NEAR(X[0], tip.p.x(), 1e-13);
    EXPECT_NEAR(X[1], tip.p.y(), 1e-13);
    double roll, pitch, yaw;
    tip.M.GetRPY(roll, pitch, yaw);
    EXPECT_NEAR(std::remainder(X[2] - yaw, 2 * M_PI), 0.0, 1e-12);

    KDL::Jacobian kdl_J(static_cast<unsigned>(n));
    KDL::ChainJntToJacSolver jacobian(chain.kdl);
    ASSERT_EQ(jacobian.JntToJac(to_kdl(q), kdl_J), 0);
    TipJacobian J;
    chain.ours.tip_jacobian(q, J);
    EXPECT_LT((J.topRows(2) - kdl_J.data.topRows(2)).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((J.row(2) - kdl_J.data.row(5)).cwiseAbs().maxCoeff(), 1e-13);

    KDL::Twist bias;
    KDL::ChainJntToJacDotSolver jacobian_rate(chain.kdl);
    ASSERT_EQ(jacobian_rate.JntToJacDot(KDL::JntArrayVel(to_kdl(q), to_kdl(dq)), bias), 0);
    const TipPose ours = chain.ours.tip_bias_acceleration(q, dq);
    EXPECT_NEAR(ours[0], bias.vel.x(), 1e-11);
    EXPECT_NEAR(ours[1], bias.vel.y(), 1e-11);
    EXPECT_NEAR(ours[2], 0.0, 1e-12);

    KDL::JntSpaceInertiaMatrix kdl_M(static_cast<unsigned>(n));
    KDL::ChainDynParam dynamics(chain.kdl, KDL::Vector::Zero());
    ASSERT_EQ(dynamics.JntToMass(to_kdl(q), kdl_M), 0);
    EXPECT_TRUE(chain.ours.mass_matrix(q).isApprox(kdl_M.data, 1e-12));
  }
}

TEST(PlanarChain, ThesisArmMatchesEq251) {
  const PlanarChain arm = load_planar_chain(testing::source_file("models/arm.urdf"));
  ASSERT_EQ(arm.joints(), 3);
  const Eigen::Vector3d q(0.3, -0.7, 1.1);
  const double L = 0.2;
  EXPECT_NEAR(arm.tip_pose(q)[0], L * (std::cos(0.3) + std::cos(-0.4) + std::cos(0.7)), 1e-15);
  EXPECT_NEAR(arm.tip_pose(q)[1], L * (std::sin(0.3) + std::sin(-0.4) + std::sin(0.7)), 1e-15);
  EXPECT_NEAR(arm.tip_pose(q)[2], 0.7, 1e-15);
  EXPECT_EQ(arm.effort_limits_Nm(), Eigen::Vector3d(20.7360, 20.7360, 12.6720));
  EXPECT_NEAR(arm.velocity_limits_rad_s()(0), M_PI, 1e-12);
  double mass = 0;
  for (int i = 0; i < 3; ++i) mass += arm.joint(i).link_mass_kg;
  EXPECT_NEAR(mass, 3 * 0.22 + 2 * 0.77, 1e-12);
}

TEST(PlanarChain, RefusesNonsense) {
  EXPECT_THROW(PlanarChain({}, {0, 0}, 0), std::invalid_argument);
  PlanarJoint joint;
  joint.link_mass_kg = std::nan("");
  EXPECT_THROW(PlanarChain({joint}, {0, 0}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
