// An extended state observer (ESO) of one axis. Its bandwidth is its only parameter.
#pragma once

#include <Eigen/Core>

#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/rigs/axis_parts.h>

namespace my_observer_lab {

/// The axis J q̈ = u − d − c q̇ is extended by its disturbance, ḋ = 0, to x̄ = [q; q̇; d]. It is
/// sampled with a held input, x̄(k+1) = Φ x̄(k) + Γ u(k). The observer predicts, and then corrects
/// with the measurement:
///     x̄⁻(k) = Φ x̂(k−1) + Γ u(k−1),   x̂(k) = x̄⁻(k) + L (y(k) − C x̄⁻(k)).
/// Its error is e(k) = (I − L C) Φ e(k−1). All three poles are at −ω_o, sampled exactly: at e^{−ω_o
/// T_s}, inside the unit circle for every ω_o and T_s. A larger ω_o T_s gives more weight to the
/// measurement, including its noise.
///
/// Source: Z. Gao, "Scaling and bandwidth-parameterization based controller tuning", ACC 2003; the
/// sampled form: R. Miklosovic, A. Radke, Z. Gao, "Discrete implementation and generalization of
/// the extended state observer", ACC 2006.
class MyObserver final : public breakwater::DisturbanceEstimator {
 public:
  /// `plant` is continuous: the input is a force, the states are position and velocity, the output
  /// is the position. Throws std::invalid_argument for another plant, or if bandwidth or period is
  /// not positive.
  MyObserver(const breakwater::StateSpace& plant, double bandwidth_rad_s, double period_s);

  void reset(const Vector& x) override;
  void update(const Vector& held_input, const Vector& y) override;

  View state() const override { return {estimate_.data(), 2}; }
  View disturbance() const override { return {estimate_.data() + 2, 1}; }

  Eigen::Index poles() const override { return 3; }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override { F = error_dynamics_; }

  const Eigen::Vector3d& L() const { return gain_; }

 private:
  Eigen::Matrix3d transition_;      // Φ
  Eigen::Vector3d input_;           // Γ
  Eigen::Vector3d gain_;            // L
  Eigen::Matrix3d error_dynamics_;  // (I − L C) Φ
  Eigen::Vector3d estimate_ = Eigen::Vector3d::Zero();
  bool has_begun_ = false;
  double innovation_ = 0.0;  // y − C x̄⁻
};

/// The estimator for the catalogue: its name, its keys, and the function that makes it.
breakwater::AxisEstimatorKind my_observer_kind();

}  // namespace my_observer_lab
