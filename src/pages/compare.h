// breakwater compare: runs of one scenario side by side.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>

namespace breakwater {

/// Selects the parts of the runs to compare. An empty list selects all.
struct CompareChoice {
  std::vector<std::string> metrics;
  std::vector<std::string> signals;  ///< a vector signal stands for all of its values
  std::optional<double> from_s;      ///< time window of the charts; default: from the shot list
  std::optional<double> to_s;
  bool with_replay = true;
};

/// The differences of values from the first, all of one kind. Percentages by default; multiples
/// such as "×8.00" if a value is three to ten times the first or a share of it; else plain
/// differences. An equal value has "same", and a missing one "-".
std::vector<std::string> differences_in_words(const std::vector<std::optional<double>>& values);

/// The metrics and signals of some runs, compared with the first run.
class Comparison {
 public:
  /// Throws std::invalid_argument, with advice in one line, if the runs have different scenarios,
  /// if one failed, or if no run has a chosen name.
  Comparison(const Catalogue& catalogue, std::vector<SavedRun> runs, const CompareChoice& choice);

  /// A plain text table of the values. Below each value: the difference from the first run and the
  /// reference value, if any.
  std::string text(std::size_t width) const;
  std::string csv() const;
  /// The same as JSON. `scenario`; `runs`, each with `label` and `folder`; `metrics`, each with
  /// `name` and `unit`. A metric also has one entry per run in `values`, `differences` (from the
  /// first run) and `printed` (the thesis' number). A missing entry is null.
  std::string json() const;
  /// Appends to `notes` one line for each part of the replay that is missing.
  std::string html(std::vector<std::string>& notes) const;

 private:
  void choose_signals();
  PageChart chart_of(const std::string& signal) const;

  const Catalogue& catalogue_;
  CompareChoice choice_;
  std::vector<SavedRun> runs_;
  std::vector<std::string> labels_;
  std::vector<std::string> names_;  // the metrics as chosen
  PageData rows_;                   // the metrics as on the page
  ShotList shots_;
  std::vector<LineStyle> styles_;
  std::vector<std::string> signals_;
  std::size_t keys_ = 0;  // number of signals_ that are shown at first
};

}  // namespace breakwater
