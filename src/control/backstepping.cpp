#include <breakwater/control/backstepping.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/riccati.h>

namespace breakwater {
namespace {

// Lower bound of cos φ cos θ. Up to 60° on both axes, the thrust rises with the tilt.
constexpr double kSmallestCosine = 0.25;

double away_from_zero(double value, double floor) {
  return std::copysign(std::max(std::abs(value), floor), value);
}

double acceleration(const BacksteppingGains& alpha, const Eigen::Matrix<double, 12, 1>& motion,
                    int axis, double Z1) {
  const double Z2 = motion(axis + 6) - alpha(axis) * Z1;
  return Z1 - alpha(axis) * (Z2 + alpha(axis) * Z1) - alpha(axis + 6) * Z2;
}

}  // namespace

BacksteppingGains printed_gains() {
  BacksteppingGains alpha;
  alpha << 0.3152, 0.3152, 3.1285, 1.9756, 1.9756, 6.9341, 0.8908, 0.8908, 2.9469, 2.0775, 2.0775,
      3.6262;
  return alpha;
}

BacksteppingGains dlqr_gains(const QuadrotorParameters& parameters, double period_s,
                             double weight_z) {
  Eigen::Matrix<double, 12, 1> weights;
  weights << 1e2, 1e2, weight_z, 4e3, 4e3, 5e4, 1, 1, 1e2, 1e3, 1e3, 5e2;
  const StateSpace sampled = zero_order_hold(quadrotor_axes(parameters), period_s);
  const LqrDesign lqr = dlqr(sampled.A, sampled.B, Eigen::MatrixXd(weights.asDiagonal()),
                             1e3 * Eigen::MatrixXd::Identity(6, 6));
  BacksteppingGains alpha;
  alpha << lqr.K.leftCols(6).diagonal(), lqr.K.rightCols(6).diagonal();
  return alpha;
}

BacksteppingGains retuned_gains(const QuadrotorParameters& parameters, double period_s) {
  BacksteppingGains alpha = dlqr_gains(parameters, period_s);
  alpha(0) = alpha(1) = alpha(6) = alpha(7) = 1.0;
  alpha(3) = alpha(4) = alpha(9) = alpha(10) = 6.0;
  return alpha;
}

Eigen::Vector4d Backstepping::wrench(const Eigen::Matrix<double, 12, 1>& motion,
                                     const Eigen::Vector3d& force) const {
  const double clamp_m = position_clamp_m();
  const AttitudeTrig attitude(motion.segment<3>(3));
  Eigen::Vector3d f = nominal_.weight_and_coriolis(attitude, Vector6d::Zero()) - force;
  for (int axis = 0; axis < 3; ++axis) {
    const double Z1 = std::clamp(design_.reference(axis) - motion(axis), -clamp_m, clamp_m);
    f(axis) +=
        nominal_.parameters().moving_mass_kg() * acceleration(design_.alpha, motion, axis, Z1);
  }
  return wrench_of_force(motion, attitude, f);
}

double Backstepping::position_clamp_m() const {
  return design_.position_clamp_m > 0.0 ? design_.position_clamp_m
                                        : std::numeric_limits<double>::infinity();
}

Eigen::Vector4d Backstepping::wrench_of_force(const Eigen::Matrix<double, 12, 1>& motion,
                                              const AttitudeTrig& attitude,
                                              const Eigen::Vector3d& f) const {
  const double U_z =
      f.z() / away_from_zero(attitude.cos_roll * attitude.cos_pitch, kSmallestCosine);
  const double divisor = std::max(U_z, design_.thrust_floor_N);
  const double limit = design_.tilt_limit_rad;
  const Eigen::Vector3d attitude_reference(
      design_.reference(3) + std::clamp(-f.y() / divisor, -limit, limit),
      design_.reference(4) + std::clamp(f.x() / divisor, -limit, limit), design_.reference(5));
  Eigen::Vector4d U;
  U(0) = U_z;
  for (int i = 0; i < 3; ++i) {
    U(1 + i) = nominal_.parameters().inertia_kgm2(i) *
               acceleration(design_.alpha, motion, 3 + i, attitude_reference(i) - motion(3 + i));
  }
  return U;
}

double slowest_pole(const Backstepping& law, const QuadrotorModel& plant) {
  using Motion = Eigen::Matrix<double, 12, 1>;
  const auto rate = [&](const Motion& motion) {
    const Vector6d velocity = motion.tail<6>();
    Motion d;
    d << velocity, plant.acceleration(AttitudeTrig(motion.segment<3>(3)), velocity,
                                      law.wrench(motion, Eigen::Vector3d::Zero()));
    return d;
  };
  constexpr double kStep = 1e-6;
  Motion rest = Motion::Zero();
  rest.head<6>() = law.design().reference;
  Eigen::MatrixXd A(12, 12);
  for (int j = 0; j < 12; ++j) {
    const Motion e = kStep * Motion::Unit(j);
    A.col(j) = (rate(rest + e) - rate(rest - e)) / (2.0 * kStep);
  }
  const auto left_of = [](const auto& one, const auto& other) { return one.real() < other.real(); };
  return std::ranges::max(eigenvalues(A), left_of).real();
}

QuadrotorController::QuadrotorController(const Backstepping& law,
                                         std::shared_ptr<QuadrotorEstimator> estimator)
    : law_(law),
      estimator_(std::move(estimator)),
      to_thrusts_(thruster_matrix(law.nominal().parameters().thruster_arm_m)) {
  publish({"motion_estimate", kMotionUnits, "zeta and its rate, estimated", view(motion_)});
  publish({"thrust_disturbance_estimate_N", "N", "d_T of each thruster, estimated",
           view(thrust_disturbance_)});
  publish({"force_estimate_N", "N", "disturbing force in the world, estimated", view(force_)});
  publish({"wave_frequency_estimate_rad_s", "rad/s",
           "frequency of the wave force that the estimator assumes; 0: none",
           view(wave_frequency_rad_s_)});
  publish({"wave_force_std_estimate_N", "N",
           "standard deviation of the vertical wave force that it assumes; 0: none",
           view(wave_force_std_N_)});
}

void QuadrotorController::reset(const Sample& first) {
  estimator_->reset(first.y.head<6>());
  held_thrusts_.setZero();
}

void QuadrotorController::update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) {
  estimator_->update(held_thrusts_, y.y.head<6>());
  motion_ = estimator_->motion();
  thrust_disturbance_ = estimator_->thrust_disturbance();
  force_ = estimator_->force();
  wave_frequency_rad_s_ = estimator_->wave_frequency_rad_s();
  wave_force_std_N_ = estimator_->wave_force_std_N();

  Eigen::Vector4d thrusts = to_thrusts_.solve(wrench(y.time_s));
  if (compensates_) thrusts -= thrust_disturbance_;
  u = thrusts;
  const double limit = law_.nominal().parameters().thrust_limit_N;
  held_thrusts_ = thrusts.cwiseMax(-limit).cwiseMin(limit);
}

BacksteppingController::BacksteppingController(const Backstepping& law,
                                               std::shared_ptr<QuadrotorEstimator> estimator,
                                               bool compensates, double lead_s)
    : QuadrotorController(law, std::move(estimator)), lead_s_(lead_s) {
  compensates_ = compensates;
}

Eigen::Vector4d BacksteppingController::wrench(double) {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  if (compensates_ && estimator().models_world_force()) {
    force = force_;
    if (lead_s_ > 0.0) force.head<2>() = estimator().force_ahead(lead_s_).head<2>();
  }
  return law().wrench(motion_, force);
}

}  // namespace breakwater
