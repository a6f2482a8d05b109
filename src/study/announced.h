// A process that runs points for another one, and tells it on its stdout what it is at.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/known_models.h>
#include <breakwater/study/executor.h>

namespace CLI {
class App;
}

namespace breakwater {

/// What run_isolated() asks of its processes.
struct Announced {
  bool is_on = false;
  std::vector<std::string> known;  ///< "HASH FILE" of models that processes before have read
};

/// Options that no help shows: --announce and --known.
void add_announced_options(CLI::App& app, Announced& announced);

/// The words that ask for it, "HASH FILE" being such.
std::vector<std::string> announced_words(const std::vector<std::string>& known);

/// Makes a run_points() tell: "begin N", "model HASH FILE" of each file once, "key N KEY" and "end
/// N STATUS", a line each. `models` is what the points are made of, and outlives the options; those
/// that are known are read now. Throws std::invalid_argument if one of them has changed.
void announce(const Announced& announced, KnownModels& models, ExecutorOptions& options);

}  // namespace breakwater
