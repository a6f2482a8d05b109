// What a loop of one axis does at each frequency, as it is designed: from its difference equations.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/linear/state_space.h>
#include <breakwater/rigs/axis_parts.h>

namespace breakwater {

/// Where a loop is probed: by a force r that is added to the command, unknown to the controller
/// and held over a sample; or by n, added to the measured position.
enum class Probe { force, noise };

/// What is looked at: the controller's command u (without the probe), d̂ and v̂. Those of a loop
/// without an estimator are empty, or 0.
template <typename T>
struct LoopOutputs {
  T command{};
  T disturbance{};
  T velocity{};
};

using PulseResponse = LoopOutputs<std::vector<double>>;
using Phasors = LoopOutputs<std::complex<double>>;

/// Σ h(k) e^{−jωkT} of each output.
Phasors frequency_response(const PulseResponse& pulses, double omega_rad_s, double period_s);

/// The loop of one axis: the controller that a scenario chooses, and a linear plant
///     x(k+1) = A x(k) + B (u(k) + r(k)),   y(k) = C x(k − delay) + n(k − delay) ,
/// without limits, rounding and Coulomb friction.
struct AxisLoopDesign {
  const AxisParts* parts = nullptr;
  AxisTask task;
  StateSpace plant;  ///< over one period
  Eigen::Vector2d start_state = Eigen::Vector2d::Zero();
  int delay_samples = 0;
};

/// The responses to a probe of one sample and of unit size.
struct LoopResponse {
  PulseResponse to_force;
  PulseResponse to_noise;
};

/// Either is empty if the other is not: why there is no such response.
struct LoopResponseOrReason {
  std::optional<LoopResponse> response;
  std::string reason;
};

/// What the loop's controller and estimator do is found out, not assumed: a response is one of a
/// linear loop only if responses to a random binary force of amplitude `force` and to −2 times it
/// are as −2, and if a pulse has the same response later (a Kalman filter's gain needs time to
/// settle). `force` and `noise` are sizes of the probes at which that must hold.
LoopResponseOrReason loop_response(const AxisLoopDesign& design, double force, double noise);

}  // namespace breakwater
