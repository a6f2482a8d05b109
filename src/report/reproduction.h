// Runs what a report of the thesis needs, and nothing twice.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <breakwater/report/experiments.h>
#include <breakwater/report/measurements.h>
#include <breakwater/scenario/catalogue.h>

namespace breakwater {

/// What was measured, by the name of the run: one entry for each of its repetitions.
using Measured = std::map<std::string, std::vector<Measurement>>;

struct Reproduction {
  const Catalogue& catalogue;
  const Experiments& experiments;
  std::vector<const SectionSpec*> sections;
  std::filesystem::path out;
  bool quiet = false;
  const std::atomic<bool>* stop = nullptr;
};

/// The folder that keeps a run and its log: OUT/runs/NAME.
std::filesystem::path run_folder(const std::filesystem::path& out, const std::string& run);

/// Runs everything that the sections refer to, on all cores, the longest first. Numbers go to
/// OUT/measurements.jsonl, runs that figures need to OUT/runs/NAME as well. What is there already
/// for the same configuration, models and program is kept, so a killed process goes on where it
/// was. Throws std::invalid_argument, `FILE:LINE: reason` where a cell asks for what no run of its
/// scenario has; OutputError or Interrupted; a run that fails is a result.
Measured measure(const Reproduction& reproduction);

/// The value of a cell for each repetition; NaN where it was not measured. A metric that a run does
/// not have, but others of its scenario have, is infinite if the cell says that this means never.
std::vector<double> values_of(const CellSpec& cell, const Measured& measured);

/// Median: of an even number of values the mean of the two in the middle.
double median(std::vector<double> values);

}  // namespace breakwater
