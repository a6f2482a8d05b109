// Frequency response of a loop of one axis, computed from its difference equations.
#pragma once

#include <complex>
#include <optional>
#include <string>

#include <breakwater/linear/state_space.h>
#include <breakwater/rigs/axis_settings.h>

namespace breakwater {

/// The probe of a loop. `force` is a force r on the plant, held over a sample and unknown to the
/// controller. `noise` is an error n of the measured position.
enum class Probe { force, noise };

/// Samples of the observed signals, in columns: the controller's command u without the probe, d̂ and
/// v̂. Without an estimator, d̂ and v̂ are 0.
using PulseResponse = Eigen::Matrix3Xd;

struct Phasors {
  std::complex<double> command;
  std::complex<double> disturbance;
  std::complex<double> velocity;
};

/// Σ h(k) e^{−jωkT} of each output.
Phasors frequency_response(const PulseResponse& pulses, double omega_rad_s, double period_s);

/// The loop of one axis: the scenario's controller and a linear plant
///     x(k+1) = A x(k) + B (u(k − m) + r(k − m)),   y(k) = C x(k − l) + n(k − l) ,
/// without limits, rounding and Coulomb friction. A jitter of the command counts as its mean.
struct AxisLoopDesign {
  const AxisParts* parts = nullptr;
  AxisTask task;
  /// Over one period. Behind the states of linear_axis() come those of the drive's current loop,
  /// and the command before, if it acts on a part of the period.
  StateSpace plant;
  Eigen::VectorXd start_state;    ///< n
  int delay_samples = 0;          ///< l, of the measurement
  int command_delay_samples = 0;  ///< m, the whole periods of the command's delay
  double force = 1.0;             ///< a force that the drive has, for is_unstable()
};

/// The loop of one axis of a plant.
AxisLoopDesign axis_loop_design(const AxisParts& parts, const AxisTask& task,
                                const AxisPlant& plant, std::size_t index = 0);

/// Whether the model has joints beside those of the axis. They are held in axis_loop_design().
bool has_other_joints(const AxisPlant& plant, std::size_t axis = 0);

/// A force that the drive has: 1, but at most a tenth of its limit.
double usual_force(const AxisSettings& axis);

/// Whether the loop has an eigenvalue outside of the unit circle. Each sample multiplies the state
/// of controller, plant and delays by one matrix. So in the end the response to a pulse grows by
/// the largest eigenvalue (power iteration over up to 65 536 samples). A loop that is not linear is
/// unstable if its response runs away.
bool is_unstable(const AxisLoopDesign& design);

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
