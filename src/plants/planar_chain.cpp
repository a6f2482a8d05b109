#include <breakwater/plants/planar_chain.h>

#include <Eigen/Geometry>
#include <stdexcept>
#include <utility>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

Eigen::Vector2d rotate(double angle_rad, const Eigen::Vector2d& v) {
  const auto [s, c] = math::sincos(angle_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

// z × v
Eigen::Vector2d perpendicular(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

}  // namespace

std::string TipKinematics::names() const {
  std::string names;
  for (const TipCoordinate& one : coordinates) names += (names.empty() ? "" : ", ") + one.name;
  return names;
}

PlanarChain::PlanarChain(std::vector<PlanarJoint> joints, const Eigen::Vector2d& tip_offset_m,
                         double tip_yaw_rad)
    : joints_(std::move(joints)), tip_offset_(tip_offset_m), tip_yaw_(tip_yaw_rad) {
  if (joints_.empty()) throw std::invalid_argument("planar chain: needs at least one joint");
  coordinates = {{"x", "m", "tip x"}, {"y", "m", "tip y"}, {"phi", "rad", "tip angle"}};
  const auto n = static_cast<Eigen::Index>(joints_.size());
  effort_limits_.resize(n);
  velocity_limits_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    effort_limits_(i) = joint(i).effort_limit_Nm;
    velocity_limits_(i) = joint(i).velocity_limit_rad_s;
  }
}

TipVector PlanarChain::tip_pose(const Angles& q_rad) const {
  double angle = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < joints(); ++i) {
    position += rotate(angle, joint(i).offset_m);
    angle += joint(i).yaw_rad + joint(i).sense * q_rad(i);
  }
  position += rotate(angle, tip_offset_);
  return TipPose(position.x(), position.y(), angle + tip_yaw_);
}

void PlanarChain::tip_jacobian(const Angles& q_rad, TaskJacobian& J) const {
  // Computes the joints' positions, then each column sense·[z × (tip − joint); 1].
  double angle = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < joints(); ++i) {
    position += rotate(angle, joint(i).offset_m);
    angle += joint(i).yaw_rad + joint(i).sense * q_rad(i);
    J.col(i).head<2>() = position;
  }
  position += rotate(angle, tip_offset_);
  for (Eigen::Index i = 0; i < joints(); ++i) {
    const Eigen::Vector2d arm = position - J.col(i).head<2>();
    J.col(i) << joint(i).sense * perpendicular(arm), joint(i).sense;
  }
}

TipVector PlanarChain::tip_bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const {
  // A point fixed in a link with the rate ω has the centripetal acceleration −ω² r.
  double angle = 0.0;
  double rate = 0.0;
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < joints(); ++i) {
    acceleration -= rate * rate * rotate(angle, joint(i).offset_m);
    angle += joint(i).yaw_rad + joint(i).sense * q_rad(i);
    rate += joint(i).sense * dq_rad_s(i);
  }
  acceleration -= rate * rate * rotate(angle, tip_offset_);
  return TipPose(acceleration.x(), acceleration.y(), 0.0);
}

Eigen::MatrixXd PlanarChain::mass_matrix(const Angles& q_rad) const {
  // The sum of m J_comᵀ J_com + I j_φᵀ j_φ over all links.
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(joints(), joints());
  Eigen::Matrix2Xd joint_positions(2, joints());
  Eigen::Matrix2Xd J_com = Eigen::Matrix2Xd::Zero(2, joints());
  Eigen::RowVectorXd j_phi = Eigen::RowVectorXd::Zero(joints());
  double angle = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < joints(); ++i) {
    position += rotate(angle, joint(i).offset_m);
    angle += joint(i).yaw_rad + joint(i).sense * q_rad(i);
    joint_positions.col(i) = position;
    j_phi(i) = joint(i).sense;
    const Eigen::Vector2d com = position + rotate(angle, joint(i).link_com_m);
    for (Eigen::Index j = 0; j <= i; ++j) {
      J_com.col(j) = joint(j).sense * perpendicular(com - joint_positions.col(j));
    }
    M += joint(i).link_mass_kg * J_com.transpose() * J_com +
         joint(i).link_inertia_kgm2 * j_phi.transpose() * j_phi;
  }
  return M;
}

}  // namespace breakwater
