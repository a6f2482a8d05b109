// Kinematics of a serial manipulator in the coordinates of its tip that a controller holds.
// PlanarChain: the nominal model of a planar one.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace breakwater {

/// A task-space pose of the tip, X = [x y φ]ᵀ [m, m, rad] (Eq. 2.51).
using TipPose = Eigen::Vector3d;

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

class PlanarChain;

/// The kinematics of a chain of n joints. It is constant. No function allocates.
class TipKinematics {
 public:
  using Angles = Eigen::Ref<const Eigen::VectorXd>;

  virtual ~TipKinematics() = default;

  /// X(q) (c). The first coordinate is the one along which the tip presses.
  virtual TipVector tip_pose(const Angles& q_rad) const = 0;
  /// J(q) (c×n), which must have its size.
  virtual void tip_jacobian(const Angles& q_rad, TaskJacobian& J) const = 0;
  /// J̇(q, q̇) q̇ (c), the tip's acceleration at q̈ = 0.
  virtual TipVector tip_bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const = 0;

  Eigen::Index joints() const { return effort_limits_.size(); }                        ///< n
  Eigen::Index held() const { return static_cast<Eigen::Index>(coordinates.size()); }  ///< c
  /// The names of the coordinates: "x, y, phi".
  std::string names() const;

  /// The chain, if this is one.
  virtual const PlanarChain* planar() const { return nullptr; }

  const Eigen::VectorXd& effort_limits_Nm() const { return effort_limits_; }         ///< n
  const Eigen::VectorXd& velocity_limits_rad_s() const { return velocity_limits_; }  ///< n

  std::vector<TipCoordinate> coordinates;  ///< c of them

 protected:
  Eigen::VectorXd effort_limits_;
  Eigen::VectorXd velocity_limits_;
};

/// One revolute joint and the link that it moves, in the plane of motion.
struct PlanarJoint {
  std::string name;
  Eigen::Vector2d offset_m = {0, 0};  ///< position in the frame of the link before it
  double yaw_rad = 0.0;               ///< yaw of the link's frame at q = 0, in the frame before it
  double sense = 1.0;                 ///< +1 if the axis is normal to the plane, −1 if opposite
  double effort_limit_Nm = 0.0;
  double velocity_limit_rad_s = 0.0;

  double link_mass_kg = 0.0;
  Eigen::Vector2d link_com_m = {0, 0};  ///< centre of mass, in the link's frame
  double link_inertia_kgm2 = 0.0;       ///< about the link's centre of mass
};

/// A chain of any number of revolute joints with parallel axes. It is constant. No function below
/// allocates if the results have their size. The held coordinates of its tip are x, y and φ.
class PlanarChain final : public TipKinematics {
 public:
  /// `tip_offset_m` and `tip_yaw_rad` place the tip in the last link's frame. Throws
  /// std::invalid_argument if there is no joint.
  PlanarChain(std::vector<PlanarJoint> joints, const Eigen::Vector2d& tip_offset_m,
              double tip_yaw_rad);

  const PlanarJoint& joint(Eigen::Index i) const { return joints_[static_cast<std::size_t>(i)]; }

  /// As Eq. 2.51, for any chain.
  TipVector tip_pose(const Angles& q_rad) const override;
  /// J_aco(q), Eq. 2.52.
  void tip_jacobian(const Angles& q_rad, TaskJacobian& J) const override;
  /// The last term of Eq. 2.93 [m/s², m/s², rad/s²].
  TipVector tip_bias_acceleration(const Angles& q_rad, const Angles& dq_rad_s) const override;
  const PlanarChain* planar() const override { return this; }

  /// J(q) of Eq. 2.50 without the motors' armature [kg m²], n×n, symmetric positive definite.
  Eigen::MatrixXd mass_matrix(const Angles& q_rad) const;

 private:
  std::vector<PlanarJoint> joints_;
  Eigen::Vector2d tip_offset_;
  double tip_yaw_;
};

/// Reads a chain from a URDF file. The tip is the frame of the only link without children. Links
/// with fixed joints are lumped. The motion must be planar: every joint is revolute about ±z or
/// fixed, and no origin has roll or pitch.
///
/// Throws std::invalid_argument with one line, `FILE:LINE: element "name": reason`, if the file
/// cannot be read, is not URDF, branches or is not planar. Every moving link needs a mass, and
/// every joint an effort and a velocity limit. Thread-safe.
PlanarChain load_planar_chain(const std::string& urdf_file);

}  // namespace breakwater
