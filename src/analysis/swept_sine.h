// Frequency response of a loop of one axis at one frequency, measured in the simulation.
#pragma once

#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/loop_response.h>

#include <atomic>

namespace breakwater {

struct SineTest {
  Probe probe = Probe::force;
  double omega_rad_s = 0.0;
  double amplitude = 0.0;  ///< amplitude of the probe
  double settle_s = 0.0;   ///< time before the measurement
  const std::atomic<bool>* stop = nullptr;
};

/// The outputs' phasors at the probe's frequency, divided by the probe's.
struct SineResponse {
  double omega_rad_s = 0.0;  ///< rounded so that whole periods have whole samples
  Phasors gain;
  double spread = 0.0;     ///< relative standard deviation of the command's gain between windows
  double saturated = 0.0;  ///< share of the samples with the drive at its limit
};

/// Runs the plant of an axis, its encoder, drive and controller with the probe alone. Other axes
/// are under their own controllers. If two windows of whole periods agree to 1e-3, returns the
/// second one. Otherwise returns the mean of eight windows, because a loop with an encoder never
/// repeats exactly. Throws RunFailure, ControlFailure or Interrupted.
SineResponse measure_sine(const AxisOfPlant& axis, const SineTest& test);

}  // namespace breakwater
