// Process models of the quadrotor and its disturbance for the nonlinear Kalman filters.
#pragma once

#include <array>

#include <breakwater/math/refuse_unless.h>
#include <breakwater/observers/nonlinear_kalman.h>
#include <breakwater/observers/resonator.h>
#include <breakwater/plants/quadrotor.h>

namespace breakwater {

/// The model of the angles' second derivatives.
enum class AttitudeKinematics {
  level,  ///< the angles' rates are the body's, as in Eq. 3.13
  exact   ///< QuadrotorModel::rigid_acceleration()
};

/// ζ̈ under held thrusts. It stores the sines of the last attitude, which most sigma points share.
class HeldThrust {
 public:
  HeldThrust(const QuadrotorModel& model, double period_s,
             AttitudeKinematics kinematics = AttitudeKinematics::level)
      : model_(model),
        thruster_matrix_(thruster_matrix(model.parameters().thruster_arm_m)),
        period_s_(period_s),
        kinematics_(kinematics) {}

  /// δ ζ̈(ζ, ζ̇, B_tcm T), a step of Euler's method (Eq. 3.31).
  Vector6d velocity_step(const Eigen::Ref<const Eigen::Matrix<double, 12, 1>>& pose_and_velocity,
                         const Eigen::Vector4d& thrusts) const {
    const Eigen::Vector3d angles = pose_and_velocity.segment<3>(3);
    if (angles != angles_) {
      angles_ = angles;
      trig_ = AttitudeTrig(angles);
    }
    const Vector6d velocity = pose_and_velocity.tail<6>();
    const Eigen::Vector4d U = thruster_matrix_ * thrusts;
    return period_s_ * (kinematics_ == AttitudeKinematics::exact
                            ? model_.rigid_acceleration(trig_, velocity, U)
                            : model_.acceleration(trig_, velocity, U));
  }

  double period_s() const { return period_s_; }

 private:
  QuadrotorModel model_;
  Eigen::Matrix4d thruster_matrix_;
  double period_s_;
  AttitudeKinematics kinematics_;
  mutable Eigen::Vector3d angles_ = Eigen::Vector3d::Zero();
  mutable AttitudeTrig trig_{Eigen::Vector3d::Zero()};
};

/// A disturbance that adds to the thrust of each thruster. Order 0 is a constant, order −1 none.
/// Order 2 is a polynomial in time (Eqs. 3.27–3.31), with the state [ζ, ζ̇, d, ḋ, d̈].
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

  ThrusterDisturbance(const QuadrotorModel& model, double period_s,
                      AttitudeKinematics kinematics = AttitudeKinematics::level)
      : held_(model, period_s, kinematics) {
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

/// Standard deviations of the process noise of a world-force model, in each sample.
struct ProcessNoiseStd {
  double velocity_std_m_s = 3e-3;  ///< ẋ, ẏ, ż
  double rate_std_rad_s = 2e-3;    ///< φ̇, θ̇, ψ̇
  double bias_std_N = 5e-4;        ///< the constant forces
  double torque_std_Nm = 2e-4;     ///< the torques
};

/// Model of a sea state with one resonator per axis.
struct ResonatorDesign : ProcessNoiseStd {
  double damping = 0.08;      ///< damping ratio
  double force_std_N = 0.13;  ///< stationary standard deviation of each world force
};

/// The wave force on each axis of the world, as the sum of K resonators driven by white noise,
///     f̈ᵢ + 2 ζᵢ ωᵢ ḟᵢ + ωᵢ² fᵢ = white,
/// with a constant force b and torques τ as random walks. The state is [ζ, ζ̇, f₁, b, τ, h₁, f₂,
/// h₂, …], hᵢ = ḟᵢ/ωᵢ. Unlike a thruster's disturbance, it can represent a horizontal force, and it
/// oscillates like waves. Order 1 is Euler's step, ζ⁺ = ζ + δ ζ̇. Order 2 assumes constant
/// acceleration, ζ⁺ = ζ + δ ζ̇ + δ² ζ̈/2. The errors of Euler's steps add up to δ ζ̇/2.
template <int K, int Order>
class WaveForces : public ProcessTypes<18 + 6 * K, 4, 6 * Order> {
 public:
  static_assert(K >= 1 && (Order == 1 || Order == 2));
  static constexpr int kStates = 18 + 6 * K;
  static constexpr int kInputs = 4;
  static constexpr int kRows = 6 * Order;
  static constexpr int kFirstRow = 12 - kRows;
  static constexpr int kArguments = 12;
  using Types = ProcessTypes<kStates, 4, kRows>;
  using Square = Eigen::Matrix<double, kStates, kStates>;
  using Resonators = std::array<Resonator, K>;

  static constexpr int kBias = 15;
  static constexpr int kTorque = 18;
  /// First index of fᵢ and hᵢ of the three axes.
  static constexpr int force_row(int i) { return i == 0 ? 12 : 18 + 6 * i; }
  static constexpr int rate_row(int i) { return force_row(i) + (i == 0 ? 9 : 3); }

  /// `horizontal_share`: variance of a horizontal axis' force divided by that of the vertical one.
  /// Throws std::invalid_argument if a value is not positive, or a damping is not below 1.
  WaveForces(const QuadrotorModel& model, const ProcessNoiseStd& noise,
             const Resonators& resonators, double horizontal_share, double period_s,
             AttitudeKinematics kinematics)
      : held_(model, period_s, kinematics), horizontal_share_(horizontal_share) {
    refuse_unless(noise.velocity_std_m_s > 0.0 && noise.rate_std_rad_s > 0.0 &&
                      noise.bias_std_N > 0.0 && horizontal_share > 0.0,
                  "resonators: the standard deviations must be positive");
    const auto square = [](double value) { return value * value; };
    A_.setIdentity();
    A_.template block<6, 6>(0, 6).diagonal().setConstant(period_s);
    const Vector6d inverse_inertia = model.parameters().inertia6().cwiseInverse();
    const Eigen::Vector3d push = period_s * inverse_inertia.head<3>();
    for (int i = 0; i < K; ++i) A_.template block<3, 3>(6, force_row(i)).diagonal() = push;
    A_.template block<3, 3>(6, kBias).diagonal() = push;
    A_.template block<3, 3>(9, kTorque).diagonal() = period_s * inverse_inertia.tail<3>();
    if constexpr (Order == 2) {
      A_.template topRightCorner<6, kStates - 12>() =
          0.5 * period_s * A_.template block<6, kStates - 12>(6, 12);
    }
    Q_.setZero();
    Q_.diagonal().template segment<3>(6).setConstant(square(noise.velocity_std_m_s));
    Q_.diagonal().template segment<3>(9).setConstant(square(noise.rate_std_rad_s));
    Q_.diagonal().template segment<3>(kBias).setConstant(square(noise.bias_std_N));
    set_torque_noise(noise.torque_std_Nm);
    set_resonators(resonators);
  }

  void nonlinear(const typename Types::State& x, const typename Types::Input& thrusts,
                 typename Types::Nonlinear& g) const {
    g.template tail<6>() = held_.velocity_step(x.template head<12>(), thrusts);
    if constexpr (Order == 2) g.template head<6>() = 0.5 * held_.period_s() * g.template tail<6>();
  }
  const Square& linear() const { return A_; }

  /// Sets the resonators of the vertical axis. Throws as the constructor does.
  void set_resonators(const Resonators& resonators) {
    const double period_s = held_.period_s();
    for (int i = 0; i < K; ++i) {
      const Resonator& r = resonators[static_cast<std::size_t>(i)];
      refuse_unless(
          r.is_sound(),
          "resonators: frequency and deviation must be positive, the damping between 0 and 1");
      const int f = force_row(i), h = rate_row(i);
      const Eigen::Matrix2d step = resonator_step(r.omega_rad_s, r.damping, period_s);
      A_.template block<3, 3>(f, f).diagonal().setConstant(step(0, 0));
      A_.template block<3, 3>(f, h).diagonal().setConstant(step(0, 1));
      A_.template block<3, 3>(h, f).diagonal().setConstant(step(1, 0));
      A_.template block<3, 3>(h, h).diagonal().setConstant(step(1, 1));
      const double noise = resonator_noise(r.omega_rad_s, r.damping, r.std, period_s);
      Q_.diagonal().template segment<3>(h) << horizontal_share_ * noise, horizontal_share_ * noise,
          noise;
    }
  }
  /// Sets σ of the torques' process noise in each sample [N m]. Throws std::invalid_argument unless
  /// it is positive.
  void set_torque_noise(double std_Nm) {
    refuse_unless(std_Nm > 0.0, "resonators: the torques' walk must be positive");
    Q_.diagonal().template segment<3>(kTorque).setConstant(std_Nm * std_Nm);
  }
  /// Covariance of the process noise in one sample, with the present resonators.
  const Square& Q() const { return Q_; }

 private:
  HeldThrust held_;
  double horizontal_share_;
  Square A_;
  Square Q_;
};

}  // namespace breakwater
