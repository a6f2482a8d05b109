// Runs what a report of the thesis needs, and nothing twice.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/study/shards.h>
#include <breakwater/thesis/experiments.h>

namespace breakwater {

/// A run's numbers.
struct Measurement {
  bool failed = false;
  std::string failure;                   ///< "at 3 s: diverged"
  std::map<std::string, double> values;  ///< NaN: the run has it, but it is no finite number
  /// What other runs of its scenario have and this one has not.
  std::set<std::string> absent;
};

/// The numbers of a run that was complete or failed; what is absent is not known yet.
Measurement measurement_of(const PointResult& result);

/// What was measured, by the name of the run: one entry for each of its repetitions.
using Measured = std::map<std::string, std::vector<Measurement>>;

struct Reproduction {
  const Catalogue& catalogue;
  const Experiments& experiments;
  std::vector<const SectionSpec*> sections;
  std::filesystem::path out;
  bool quiet = false;
  const std::atomic<bool>* stop = nullptr;
  bool with_replay = true;  ///< sections show their run in three dimensions
};

/// The folder of the results, OUT/shards: by it a reproduction's folder is known.
std::filesystem::path shards_folder(const std::filesystem::path& out);

/// The folder that keeps a run and its log: OUT/runs/NAME.
std::filesystem::path run_folder(const std::filesystem::path& out, const std::string& run);

/// Runs everything that the sections refer to, on all cores, the longest first. Numbers go to
/// OUT/shards, runs that figures need to OUT/runs/NAME as well. What is there already for the same
/// configuration, models and program is kept, so a killed process goes on where it was. Throws
/// std::invalid_argument: `FILE:LINE: reason` where a cell asks for what no run of its scenario
/// has, `FILE: was changed while it ran: start again`, of a model; OutputError or Interrupted; a
/// run that fails is a result.
Measured measure(const Reproduction& reproduction);

/// The value of a cell for each repetition; NaN where it was not measured. A metric that a run does
/// not have, but others of its scenario have, is infinite if the cell says that this means never.
std::vector<double> values_of(const CellSpec& cell, const Measured& measured);

/// sample_median(); NaN if any value is.
double median(std::vector<double> values);

}  // namespace breakwater
