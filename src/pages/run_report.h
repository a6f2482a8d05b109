// breakwater report: pages about a user's own runs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/recording.h>

namespace breakwater {

/// One page about some runs: replay, changed keys, signals of the shot list in its time window,
/// other signals, metrics and printed values. Appends to `notes` one line for each missing part of
/// a replay.
std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       bool with_replay, std::vector<std::string>& notes);

/// A row of a table for each of the `metrics` of some runs, by name: the metric, and a cell for
/// each run. The rows with "is_key" come first: those of the shot list's page, else the scenario's
/// main metrics and those after them. A cell has "value", "difference" from the first run
/// (`in_words` too) and "printed", null where there is none, and the "lines" below the value.
PageData metric_rows(const Catalogue& catalogue, std::span<const SavedRun> runs,
                     const ShotList& shots, const std::vector<Metric>& metrics,
                     const std::string& first_label);

/// A figure for each chart, which begins with the window.
PageData figures_of(const std::vector<PageChart>& charts, const std::optional<Window>& window);
/// Folds charts away that say less.
void add_other_charts(PageData& blocks, const std::string& id, const std::vector<PageChart>& charts,
                      const std::optional<Window>& window);

/// A run's shot list; an empty one where there is none that can be read.
ShotList shots_of(const Catalogue& catalogue, const SavedRun& run);

/// `report`, `compare` and `replay`. Exit statuses: 0 success, 1 an internal error, 2 usage or
/// input, 4 a picture could not be made, 130 interrupted.
std::vector<CommandKind> report_commands();

}  // namespace breakwater
