// A manipulator as its controllers know it, and SpatialChain: a manipulator in space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/plants/planar_chain.h>

namespace breakwater {

/// A manipulator as its controllers know it. Copies share the kinematics.
struct TipChain : std::shared_ptr<const TipKinematics> {
  using shared_ptr::shared_ptr;
  /// The planar chain with its tip's x, y and φ.
  TipChain(const PlanarChain& chain)  // NOLINT(google-explicit-constructor): it is such a chain
      : shared_ptr(std::make_shared<PlanarChain>(chain)) {}
};

/// A hinge or slide and the link that it moves.
struct SpatialJoint {
  /// The link's frame in that of the link before it, at the position `zero`.
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();     ///< a unit vector in the link's frame
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();  ///< a point of the axis, there
  bool slides = false;
  double zero = 0.0;  ///< [rad or m]
  double effort_limit = 0.0;
};

/// The tip of a chain of joints in a contact frame: x along the force, y and z across it. Its
/// coordinates there are its position x, y, z [m] and the rotation vector rx, ry, rz from its
/// orientation at the start [rad]. The Jacobian is taken at no rotation. It holds, in this order,
/// all that its joints can move independently. A two-link holds x and y; a SCARA x, y, z and the
/// turn about its axes; six joints hold all. The
/// rotation must stay below half a turn. The velocity limits are infinite.
class SpatialChain final : public TipKinematics {
 public:
  /// `tip` is in the last link's frame, `contact` in the world. Throws std::invalid_argument if
  /// there is no joint, or if the tip cannot move along x.
  SpatialChain(std::vector<SpatialJoint> joints, const Eigen::Isometry3d& tip,
               const Eigen::Isometry3d& contact, const Eigen::VectorXd& start_angles_rad);

  TipVector tip_pose(const Angles& q_rad) const override;
  void tip_jacobian(const Angles& q_rad, TaskJacobian& J) const override;
  TipVector tip_bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const override;

 private:
  template <typename Visit>
  Eigen::Isometry3d walk(const Angles& q_rad, Visit&& visit) const;
  TipVector held_of(const Eigen::Vector3d& position, const Eigen::Vector3d& turn) const;

  std::vector<SpatialJoint> joints_;
  Eigen::Isometry3d tip_;
  Eigen::Isometry3d to_contact_;  // from the world
  Eigen::Matrix3d start_;         // the tip's orientation
  std::vector<int> rows_;         // the held ones among the six coordinates
};

}  // namespace breakwater
