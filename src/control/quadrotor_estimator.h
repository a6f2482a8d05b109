// The six estimators of thesis 3.4 (Table 3.5), and two with a world force: resonator, spectrum.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include <breakwater/control/quadrotor_process.h>
#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/observers/wave_force_bank.h>

namespace breakwater {

enum class QuadrotorFilter { ukf, ekf };
enum class DisturbanceOrder { none, zero, second, resonator, spectrum };
enum class ProcessNoiseSource {
  printed,  ///< Q_ukf of 3.4.3.1; an EKF takes it too
  input,    ///< W_s G Gᵀ, as in the thesis' EKFs; EKF only
  tuned     ///< standard deviations in each sample
};

/// Variance of a horizontal axis' wave force divided by that of the vertical one. In deep water the
/// orbits are circles, so the force along the heading has the vertical variance. For an unknown
/// heading each axis has half of it on average.
inline constexpr double kHorizontalShare = 0.5;

struct QuadrotorEstimatorDesign {
  QuadrotorFilter filter = QuadrotorFilter::ukf;
  DisturbanceOrder order = DisturbanceOrder::second;
  ProcessNoiseSource noise = ProcessNoiseSource::printed;
  /// Power of δ by which the printed Q is multiplied: 0 as printed, 2 for noise that enters as δ·w.
  int noise_power = 2;
  /// Only the model's highest derivative has the printed Q: d̈, d or, without a disturbance, ζ̇.
  bool only_highest_has_noise = false;
  double input_noise = 0.1;  ///< W_s
  /// Tuned: σ of the process noise in each sample, for ẋ ẏ ż, for φ̇ θ̇ ψ̇, and for the highest
  /// derivative of the disturbance.
  double velocity_std_m_s = 0.03;
  double rate_std_rad_s = 3e-3;
  double disturbance_std = 0.01;
  ResonatorDesign resonator;
  double wave_frequency_rad_s = 0.8;      ///< resonator: wave frequency, or its initial value
  bool estimates_wave_frequency = false;  ///< resonator: adapts the frequency
  WaveForceBankDesign waves;              ///< spectrum: the candidate sea states
  /// Spectrum: σ of the torques' process noise divided by σ of the vertical force [m].
  double torque_walk_per_force_m = 0.0;
  AttitudeKinematics kinematics = AttitudeKinematics::level;
  double position_std_m = 0.1;  ///< standard deviation of the measurement noise, for R
  double angle_std_rad = 0.01;
  double period_s = 0.01;  ///< δ
};

/// Estimates the vehicle's motion and disturbance from noisy poses. Its reset() takes the pose of a
/// vehicle at rest, and its update() the thrusts and the pose. Its state() is [ζ; ζ̇]. Its
/// disturbance() is the disturbing force in the world frame [N].
class QuadrotorEstimator : public DisturbanceEstimator {
 public:
  using Motion = Eigen::Matrix<double, 12, 1>;
  using MotionCovariance = Eigen::Matrix<double, 12, 12>;

  Eigen::Map<const Motion> motion() const { return Eigen::Map<const Motion>(state().data()); }
  Eigen::Vector3d force() const { return disturbance(); }
  /// The computed covariance of the motion; NaN: none.
  virtual MotionCovariance motion_covariance() const {
    return MotionCovariance::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  /// d̂ of each thruster [N]; 0 without such a model.
  virtual Eigen::Vector4d thrust_disturbance() const { return Eigen::Vector4d::Zero(); }
  /// The force that the model expects in `ahead_s` seconds if nothing new disturbs it: the free
  /// response of its oscillators, or the present force. Allocates nothing.
  virtual Eigen::Vector3d force_ahead(double /*ahead_s*/) const { return force(); }
  /// Whether the model has such a force, and any disturbance.
  virtual bool models_world_force() const { return true; }
  virtual bool models_disturbance() const { return true; }
  /// The assumed frequency of the wave force [rad/s]; 0: none.
  virtual double wave_frequency_rad_s() const { return 0.0; }
  /// The assumed standard deviation of the vertical wave force [N]; 0: none.
  virtual double wave_force_std_N() const { return 0.0; }
};

/// Throws std::invalid_argument if a standard deviation is not positive or the combination is
/// invalid. A resonator and a spectrum need the UKF, input noise the EKF. A spectrum takes its
/// axis (mass, process noise, measurement noise, δ) from the other fields, not from `waves`.
std::unique_ptr<QuadrotorEstimator> make_quadrotor_estimator(const QuadrotorEstimatorDesign& design,
                                                             const QuadrotorModel& model);

}  // namespace breakwater
