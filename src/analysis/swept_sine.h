// What a loop of one axis does at one frequency, measured in the simulation.
#pragma once

#include <breakwater/analysis/loop_response.h>
#include <breakwater/rigs/axis_scenario.h>

#include <atomic>

namespace breakwater {

struct SineTest {
  Probe probe = Probe::force;
  double omega_rad_s = 0.0;
  double amplitude = 0.0;  ///< of the probe
  double settle_s = 0.0;   ///< what passes before anything is counted
  const std::atomic<bool>* stop = nullptr;
};

/// The outputs' parts at the probe's frequency, over the probe.
struct SineResponse {
  double omega_rad_s = 0.0;  ///< a little off what was asked for: whole periods in whole samples
  Phasors gain;
  double spread = 0.0;     ///< of the command's gain, from one window to the next, over its amount
  double saturated = 0.0;  ///< at which share of the samples the drive was at its limit
};

/// Runs the scenario's plant, encoder, drive and controller with the probe alone, in windows of
/// whole periods, until two windows agree to 1e-3, or for eight windows, whose mean counts (behind
/// an encoder a loop never repeats itself). Throws RunFailure, ControlFailure or Interrupted.
SineResponse measure_sine(const AxisScenario& scenario, const SineTest& test);

}  // namespace breakwater
