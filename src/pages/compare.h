// breakwater compare: runs of one scenario side by side.
#pragma once

#include <kainjow/mustache.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/references.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>

namespace breakwater {

/// What of the runs is compared; what is empty stands for all.
struct CompareChoice {
  std::vector<std::string> metrics;
  std::vector<std::string> signals;  ///< a vector signal stands for all of its values
  std::optional<double> from_s;      ///< the window of the charts; without: the shot list's
  std::optional<double> to_s;
  bool with_replay = true;
};

/// The differences of a metric's values from the first, all of one kind: percentages; multiples
/// such as "×8.00", if a value is three to ten times the first; else plain differences. An equal
/// value has
/// "=", a missing one "-".
std::vector<std::string> differences_in_words(const std::vector<std::optional<double>>& values);

/// Some runs' metrics and signals. The first run is what the others are compared with.
class Comparison {
 public:
  /// Throws std::invalid_argument, one line that says what to do, if the runs are of different
  /// scenarios, one failed, or what is chosen is in none of them.
  Comparison(const Catalogue& catalogue, std::vector<SavedRun> runs, const CompareChoice& choice);

  /// A plain text table: values, and below them the differences from the first run and the
  /// reference values, if there are any.
  std::string text(std::size_t width) const;
  std::string csv() const;
  /// The same as JSON: `scenario`; of each of `runs` its `label` and `folder`; of each of `metrics`
  /// its `name`, `unit`, and for each run `values`, `differences` from the first and the
  /// value that is `printed` of it, null where there is none.
  std::string json() const;
  std::string latex() const;
  /// `notes`, one line each, say what of the replay could not be shown.
  std::string html(std::vector<std::string>& notes) const;
  const std::vector<std::string>& labels() const { return labels_; }
  const std::vector<Identity>& looks() const { return identities_; }
  const std::vector<std::string>& signals() const { return signals_; }

 private:
  std::optional<double> difference(std::size_t run, const std::string& metric) const;
  std::vector<std::optional<double>> values_of(const std::string& metric) const;
  bool is_common(const std::string& signal) const;
  bool changes(const std::string& signal) const;  // in one of the runs, or between them
  kainjow::mustache::data cells_of(const std::string& metric) const;
  void choose_signals();
  PageChart chart_of(const std::string& signal) const;

  const Catalogue& catalogue_;
  CompareChoice choice_;
  std::vector<SavedRun> runs_;
  std::vector<std::string> labels_;
  std::vector<std::map<std::string, ReferenceValue>> printed_;  // for each run, by metric
  std::vector<Metric> metrics_;  // of which only names and units count
  ShotList shots_;
  std::vector<Identity> identities_;
  std::vector<std::string> signals_;
  std::size_t keys_ = 0;  // of signals_, that are shown at first
};

}  // namespace breakwater
