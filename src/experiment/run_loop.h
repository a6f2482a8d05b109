// The loop of a run: step, record, report.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include <breakwater/experiment/scenario.h>
#include <breakwater/sim/engine_guard.h>
#include <breakwater/sim/simulation.h>

namespace breakwater {

/// A run's metrics, of what it has been through by now.
using MetricsSoFar = std::function<std::vector<Metric>()>;

/// Calls `step(k)` for k = 0 … steps − 1; reports progress and obeys a request to stop at the
/// start, after the first step (from which on nothing allocates), and now and then. Returns the
/// failure if a step throws RunFailure. `measured`, unless empty, gives the metrics as they are so
/// far; it is called only where somebody wants to see them.
template <typename Step>
std::optional<Failure> run_loop(std::int64_t steps, const RunControl& control, Step&& step,
                                const MetricsSoFar& measured = {}) {
  constexpr std::int64_t kStepsBetweenReports = 10000;
  try {
    for (std::int64_t k = 0; k < steps; ++k) {
      if (k % kStepsBetweenReports == 0 || k == 1) {
        if (control.stop != nullptr && *control.stop) throw Interrupted();
        if (control.measured && measured && k > 0) control.measured(measured());
        if (control.progress) {
          control.progress(static_cast<double>(k) / static_cast<double>(steps));
        }
      }
      step(k);
    }
  } catch (const RunFailure& failure) {
    return Failure{failure.time_s(), failure.what()};
  }
  return std::nullopt;
}

/// A run: at each physics step k < `steps` calls `step(k)`, which steps the simulation, and where
/// the control was sampled in it `sample(time_s)`, after which the signals are logged as track
/// "control" if `control.logs`. A run that does not fail ends with the metrics that `measured`
/// gives; without it they are the caller's to add, and where they are of use further tracks.
template <typename Step, typename Sample>
Recording record_run(const Simulation& simulation, const PhysicsSettings& physics,
                     std::int64_t steps, std::vector<Signal> signals, const RunControl& control,
                     Step&& step, Sample&& sample, const MetricsSoFar& measured = {}) {
  const std::int64_t rows = steps / physics.steps_per_sample() + 1;
  Track log("control", std::move(signals), static_cast<std::size_t>(control.logs ? rows : 0));
  Recording recording;
  const auto whole_step = [&](std::int64_t k) {
    step(k);
    if (!simulation.sampled()) return;
    sample(simulation.time_s());
    if (control.logs) log.append(simulation.time_s());
  };
  recording.failure = run_loop(steps, control, whole_step, measured);
  if (measured && !recording.failure) recording.metrics = measured();
  recording.simulated_s = simulation.time_of(simulation.steps());
  recording.state_hash = simulation.state_hash();
  recording.dropped_samples = simulation.sensing().dropped();
  recording.tracks.push_back(std::move(log));
  return recording;
}

}  // namespace breakwater
