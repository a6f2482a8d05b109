// breakwater report: pages about a user's own runs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/references.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// The reference values of a run by metric. Empty unless the run has the settings of one of the
/// project's own cases: other settings make the comparison meaningless.
std::map<std::string, PublishedValue> printed_of(const Catalogue& catalogue, const SavedRun& run);

/// One page about some runs: replay, changed keys, signals of the shot list in its time window,
/// other signals, metrics and printed values. Appends to `notes` one line for each missing part of
/// a replay.
std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       bool with_replay, std::vector<std::string>& notes);

struct ShownMetric {
  Metric metric;
  std::string about;    ///< its definition, for a tooltip
  bool is_key = false;  ///< one of the four to six that say most
};

/// The key ones first: those of the shot list's page, else the scenario's main metrics and those
/// after them.
std::vector<ShownMetric> shown_metrics(const Catalogue& catalogue, const std::string& scenario,
                                       const ShotList& shots, const std::vector<Metric>& metrics);

/// A figure for each chart, which begins with the window.
PageData figures_of(const std::vector<PageChart>& charts, const std::optional<Window>& window);
/// Folds charts away that say less.
void add_other_charts(PageData& blocks, const std::string& id, const std::vector<PageChart>& charts,
                      const std::optional<Window>& window);

/// The lines of a metric's cell: "thesis 2.83", and whether the measured value agrees.
PageData printed_lines(const PublishedValue& reference, double measured);

/// A run's shot list; an empty one where there is none that can be read.
ShotList shots_of(const Catalogue& catalogue, const SavedRun& run);

/// `report`, `compare` and `replay`. Exit statuses: 0 success, 1 an internal error, 2 usage or
/// input, 4 a picture could not be made, 130 interrupted.
std::vector<CommandKind> report_commands();

}  // namespace breakwater
