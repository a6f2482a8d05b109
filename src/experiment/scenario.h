// What every scenario is.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <breakwater/experiment/settings.h>
#include <breakwater/record/interrupted.h>
#include <breakwater/record/metric_definition.h>
#include <breakwater/record/recording.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/surface_waves.h>

namespace breakwater {

class Catalogue;

/// What the outside may see and stop of a running scenario.
struct RunControl {
  std::function<void(double fraction_done)> progress;  ///< may be empty
  const std::atomic<bool>* stop = nullptr;             ///< ends the run when it becomes true
  bool logs = true;  ///< else the recording's tracks may have no rows: metrics are all that counts
  /// Told beside the progress what is measured so far; may be empty.
  std::function<void(const std::vector<Metric>& so_far)> measured = {};
};

/// A table of all cases over the values of one key.
struct Matrix {
  std::string key;                   ///< empty: there is none
  std::vector<std::string> values;   ///< of the key
  std::vector<std::string> metrics;  ///< one table each
};

/// An experiment: settings, and the run that they define. run() depends on nothing else.
class Scenario {
 public:
  Scenario() = default;
  Scenario(const Scenario&) = delete;
  Scenario& operator=(const Scenario&) = delete;
  virtual ~Scenario() = default;

  virtual std::string name() const = 0;
  /// One line: what it studies.
  virtual std::string summary() const = 0;

  /// Which metrics are shown where there is room for few, the most telling one first; those that
  /// apply. Empty: the first ones that a run has.
  virtual std::vector<std::string> main_metrics() const { return {}; }

  /// Every metric and cost that its runs may report, for the reference. May be empty.
  virtual std::vector<MetricDefinition> metric_definitions() const { return {}; }

  /// What --matrix runs and prints.
  virtual Matrix matrix() const { return {}; }

  /// Its keys, bound to its settings.
  virtual Fields fields() = 0;
  /// What fields cannot check one by one, once they are read; also makes paths absolute. Throws
  /// std::invalid_argument `ORIGIN: KEY: reason`.
  virtual void check(const Config& config) = 0;
  /// Settings that all scenarios have; valid once read.
  virtual const RunSettings& run_settings() const = 0;

  /// What a user should know before a run with these settings, one line each.
  virtual std::vector<std::string> warnings() const { return {}; }

  /// Runs it. Failures of the run are in the recording; throws Interrupted if asked to stop.
  virtual Recording run(const RunControl& control) const = 0;

  /// Makes of the file `model.mjcf` the plant as it looks in a run's pictures: a wall at its place,
  /// say. The settings are read.
  virtual void prepare_scene(Model&) const {}
  /// What changes in the pictures besides the plant's qpos: a wall that is not there yet, say.
  virtual void animate_scene(Model&, double /*time_s*/) const {}
  /// The water's surfaces in the pictures.
  virtual std::vector<WavingSurface> waving_surfaces(const Model&) const { return {}; }
};

}  // namespace breakwater
