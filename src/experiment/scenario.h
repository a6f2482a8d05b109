// The interface of all scenarios.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/experiment/metric_rows.h>
#include <breakwater/experiment/settings.h>
#include <breakwater/math/interface.h>
#include <breakwater/record/interrupted.h>
#include <breakwater/record/log_stream.h>
#include <breakwater/record/recording.h>
#include <breakwater/sim/model.h>
#include <breakwater/sim/surface_waves.h>

namespace breakwater {

class Catalogue;

/// The link between a running scenario and its caller.
struct RunControl {
  std::function<void(double fraction_done)> progress;  ///< may be empty
  const std::atomic<bool>* stop = nullptr;             ///< ends the run when it becomes true
  bool logs = true;             ///< false: only the metrics count, and the tracks may have no rows
  LogStream* stream = nullptr;  ///< for the tracks, if they are not to be in memory
};

/// A table of all cases over the values of one key.
struct Matrix {
  std::string key;                   ///< empty: no matrix
  std::vector<std::string> values;   ///< values of this key
  std::vector<std::string> metrics;  ///< one table each
};

/// A scenario: settings, and the run that they define. run() depends on nothing else.
class Scenario : public Interface {
 public:
  Scenario() = default;

  virtual std::string name() const = 0;
  /// One line: the subject of the study.
  virtual std::string summary() const = 0;

  /// The most important metrics for short displays, most important first; unsuitable ones are left
  /// out. Empty: the first ones of a run.
  virtual std::vector<std::string> main_metrics() const { return rows_.main(); }

  /// All metrics and costs that a run may have, for the reference. May be empty.
  virtual std::vector<MetricDefinition> metric_definitions() const { return rows_.definitions(); }

  /// The rows of its metrics, valid after learn().
  const MetricRows& metric_rows() const { return rows_; }

  /// The table of --matrix.
  virtual Matrix matrix() const { return {}; }

  /// Looks into a file whose tables decide which keys and metrics there are: a plant of the user's
  /// own has a table for each axis. Comes before fields(). Throws std::invalid_argument
  /// `ORIGIN: KEY: reason`.
  virtual void learn(const Config& config) { rows_.learn(config); }

  /// The keys of the scenario, bound to its settings.
  virtual Fields fields() = 0;
  /// Checks after `fields` has read `config` what single keys cannot show, and makes paths
  /// absolute. Throws std::invalid_argument `ORIGIN: KEY: reason`. A study calls it again after
  /// other numbers were read: all that it sets must depend on them alone.
  virtual void check(const Config& config, const Fields& fields) = 0;
  /// The settings that all scenarios have; valid after reading.
  virtual const RunSettings& run_settings() const = 0;

  /// Warnings before a run with these settings, one line each.
  virtual std::vector<std::string> warnings() const { return {}; }

  /// Runs the simulation. The recording has its failure. Throws Interrupted if asked to stop.
  virtual Recording run(const RunControl& control) const = 0;

  /// The last changes of the model `model.mjcf`, for the run and for its pictures: places a wall
  /// and sets its stiffness, for example. A scenario calls it for its run.
  virtual void prepare_model(Model&) const {}
  /// Changes the pictures during the run, besides the plant's qpos: shows a wall, for example.
  virtual void animate_scene(Model&, double /*time_s*/) const {}
  /// The water surfaces in the pictures.
  virtual std::vector<WavingSurface> waving_surfaces(const Model&) const { return {}; }

 protected:
  /// For a scenario with metrics in its own file. fields() binds the rows and check() checks them.
  explicit Scenario(MetricRows rows) : rows_(std::move(rows)) {}

  MetricRows rows_;
};

}  // namespace breakwater
