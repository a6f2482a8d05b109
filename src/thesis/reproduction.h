// Runs everything that a report of the thesis needs, each run once.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/shards.h>
#include <breakwater/thesis/experiments.h>

namespace breakwater {

/// Results by the name of the run, one per repetition.
using Measured = std::map<std::string, std::vector<PointResult>>;

struct Reproduction {
  const Catalogue& catalogue;
  const Experiments& experiments;
  std::vector<const SectionSpec*> sections;
  std::filesystem::path out;
  bool quiet = false;
  const std::atomic<bool>* stop = nullptr;
};

/// The folder of the results, OUT/shards. It identifies the folder of a reproduction.
std::filesystem::path shards_folder(const std::filesystem::path& out);

/// The folder of a run and its log: OUT/runs/NAME.
std::filesystem::path run_folder(const std::filesystem::path& out, const std::string& run);

/// Runs everything that the sections need on all cores. Results go to OUT/shards, runs for figures
/// also to OUT/runs/NAME. Existing results of the same configuration, models and program are kept,
/// so an interrupted process continues. A failed run is a result. Throws OutputError, Interrupted,
/// and std::invalid_argument: `FILE:LINE: reason` if no run of the scenario can have a cell's
/// metric, or `FILE: …` if a model file changed meanwhile.
Measured measure(const Reproduction& reproduction);

/// The value of a cell for each repetition; NaN if not measured. If `absent_is_never` is set, a
/// metric that a run does not have is infinite.
std::vector<double> values_of(const CellSpec& cell, const Measured& measured);

/// sample_median(); NaN if a value is NaN.
double median(std::vector<double> values);

}  // namespace breakwater
