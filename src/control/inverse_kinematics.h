// One step of inverse kinematics by Levenberg–Marquardt: thesis 2.4.2.3.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <breakwater/plants/tip_chain.h>

namespace breakwater {

/// The reading of Eqs. 2.66 and 2.68.
enum class LmForm {
  /// As printed: M = Jᵀ W_e X_e + X_e and W_n = diag(|X_e|) + λ I. This adds a task-space error to
  /// a joint-space vector, which is dimensionally wrong, and needs as many joints as task
  /// coordinates. Eq. 2.68 prints diag(X_e), but a damping must not be negative.
  printed,
  /// M as printed with the W_n of `sugihara`.
  sugihara_damping,
  /// For any number of joints: M = Jᵀ W_e X_e and W_n = (½ X_eᵀ W_e X_e + λ) I, as in T. Sugihara,
  /// IEEE Trans. Robotics 27 (2011) 984–991.
  sugihara
};

struct LmDesign {
  Eigen::VectorXd weights = Eigen::Vector3d(1e2, 1e2, 1e1);  ///< diagonal of W_e (Eq. 2.67), c
  double damping = 1e-8;                                     ///< λ
  double step_limit_rad = 3.14159265358979312;               ///< bound on each |q̃|
  LmForm form = LmForm::printed;
};

/// q^ref = q + q̃ with q̃ = {Jᵀ W_e J + W_n}⁻¹ M (Eqs. 2.63–2.66): one damped step to a posture
/// without the tip's error X_e. Works at singular postures.
///
/// The thesis bounds q̃ by "π rad/s". As a rate, this bound keeps the arm from the wall. Here it
/// reads |q̃| ≤ π rad.
class LmInverseKinematics {
 public:
  /// Throws std::invalid_argument if a weight, λ or the limit is not positive. The printed M needs
  /// as many joints as coordinates.
  LmInverseKinematics(const LmDesign& design, Eigen::Index joints);

  /// q̃ [rad], given the tip's Jacobian (c×n) and its error X_e (c). Allocates nothing.
  const Eigen::VectorXd& step(const TaskJacobian& J, const TipVector& X_e);

 private:
  LmDesign design_;
  Eigen::MatrixXd weighted_Jt_;  // Jᵀ W_e
  Eigen::MatrixXd normal_matrix_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd step_;
};

}  // namespace breakwater
