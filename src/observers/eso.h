// Extended state observer (ESO), linear and with Han's nonlinear gains.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/guarded_kalman.h>

namespace breakwater {

/// Han's fal(e, α, δ) times δ^{1−α}: e for |e| ≤ δ, and sign(e) |e|^α δ^{1−α} beyond.
inline double scaled_fal(double e, double exponent, double zone) {
  const double size = std::abs(e);
  return size <= zone ? e : e * math::pow(size / zone, exponent - 1.0);
}

struct EsoDesign {
  double bandwidth_rad_s = 0.0;  ///< ω_o > 0
  /// δ > 0: up to this innovation the gains are linear. ∞: always.
  double linear_zone = std::numeric_limits<double>::infinity();
};

/// x̄ = [q; q̇; d] of an axis, sampled with a zero-order hold. With ê = y − q(k|k−1):
///     x̄(k) = Φ x̄(k−1) + Γ u(k−1) + [l₁ ê; l₂ f(ê, ½); l₃ f(ê, ¼)],
///     f(ê, α) = δ^{1−α} fal(ê, α, δ).
/// The gains l place all poles of (I − l C̅) Φ at e^{−ω_o T_s}, those of −ω_o in continuous time.
/// Within ±δ the observer is this linear one. Beyond, the gains of q̇ and d fall as fal does.
///
/// Sources: J. Han, IEEE Trans. Ind. Electron. 56 (2009) 900–906; Z. Gao, Proc. ACC 2003,
/// 4989–4996 (one bandwidth); R. Miklosovic, A. Radke, Z. Gao, Proc. ACC 2006 (the sampled form).
class Eso final : public Guarded<> {
 public:
  /// The plant is continuous, with the states position and velocity, one input and the measured
  /// position. Throws std::invalid_argument otherwise, or if ω_o, δ or T_s is not positive.
  Eso(const StateSpace& plant, const EsoDesign& design, double period_s)
      : linear_zone_(design.linear_zone) {
    refuse_unless(plant.states() == 2 && plant.inputs() == 1 && plant.outputs() == 1,
                  "ESO: needs an axis with position and velocity");
    refuse_unless(design.bandwidth_rad_s > 0.0 && linear_zone_ > 0.0,
                  "ESO: the bandwidth and the linear zone must be positive");
    const StateSpace sampled = zero_order_hold(extend_by_input_disturbance(plant), period_s);
    transition_ = sampled.A;
    input_ = sampled.B;
    const PoleGroup poles(3, {-design.bandwidth_rad_s, 0.0});
    // Φ − H C̅ = Φ (I − l C̅) with l = Φ⁻¹ H has the poles of (I − l C̅) Φ.
    const Eigen::MatrixXd H =
        place_observer_poles(sampled.A, sampled.C, sample_poles({poles}, period_s));
    gain_ = transition_.partialPivLu().solve(H);
    error_dynamics_ = (Eigen::Matrix3d::Identity() - gain_ * sampled.C) * transition_;
    signals_ = {{"innovation", "", "e = y - q(k|k-1)", view(innovation_)}};
  }

  void reset(const Vector& x) override {
    estimate_ << x(0), x(1), 0.0;
    innovation_ = 0.0;
    has_begun_ = false;
  }
  View state() const override { return {estimate_.data(), 2}; }
  View disturbance() const override { return {estimate_.data() + 2, 1}; }

  /// (I − l C̅) Φ, the dynamics of the error within the linear zone.
  Eigen::Index poles() const override { return 3; }
  void pole_matrix(Eigen::Ref<Eigen::MatrixXd> F) const override { F = error_dynamics_; }

 private:
  void step(const Vector& held_input, const Vector& y) override {
    if (has_begun_) estimate_ = (transition_ * estimate_ + input_ * held_input(0)).eval();
    has_begun_ = true;
    innovation_ = is_measured_ ? y(0) - estimate_(0) : 0.0;
    estimate_(0) += gain_(0) * innovation_;
    estimate_(1) += gain_(1) * scaled_fal(innovation_, 0.5, linear_zone_);
    estimate_(2) += gain_(2) * scaled_fal(innovation_, 0.25, linear_zone_);
  }

  Eigen::Matrix3d transition_;  // Φ
  Eigen::Vector3d input_;       // Γ
  Eigen::Vector3d gain_;        // l
  Eigen::Matrix3d error_dynamics_;
  double linear_zone_;
  Eigen::Vector3d estimate_ = Eigen::Vector3d::Zero();
  double innovation_ = 0.0;
  bool has_begun_ = false;
};

}  // namespace breakwater
