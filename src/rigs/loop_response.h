// Frequency response of a loop of one axis, computed from its difference equations.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/linear/state_space.h>
#include <breakwater/rigs/axis_settings.h>

namespace breakwater {

/// The probe of a loop. `force` is a force r on the plant, held over a sample and unknown to the
/// controller. `noise` is an error n of the measured position.
enum class Probe { force, noise };

/// The observed signals: the controller's command u without the probe, d̂ and v̂. Without an
/// estimator, d̂ and v̂ are empty or 0.
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

/// The loop of one axis: the scenario's controller and a linear plant
///     x(k+1) = A x(k) + B (u(k) + r(k)),   y(k) = C x(k − delay) + n(k − delay) ,
/// without limits, rounding and Coulomb friction.
struct AxisLoopDesign {
  const AxisParts* parts = nullptr;
  AxisTask task;
  StateSpace plant;             ///< over one period
  Eigen::VectorXd start_state;  ///< n
  int delay_samples = 0;
};

/// The loop of one axis of a plant.
AxisLoopDesign axis_loop_design(const AxisParts& parts, const AxisTask& task,
                                const AxisPlant& plant, std::size_t axis = 0);

/// Whether the model has joints beside those of the axis. They are held in axis_loop_design().
bool has_other_joints(const AxisPlant& plant, std::size_t axis = 0);

/// Whether the response to a pulse of `force` grows far beyond its beginning within some thousand
/// samples. A controller that limits its own command does not grow.
bool is_unstable(const AxisLoopDesign& design, double force);

/// The responses to a probe of one sample with unit size.
struct LoopResponse {
  PulseResponse to_force;
  PulseResponse to_noise;
};

/// The response, or the reason why there is none.
struct LoopResponseOrReason {
  std::optional<LoopResponse> response;
  std::string reason;
  bool is_unstable = false;
};

/// Determines the response by simulation, with probes of size `force` and `noise`. The loop counts
/// as linear if it responds −2 times as strongly to −2 times a random binary force. A pulse must
/// also have the same response later, after a Kalman filter's gain has settled.
LoopResponseOrReason loop_response(const AxisLoopDesign& design, double force, double noise);

}  // namespace breakwater
