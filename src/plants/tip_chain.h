// Kinematics of a serial manipulator, in the coordinates of its tip that a controller holds.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/plants/planar_chain.h>

namespace breakwater {

/// A value for each held coordinate of the tip, c of them. X = [x y φ]ᵀ of a planar arm (Eq. 2.51).
using TipVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// The Jacobian of the held coordinates with respect to q, c×n (Eq. 2.52).
using TaskJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, Eigen::Dynamic>;

/// A held coordinate of the tip.
struct TipCoordinate {
  std::string name;     ///< "x": the signals are x_hat_m and x_ref_m
  std::string unit;     ///< "m" or "rad"
  std::string meaning;  ///< "tip x"
};

/// The kinematics of a chain of n joints. It is constant. No function allocates.
class TipKinematics {
 public:
  using Angles = Eigen::Ref<const Eigen::VectorXd>;

  virtual ~TipKinematics() = default;

  /// X(q) (c). The first coordinate is the one along which the tip presses.
  virtual TipVector pose(const Angles& q_rad) const = 0;
  /// J(q) (c×n), which must have its size.
  virtual void jacobian(const Angles& q_rad, TaskJacobian& J) const = 0;
  /// J̇(q, q̇) q̇ (c), the tip's acceleration at q̈ = 0.
  virtual TipVector bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const = 0;

  /// The chain, if this is one.
  virtual const PlanarChain* planar() const { return nullptr; }

  std::vector<TipCoordinate> coordinates;  ///< c of them
  Eigen::VectorXd effort_limits_Nm;        ///< n
  Eigen::VectorXd velocity_limits_rad_s;   ///< n
};

/// A manipulator as its controllers know it. Copies share the kinematics.
class TipChain {
 public:
  using Angles = TipKinematics::Angles;

  /// The planar chain with its tip's x, y and φ.
  TipChain(const PlanarChain& chain);  // NOLINT(google-explicit-constructor): it is such a chain
  explicit TipChain(std::shared_ptr<const TipKinematics> kinematics)
      : kinematics_(std::move(kinematics)) {}

  Eigen::Index joints() const { return effort_limits_Nm().size(); }
  Eigen::Index held() const { return static_cast<Eigen::Index>(coordinates().size()); }
  const std::vector<TipCoordinate>& coordinates() const { return kinematics_->coordinates; }
  const Eigen::VectorXd& effort_limits_Nm() const { return kinematics_->effort_limits_Nm; }
  const Eigen::VectorXd& velocity_limits_rad_s() const {
    return kinematics_->velocity_limits_rad_s;
  }

  /// The planar chain of which this was made; null: it was not.
  const PlanarChain* planar() const { return kinematics_->planar(); }

  TipVector tip_pose(const Angles& q_rad) const { return kinematics_->pose(q_rad); }
  void tip_jacobian(const Angles& q_rad, TaskJacobian& J) const { kinematics_->jacobian(q_rad, J); }
  TipVector tip_bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const {
    return kinematics_->bias_acceleration(q_rad, dq_rad_s);
  }

 private:
  std::shared_ptr<const TipKinematics> kinematics_;
};

}  // namespace breakwater
