// Apparent mass of a mechanism at a point.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <string>

#include <breakwater/sim/model.h>

namespace breakwater {

/// The apparent mass at a site for a short force along a direction e of the world; joints are free:
///     m = 1 / (eᵀ J M⁻¹ Jᵀ e)    [kg]
/// J (3 × n): translational Jacobian of the site; M (n × n): joint-space inertia with armatures.
///
/// Source: O. Khatib, Int. J. Robotics Research 14 (1995) 19–36.
class ApparentMass {
 public:
  /// `direction` is a unit vector. Throws std::invalid_argument if the site or a joint is missing.
  ApparentMass(const Model& model, const std::string& site, const Eigen::Vector3d& direction);

  /// The value for the last configuration that the engine computed; infinite if the site cannot
  /// move along e. Does not allocate.
  double operator()(const Model& model, const mjData& data);

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  int site_;
  Eigen::Vector3d direction_;
  RowMajor jacobian_;
  RowMajor inertia_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  Eigen::VectorXd along_;   // Jᵀ e
  Eigen::VectorXd recoil_;  // M⁻¹ Jᵀ e
};

}  // namespace breakwater
