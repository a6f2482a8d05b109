#include <limits>
#include <stdexcept>
#include <utility>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/plants/tip_chain.h>

namespace breakwater {
namespace {

// Smallest part of a row beyond the rows before it, over the largest row of its kind: files round
// right angles.
constexpr double kIndependent = 1e-3;

Eigen::Matrix3d turn_about(const Eigen::Vector3d& axis, double angle_rad) {
  const auto [s, c] = math::sincos(angle_rad);
  Eigen::Matrix3d cross;
  cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return c * Eigen::Matrix3d::Identity() + s * cross + (1.0 - c) * axis * axis.transpose();
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double sine = 0.5 * twice_sine.norm();
  if (sine == 0.0) return 0.5 * twice_sine;
  return math::atan2(sine, 0.5 * (R.trace() - 1.0)) / (2.0 * sine) * twice_sine;
}

}  // namespace

SpatialChain::SpatialChain(std::vector<SpatialJoint> joints, const Eigen::Isometry3d& tip,
                           const Eigen::Isometry3d& contact,
                           const Eigen::VectorXd& start_angles_rad)
    : joints_(std::move(joints)), tip_(tip), to_contact_(contact.inverse()) {
  const auto n = static_cast<Eigen::Index>(joints_.size());
  if (n == 0) throw std::invalid_argument("no joint moves the tip");
  refuse_unless(start_angles_rad.size() == n, "spatial chain: needs a start angle for each joint");
  effort_limits_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    effort_limits_(i) = joints_[static_cast<std::size_t>(i)].effort_limit;
  }
  velocity_limits_ = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  start_ = walk(start_angles_rad, [](auto&&...) {}).linear();

  // Gram and Schmidt at a posture near the start, which may be singular.
  rows_ = {0, 1, 2, 3, 4, 5};
  TaskJacobian rest(6, n);
  tip_jacobian(start_angles_rad + Eigen::VectorXd::LinSpaced(n, 0.1, 0.2), rest);
  rows_.clear();
  const double position = rest.topRows<3>().rowwise().norm().maxCoeff();
  const double turn = rest.bottomRows<3>().rowwise().norm().maxCoeff();
  const char* const names[] = {"x", "y", "z", "rx", "ry", "rz"};
  const char* const meanings[] = {"tip along the force",     "tip across the force, y",
                                  "tip across the force, z", "turn of the tip about x",
                                  "turn of the tip about y", "turn of the tip about z"};
  for (int row = 0; row < 6 && static_cast<Eigen::Index>(rows_.size()) < n; ++row) {
    const double length = rest.row(row).norm();
    if (!(length > kIndependent * (row < 3 ? position : turn))) continue;
    rows_.push_back(row);
    coordinates.push_back({names[row], row < 3 ? "m" : "rad", meanings[row]});
    const Eigen::RowVectorXd direction = rest.row(row) / length;
    for (int other = row + 1; other < 6; ++other) {
      rest.row(other) -= rest.row(other).dot(direction) * direction;
    }
  }
  refuse_unless(!rows_.empty() && rows_.front() == 0, "no joint moves the tip along the force");
}

// Visits each joint with its axis and a point of it in the world. Returns the tip.
template <typename Visit>
Eigen::Isometry3d SpatialChain::walk(const Angles& q_rad, Visit&& visit) const {
  Eigen::Isometry3d link = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const SpatialJoint& joint = joints_[i];
    const double moved = q_rad(static_cast<Eigen::Index>(i)) - joint.zero;
    link = link * joint.frame;
    const Eigen::Vector3d axis = link.linear() * joint.axis;
    if (joint.slides) {
      link.translation() += moved * axis;
      visit(i, axis, Eigen::Vector3d(link * joint.anchor_m));
    } else {
      const Eigen::Vector3d anchor = link * joint.anchor_m;
      link.linear() = link.linear() * turn_about(joint.axis, moved);
      link.translation() = anchor - link.linear() * joint.anchor_m;
      visit(i, axis, anchor);
    }
  }
  return link * tip_;
}

TipVector SpatialChain::held_of(const Eigen::Vector3d& position,
                                const Eigen::Vector3d& turn) const {
  TipVector held(static_cast<Eigen::Index>(rows_.size()));
  for (Eigen::Index i = 0; i < held.size(); ++i) {
    const int row = rows_[static_cast<std::size_t>(i)];
    held(i) = row < 3 ? position(row) : turn(row - 3);
  }
  return held;
}

TipVector SpatialChain::tip_pose(const Angles& q_rad) const {
  const Eigen::Isometry3d tip = walk(q_rad, [](auto&&...) {});
  return held_of(to_contact_ * tip.translation(),
                 to_contact_.linear() * rotation_vector(tip.linear() * start_.transpose()));
}

void SpatialChain::tip_jacobian(const Angles& q_rad, TaskJacobian& J) const {
  const Eigen::Vector3d tip = walk(q_rad, [](auto&&...) {}).translation();
  walk(q_rad, [&](std::size_t i, const Eigen::Vector3d& axis, const Eigen::Vector3d& anchor) {
    const bool slides = joints_[i].slides;
    const Eigen::Vector3d moves = slides ? axis : axis.cross(tip - anchor);
    const Eigen::Vector3d turns = slides ? Eigen::Vector3d::Zero() : axis;
    J.col(static_cast<Eigen::Index>(i)) =
        held_of(to_contact_.linear() * moves, to_contact_.linear() * turns);
  });
}

TipVector SpatialChain::tip_bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const {
  // The point at which the links meet, its acceleration, and the rate of the link with it.
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), acceleration = point;
  Eigen::Vector3d rate = point, rate_change = point;
  const auto carry_to = [&](const Eigen::Vector3d& next) {
    const Eigen::Vector3d arm = next - point;
    acceleration += rate_change.cross(arm) + rate.cross(rate.cross(arm));
    point = next;
  };
  const Eigen::Isometry3d tip =
      walk(q_rad, [&](std::size_t i, const Eigen::Vector3d& axis, const Eigen::Vector3d& anchor) {
        const Eigen::Vector3d own = dq_rad_s(static_cast<Eigen::Index>(i)) * axis;
        carry_to(anchor);
        if (joints_[i].slides) {
          acceleration += 2.0 * rate.cross(own);
        } else {
          rate_change += rate.cross(own);
          rate += own;
        }
      });
  carry_to(tip.translation());
  return held_of(to_contact_.linear() * acceleration, to_contact_.linear() * rate_change);
}

}  // namespace breakwater
