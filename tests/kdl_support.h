// Chains of joints for KDL.
#pragma once

#include <kdl/chain.hpp>

#include <breakwater/plants/tip_chain.h>

namespace breakwater::testing {

inline KDL::Vector to_kdl(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

inline KDL::Frame to_kdl(const Eigen::Isometry3d& frame) {
  const auto R = frame.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          to_kdl(Eigen::Vector3d(frame.translation()))};
}

inline KDL::JntArray to_kdl(const Eigen::VectorXd& q) {
  KDL::JntArray array(static_cast<unsigned>(q.size()));
  array.data = q;
  return array;
}

/// A fixed frame up to the link, then the joint.
inline void add_joint(KDL::Chain& chain, const SpatialJoint& joint,
                      const KDL::RigidBodyInertia& inertia = KDL::RigidBodyInertia::Zero()) {
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), to_kdl(joint.frame)));
  chain.addSegment(
      KDL::Segment(KDL::Joint(to_kdl(joint.anchor_m), to_kdl(joint.axis),
                              joint.slides ? KDL::Joint::TransAxis : KDL::Joint::RotAxis),
                   KDL::Frame::Identity(), inertia));
}

}  // namespace breakwater::testing
