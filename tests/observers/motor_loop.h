// The motor of `motor_estimation`, exactly sampled, without the engine: hundreds of runs per
// second.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <breakwater/observers/disturbance_estimator.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/world/disturbance.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/noise.h>

namespace breakwater::testing {

struct MotorLoop {
  double period_s = 1e-3;  // T_s; the disturbance is held over 1 ms, as the engine holds it
  double inertia = 1.0;    // J, where J_n = 1
  double coulomb = 0.0;    // F_C of a dry friction that the observer does not model [N m]
  Encoder encoder;
  double noise_std = 0.0;  // added to the code
  std::uint64_t seed = 1;
  Disturbance disturbance;
  double duration_s = 10.0;
  double from_s = 5.0;  // beginning of the errors' window
  double k_p = 10.0;
  double k_d = std::sqrt(10.0);
  // Replaces y(k) for the estimator, if set.
  std::function<double(int k, double y)> spoil;
  // Called at each sample with time, position and true velocity.
  std::function<void(double t, double q, double v)> watch;
};

struct MotorErrors {
  double velocity = 0.0;     // RMSE of v̂ in the window [rad/s]
  double disturbance = 0.0;  // RMSE of d̂ [N m]
  double peak = 0.0;         // |q| [rad]
};

/// Moves a shaft with dry friction under a held torque for the time h. The shaft may stop within h
/// and may break away again.
inline void slide(double& q, double& v, double torque, double coulomb, double inertia, double h) {
  while (v != 0.0 || std::abs(torque) > coulomb) {
    const double a = (torque - std::copysign(coulomb, v != 0.0 ? v : torque)) / inertia;
    const bool stops = v * a < 0.0 && -v / a < h;
    const double moving = stops ? -v / a : h;
    q += moving * (v + 0.5 * moving * a);
    v = stops ? 0.0 : v + moving * a;
    h -= moving;
    if (!stops) return;
  }
}

/// Runs the loop u = −k_p q̂ − k_d v̂ + d̂ (Eq. 4.22) with an estimator.
inline MotorErrors run_motor(const MotorLoop& loop, DisturbanceEstimator& estimator) {
  constexpr double kHeld_s = 1e-3;
  const int substeps = std::max(1, static_cast<int>(std::lround(loop.period_s / kHeld_s)));
  const double h = loop.period_s / substeps;
  const int samples = static_cast<int>(std::lround(loop.duration_s / loop.period_s));
  const int from = static_cast<int>(std::lround(loop.from_s / loop.period_s));
  const Noise noise(loop.seed, "angle");
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1), y = u;
  estimator.reset(Eigen::Vector2d::Zero());
  double q = 0.0, v = 0.0;
  MotorErrors errors;
  int counted = 0;
  for (int k = 0; k <= samples; ++k) {
    const double t = k * loop.period_s;
    y(0) = loop.encoder.measure(q) + loop.noise_std * noise(static_cast<std::uint64_t>(k));
    if (loop.spoil) y(0) = loop.spoil(k, y(0));
    estimator.update(u, y);
    if (loop.watch) loop.watch(t, q, v);
    errors.peak = std::max(errors.peak, std::abs(q));
    if (k >= from) {
      errors.velocity += std::pow(estimator.state()(1) - v, 2);
      errors.disturbance += std::pow(estimator.disturbance()(0) - loop.disturbance.value(t), 2);
      ++counted;
    }
    u(0) = -loop.k_p * estimator.state()(0) - loop.k_d * estimator.state()(1) +
           estimator.disturbance()(0);
    for (int i = 0; i < substeps; ++i) {
      const double torque = u(0) - loop.disturbance.value(t + i * h);
      if (loop.coulomb > 0.0) {
        slide(q, v, torque, loop.coulomb, loop.inertia, h);
        continue;
      }
      const double a = torque / loop.inertia;
      q += h * (v + 0.5 * h * a);
      v += h * a;
    }
  }
  errors.velocity = std::sqrt(errors.velocity / counted);
  errors.disturbance = std::sqrt(errors.disturbance / counted);
  return errors;
}

}  // namespace breakwater::testing
