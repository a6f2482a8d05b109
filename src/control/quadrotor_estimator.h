// The six estimators of thesis 3.4 (Table 3.5), and those of a world force: resonator, spectrum.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include <breakwater/control/quadrotor_process.h>
#include <breakwater/observers/wave_force_bank.h>

namespace breakwater {

enum class QuadrotorFilter { ukf, ekf };
enum class DisturbanceOrder { none, zero, second, resonator, spectrum };
enum class ProcessNoiseMode {
  per_step,      ///< Q as printed
  delta,         ///< Q δ
  delta_squared  ///< Q δ²: the noise enters as δ·w
};
enum class ProcessNoiseStates {
  all,
  highest  ///< the model's highest derivative alone: d̈, d or, without a disturbance, ζ̇
};
enum class ProcessNoiseSource {
  printed,  ///< Q_ukf of 3.4.3.1; an EKF takes it too
  input,    ///< W_s G Gᵀ, as the thesis' EKFs have it; EKF only
  tuned     ///< standard deviations per sample
};

/// Variance of a horizontal axis' wave force over the vertical one's. Deep water moves in circles,
/// so the force along the waves' heading has the vertical one's variance; the heading is not known,
/// and on average either axis has half of it.
inline constexpr double kHorizontalShare = 0.5;

struct QuadrotorEstimatorDesign {
  QuadrotorFilter filter = QuadrotorFilter::ukf;
  DisturbanceOrder order = DisturbanceOrder::second;
  ProcessNoiseSource noise = ProcessNoiseSource::printed;
  ProcessNoiseMode noise_mode = ProcessNoiseMode::delta_squared;
  ProcessNoiseStates noise_states = ProcessNoiseStates::all;  ///< which have the printed Q
  double input_noise = 0.1;                                   ///< W_s
  /// Tuned: σ of the walk of ẋ ẏ ż, of φ̇ θ̇ ψ̇, and of the highest of the disturbance's derivatives,
  /// at each sample.
  double velocity_std_m_s = 0.03;
  double rate_std_rad_s = 3e-3;
  double disturbance_std = 0.01;
  ResonatorDesign resonator;
  double wave_frequency_rad_s = 0.8;      ///< resonator: of the waves' force, or a first guess
  bool estimates_wave_frequency = false;  ///< resonator: tracks it
  WaveForceBankDesign waves;              ///< spectrum: which seas there may be
  /// Spectrum: the torques' walk at each sample over the vertical force's deviation [m].
  double torque_walk_per_force_m = 0.0;
  AttitudeKinematics kinematics = AttitudeKinematics::level;
  double position_std_m = 0.1;  ///< of the measurement's noise, for R
  double angle_std_rad = 0.01;
  double period_s = 0.01;  ///< δ
};

/// Estimates the vehicle's motion and what disturbs it from noisy poses. Used once a sample:
/// update(), then read.
class QuadrotorEstimator {
 public:
  using Motion = Eigen::Matrix<double, 12, 1>;
  using MotionCovariance = Eigen::Matrix<double, 12, 12>;

  QuadrotorEstimator() = default;
  QuadrotorEstimator(const QuadrotorEstimator&) = delete;
  QuadrotorEstimator& operator=(const QuadrotorEstimator&) = delete;
  virtual ~QuadrotorEstimator() = default;

  /// Starts at rest at a pose, with no disturbance.
  virtual void reset(const Vector6d& pose) = 0;
  /// One sample: the thrusts that were held since the last one, and the pose measured now.
  /// Allocates nothing.
  virtual void update(const Eigen::Vector4d& held_thrusts, const Vector6d& pose) = 0;

  /// [ζ; ζ̇], and its covariance as the filter believes.
  virtual const Motion& motion() const = 0;
  virtual MotionCovariance motion_covariance() const = 0;
  /// d̂ of each thruster [N]; 0 where it is not modelled.
  virtual Eigen::Vector4d thrust_disturbance() const = 0;
  /// The disturbing force in the world [N], and whether it is modelled as such.
  virtual Eigen::Vector3d force() const = 0;
  virtual bool models_world_force() const = 0;
  virtual bool models_disturbance() const = 0;
  /// The frequency of the waves' force that it assumes [rad/s]; 0 where it assumes none.
  virtual double wave_frequency_rad_s() const { return 0.0; }
  /// The standard deviation of the waves' vertical force that it assumes [N]; 0 where none.
  virtual double wave_force_std_N() const { return 0.0; }
};

/// Throws std::invalid_argument if a deviation is not positive, or the combination is none: a
/// resonator and a spectrum need the UKF, input noise the EKF. A spectrum takes its axis (mass,
/// walks, noise, δ) from here, not from `waves`.
std::unique_ptr<QuadrotorEstimator> make_quadrotor_estimator(const QuadrotorEstimatorDesign& design,
                                                             const QuadrotorModel& model);

}  // namespace breakwater
