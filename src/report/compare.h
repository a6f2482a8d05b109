// breakwater compare: runs of one scenario side by side.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/report/printed_results.h>
#include <breakwater/scenario/catalogue.h>
#include <breakwater/scenario/saved_run.h>

namespace breakwater {

/// Some runs' metrics and signals. The first run is what the others are compared with.
class Comparison {
 public:
  /// `metrics` and `signals` choose what is compared; empty: all that the runs have in common. A
  /// vector signal stands for all of its values. Throws std::invalid_argument, one line that says
  /// what to do, if the runs are of different scenarios, one failed, or what is chosen is not
  /// there.
  Comparison(const Catalogue& catalogue, std::vector<SavedRun> runs,
             const std::vector<std::string>& metrics, const std::vector<std::string>& signals);

  /// A plain text table: values, and below them the differences from the first run and what the
  /// thesis prints, if it does.
  std::string text(std::size_t width) const;
  std::string csv() const;
  std::string latex() const;
  std::string html() const;
  const std::vector<std::string>& signals() const { return signals_; }

 private:
  std::optional<double> difference(std::size_t run, const std::string& metric) const;

  std::vector<SavedRun> runs_;
  std::vector<std::string> labels_;
  std::vector<std::map<std::string, PrintedValue>> printed_;  // for each run, by metric
  std::vector<Metric> metrics_;                               // of which only names and units count
  std::vector<std::string> signals_;
};

}  // namespace breakwater
