// The quadrotor as the nonlinear filters' process, with models of what disturbs it.
#pragma once

#include <limits>

#include <breakwater/observers/process.h>
#include <breakwater/plants/quadrotor.h>

namespace breakwater {

/// ζ̈ under held thrusts; keeps the last attitude's sines, which most sigma points share.
class HeldThrust {
 public:
  HeldThrust(const QuadrotorModel& model, double period_s)
      : model_(model),
        thruster_matrix_(thruster_matrix(model.parameters().thruster_arm_m)),
        period_s_(period_s) {}

  /// δ ζ̈(ζ, ζ̇, B_tcm T), Euler's step (Eq. 3.31).
  Vector6d velocity_step(const Eigen::Ref<const Eigen::Matrix<double, 12, 1>>& pose_and_velocity,
                         const Eigen::Vector4d& thrusts) const;

  const QuadrotorModel& model() const { return model_; }
  double period_s() const { return period_s_; }

 private:
  QuadrotorModel model_;
  Eigen::Matrix4d thruster_matrix_;
  double period_s_;
  mutable Eigen::Vector3d angles_ = Eigen::Vector3d::Zero();
  mutable AttitudeTrig trig_{Eigen::Vector3d::Zero()};
};

/// Each thruster's disturbance, which adds to its thrust, as a constant (order 0) or as a
/// polynomial of order 2 in time (Eqs. 3.27–3.31, with the state [ζ, ζ̇, d, ḋ, d̈]); order −1: none.
///     ζ⁺ = ζ + δ ζ̇,  ζ̇⁺ = ζ̇ + δ ζ̈(ζ, ζ̇, T + d),  d⁺ = d + δ ḋ,  ḋ⁺ = ḋ + δ d̈,  d̈⁺ = d̈.
template <int Order>
class ThrusterDisturbance : public ProcessTypes<12 + 4 * (Order + 1), 4, 6> {
 public:
  static constexpr int kStates = 12 + 4 * (Order + 1);
  static constexpr int kInputs = 4;
  static constexpr int kFirstRow = 6;
  static constexpr int kRows = 6;
  static constexpr int kArguments = Order < 0 ? 12 : 16;
  using Types = ProcessTypes<kStates, 4, 6>;
  using Square = Eigen::Matrix<double, kStates, kStates>;

  ThrusterDisturbance(const QuadrotorModel& model, double period_s) : held_(model, period_s) {
    A_.setIdentity();
    A_.template block<6, 6>(0, 6).diagonal().setConstant(period_s);
    for (int row = 12; row + 4 < kStates; ++row) A_(row, row + 4) = period_s;
  }

  void nonlinear(const typename Types::State& x, const typename Types::Input& thrusts,
                 typename Types::Nonlinear& g) const {
    if constexpr (Order < 0) {
      g = held_.velocity_step(x, thrusts);
    } else {
      g = held_.velocity_step(x.template head<12>(), thrusts + x.template segment<4>(12));
    }
  }
  const Square& linear() const { return A_; }

 private:
  HeldThrust held_;
  Square A_;
};

/// How the resonator model describes a sea.
struct ResonatorDesign {
  double damping = 0.08;           ///< of the resonators, relative
  double force_std_N = 0.13;       ///< of each world force, stationary
  double velocity_std_m_s = 3e-3;  ///< walk of ẋ, ẏ, ż at each sample
  double rate_std_rad_s = 2e-3;    ///< walk of φ̇, θ̇, ψ̇
  double bias_std_N = 5e-4;        ///< walk of the constant forces
  double torque_std_Nm = 2e-4;     ///< walk of the torques
};

/// A world force of waves, f, on each axis as a resonator driven by white noise,
///     f̈ + 2 ζ_r ω ḟ + ω² f = white,
/// with a constant force b and torques τ that walk: state [ζ, ζ̇, f, b, τ, h], h = ḟ/ω. Unlike a
/// thruster's disturbance it can represent a horizontal force, and it oscillates as waves do.
class WaveResonators : public ProcessTypes<24, 4, 6> {
 public:
  static constexpr int kStates = 24;
  static constexpr int kInputs = 4;
  static constexpr int kFirstRow = 6;
  static constexpr int kRows = 6;
  static constexpr int kArguments = 12;
  using Square = Eigen::Matrix<double, 24, 24>;

  /// Throws std::invalid_argument if a value is not positive.
  WaveResonators(const QuadrotorModel& model, const ResonatorDesign& design, double omega_rad_s,
                 double period_s);

  void nonlinear(const State& x, const Input& thrusts, Nonlinear& g) const {
    g = held_.velocity_step(x.head<12>(), thrusts);
  }
  const Square& linear() const { return A_; }

  /// ω [rad/s]: where the force has its energy.
  void set_frequency(double omega_rad_s);
  /// What the process adds to P at each sample, at the present frequency.
  const Square& Q() const { return Q_; }

 private:
  HeldThrust held_;
  ResonatorDesign design_;
  Square A_;
  Square Q_;
};

}  // namespace breakwater
