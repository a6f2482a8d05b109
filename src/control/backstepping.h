// Backstepping control of the quadrotor: thesis 3.4.2.1.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <memory>
#include <numbers>

#include <breakwater/control/controller.h>
#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/plants/quadrotor.h>

namespace breakwater {

/// α_1 … α_12: gains of x, y, z, φ, θ, ψ, then of their rates.
using BacksteppingGains = Eigen::Matrix<double, 12, 1>;

/// The gains printed in 3.4.3.1.
BacksteppingGains printed_gains();
/// Gains of a DLQR of the axes with linear friction, a zero-order hold of `period_s` and the
/// printed weights, except `weight_z` for z. 1e4 gives the printed gains. The printed weight 1e3
/// gives α_3 = 0.994.
BacksteppingGains dlqr_gains(const QuadrotorParameters& parameters, double period_s,
                             double weight_z = 1e4);
/// DLQR gains, except α = 1 for x and y and 6 for φ and θ: these are stable on the physical plant.
BacksteppingGains retuned_gains(const QuadrotorParameters& parameters, double period_s);

struct BacksteppingDesign {
  BacksteppingGains alpha = BacksteppingGains::Ones();
  Vector6d reference = Vector6d::Zero();  ///< ζ_ref, at rest [m, rad]
  double position_clamp_m = 0.0;          ///< upper bound of |Z_1| of x, y, z; 0: none
  double thrust_floor_N = 0.5;            ///< lower bound of |U_z| in divisors
  double tilt_limit_rad = std::numbers::pi / 4.0;
};

/// The control law. On each axis, with Z_1 = ref − q and Z_2 = q̇ − α Z_1 (Eqs. 3.17, 3.22), the
/// acceleration
///     a = Z_1 − α (Z_2 + α Z_1) − α' Z_2                                       (from Eq. 3.25)
/// makes V̇ = −α Z_1² − α' Z_2² for V = (Z_1² + Z_2²)/2. From it
///     U_z = (m a_z + G_z(ζ) − F_z)/(cos φ cos θ),   f = m a + G(ζ) − F on x and y,
///     θ_ref = sat(f_x/U_z),  φ_ref = sat(−f_y/U_z)                             (for Eq. 3.26),
///     τ = I a on φ, θ, ψ,
/// G is that of the nominal plant, F a known external force. The printed U_x divides by U_z u_x,
/// which is singular at hover. The floor bounds U_z in the divisors: U_z carries the weight on
/// average. The vehicle cannot turn as fast as a noisy U_z changes its sign.
class Backstepping {
 public:
  Backstepping(const QuadrotorModel& nominal, const BacksteppingDesign& design)
      : nominal_(nominal), design_(design) {}

  /// U = [U_z, τ_φ, τ_θ, τ_ψ] for the motion [ζ; ζ̇] and an external force [N].
  Eigen::Vector4d wrench(const Eigen::Matrix<double, 12, 1>& motion,
                         const Eigen::Vector3d& force) const;
  /// The same with a given force f of the vehicle on x, y and z [N]. `attitude` is that of
  /// `motion`.
  Eigen::Vector4d wrench_of_force(const Eigen::Matrix<double, 12, 1>& motion,
                                  const AttitudeTrig& attitude, const Eigen::Vector3d& f) const;
  /// Upper bound of |Z_1| of x, y, z [m].
  double position_clamp_m() const;
  /// The largest horizontal force if the thrust carries the weight in water [N].
  double largest_tilt_force_N() const {
    return design_.tilt_limit_rad * nominal_.parameters().net_weight_N();
  }

  const BacksteppingDesign& design() const { return design_; }
  const QuadrotorModel& nominal() const { return nominal_; }

 private:
  QuadrotorModel nominal_;
  BacksteppingDesign design_;
};

/// The largest real part of the closed-loop poles [1/s], linearised at rest at the reference, with
/// a known state and without sampling.
double slowest_pole(const Backstepping& law, const QuadrotorModel& plant);

/// A control law with an estimator: thrusts u [N] from y = [x y z φ θ ψ].
class QuadrotorController : public Controller {
 public:
  QuadrotorController(const Backstepping& law, std::shared_ptr<QuadrotorEstimator> estimator);

  void reset(const Sample& first) override;
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) final;

  const Backstepping& law() const { return law_; }
  const QuadrotorEstimator& estimator() const { return *estimator_; }

 protected:
  /// U from the new estimates.
  virtual Eigen::Vector4d wrench(double time_s) = 0;
  Eigen::Matrix<double, 12, 1> motion_ = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  bool compensates_ = false;  // T − d̂ cancels the estimated disturbance of the thrusters

 private:
  Backstepping law_;
  std::shared_ptr<QuadrotorEstimator> estimator_;
  Eigen::PartialPivLU<Eigen::Matrix4d> to_thrusts_;
  Eigen::Vector4d held_thrusts_ = Eigen::Vector4d::Zero();
  Eigen::Vector4d thrust_disturbance_ = Eigen::Vector4d::Zero();
  double wave_frequency_rad_s_ = 0.0;
  double wave_force_std_N_ = 0.0;
};

/// Backstepping with an estimator.
class BacksteppingController final : public QuadrotorController {
 public:
  /// `compensates`: subtracts the estimate, T − d̂, or feeds the estimated world force forward. The
  /// horizontal force is that forecast for `lead_s` from now, since the vehicle must turn first.
  BacksteppingController(const Backstepping& law, std::shared_ptr<QuadrotorEstimator> estimator,
                         bool compensates, double lead_s = 0.0);

 private:
  Eigen::Vector4d wrench(double time_s) override;

  double lead_s_;
};

}  // namespace breakwater
