// What every scenario is.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "record/recording.h"
#include "scenario/settings.h"

namespace breakwater {

/// What the outside may see and stop of a running scenario.
struct RunControl {
  std::function<void(double fraction_done)> progress;  ///< may be empty
  const std::atomic<bool>* stop = nullptr;             ///< ends the run when it becomes true
};

/// Thrown by a run that was asked to stop.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
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
};

/// The names of all scenarios, in the order in which they are listed.
std::vector<std::string> scenario_names();

/// A new scenario by name. Throws std::invalid_argument if there is none of that name.
std::unique_ptr<Scenario> make_scenario(const std::string& name);

}  // namespace breakwater
