// Chains in space, against KDL and planar chains.
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include <breakwater/plants/tip_chain.h>
#include "kdl_support.h"
#include "support.h"

namespace breakwater::spatial_chain_test {
namespace {

Eigen::Isometry3d random_frame(testing::Random& random) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() = Eigen::Quaterniond(Eigen::Vector4d(random.vector(4)).normalized()).matrix();
  frame.translation() = random.vector(3);
  return frame;
}

using testing::to_kdl;

TEST(SpatialChain, AgreesWithKdl) {
  testing::Random random;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 6 + trial % 3;
    std::vector<SpatialJoint> joints;
    KDL::Chain kdl;
    for (int i = 0; i < n; ++i) {
      SpatialJoint joint;
      joint.frame = random_frame(random);
      joint.axis = Eigen::Vector3d(random.vector(3)).normalized();
      joint.anchor_m = random.vector(3);
      joint.slides = i % 3 == 2;
      joints.push_back(joint);
      testing::add_joint(kdl, joint);
    }
    const Eigen::Isometry3d tip = random_frame(random), contact = random_frame(random);
    kdl.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(tip)));
    const Eigen::VectorXd start = random.vector(n), dq = random.vector(n, 3.0);
    const Eigen::VectorXd q = start + random.vector(n, 0.3);
    const SpatialChain ours(joints, tip, contact, start);
    ASSERT_EQ(ours.coordinates.size(), 6u);
    const Eigen::Matrix3d to_contact = contact.linear().transpose();

    KDL::Frame at_start, now;
    KDL::ChainFkSolverPos_recursive fk(kdl);
    ASSERT_EQ(fk.JntToCart(to_kdl(start), at_start), 0);
    ASSERT_EQ(fk.JntToCart(to_kdl(q), now), 0);
    const KDL::Vector turn = KDL::diff(at_start.M, now.M);
    const TipVector X = ours.tip_pose(q);
    EXPECT_LT(
        (X.head<3>() - contact.inverse() * Eigen::Vector3d(now.p.x(), now.p.y(), now.p.z())).norm(),
        1e-12);
    EXPECT_LT((X.tail<3>() - to_contact * Eigen::Vector3d(turn.x(), turn.y(), turn.z())).norm(),
              1e-12);
    EXPECT_LT(ours.tip_pose(start).tail<3>().norm(), 1e-14);

    KDL::Jacobian kdl_J(static_cast<unsigned>(n));
    KDL::ChainJntToJacSolver jacobian(kdl);
    ASSERT_EQ(jacobian.JntToJac(to_kdl(q), kdl_J), 0);
    TaskJacobian J(6, n);
    ours.tip_jacobian(q, J);
    EXPECT_LT((J.topRows<3>() - to_contact * kdl_J.data.topRows<3>()).norm(), 1e-12);
    EXPECT_LT((J.bottomRows<3>() - to_contact * kdl_J.data.bottomRows<3>()).norm(), 1e-12);

    KDL::Twist bias;
    KDL::ChainJntToJacDotSolver jacobian_rate(kdl);
    ASSERT_EQ(jacobian_rate.JntToJacDot(KDL::JntArrayVel(to_kdl(q), to_kdl(dq)), bias), 0);
    const TipVector change = ours.tip_bias_acceleration(q, dq);
    EXPECT_LT(
        (change.head<3>() - to_contact * Eigen::Vector3d(bias.vel.x(), bias.vel.y(), bias.vel.z()))
            .norm(),
        1e-10);
    EXPECT_LT(
        (change.tail<3>() - to_contact * Eigen::Vector3d(bias.rot.x(), bias.rot.y(), bias.rot.z()))
            .norm(),
        1e-10);
  }
}

SpatialJoint hinge_after(double link_m) {
  SpatialJoint joint;
  joint.frame.translation().x() = link_m;
  return joint;
}

std::string held(const std::vector<SpatialJoint>& joints) {
  const auto n = static_cast<Eigen::Index>(joints.size());
  const SpatialChain chain(joints, hinge_after(0.3).frame, Eigen::Isometry3d::Identity(),
                           Eigen::VectorXd::Zero(n));
  std::string names;
  for (const TipCoordinate& one : chain.coordinates) names += one.name + " ";
  return names;
}

TEST(SpatialChain, HoldsWhatItsJointsCanMove) {
  std::vector<SpatialJoint> joints = {hinge_after(0.0), hinge_after(0.3)};
  EXPECT_EQ(held(joints), "x y ");  // stretched, where the tip cannot move along x
  joints.push_back(hinge_after(0.3));
  EXPECT_EQ(held(joints), "x y rz ");
  joints.push_back(hinge_after(0.3));
  EXPECT_EQ(held(joints), "x y rz ");
  joints.push_back(hinge_after(0.0));
  joints.back().slides = true;
  EXPECT_EQ(held(joints), "x y z rz ");
  SpatialJoint up = hinge_after(0.0);
  up.slides = true;
  EXPECT_REFUSED(held({up}));
  EXPECT_REFUSED(held({}));
}

TEST(SpatialChain, OfParallelHingesIsAPlanarChain) {
  testing::Random random;
  std::vector<SpatialJoint> joints;
  std::vector<PlanarJoint> planar;
  for (const double link_m : {0.0, 0.2, 0.25}) {
    joints.push_back(hinge_after(link_m));
    planar.push_back({.name = "", .offset_m = {link_m, 0.0}});
  }
  const PlanarChain plane(planar, {0.3, 0.0}, 0.0);
  const Eigen::VectorXd start = random.vector(3);
  const SpatialChain space(joints, hinge_after(0.3).frame, Eigen::Isometry3d::Identity(), start);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd q = start + random.vector(3, 0.4), dq = random.vector(3);
    TipPose moved = plane.tip_pose(q);
    moved.z() -= plane.tip_pose(start).z();
    EXPECT_LT((space.tip_pose(q) - moved).norm(), 1e-13);
    TaskJacobian flat(3, plane.joints());
    plane.tip_jacobian(q, flat);
    TaskJacobian J(3, 3);
    space.tip_jacobian(q, J);
    EXPECT_LT((J - flat).norm(), 1e-13);
    EXPECT_LT((space.tip_bias_acceleration(q, dq) - plane.tip_bias_acceleration(q, dq)).norm(),
              1e-13);
  }
}

}  // namespace
}  // namespace breakwater::spatial_chain_test
