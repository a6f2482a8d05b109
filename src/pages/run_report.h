// breakwater report: pages about a user's own runs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/references.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>

namespace breakwater {

/// The reference values of a run by metric. Empty unless the run has the settings of one of the
/// project's own cases: other settings make the comparison meaningless.
std::map<std::string, ReferenceValue> printed_of(const Catalogue& catalogue, const SavedRun& run);

struct RunReportOptions {
  bool with_replay = true;
};

/// One page about some runs: replay, changed keys, signals of the shot list in its time window,
/// other signals, metrics and printed values. Appends to `notes` one line for each missing part of
/// a replay.
std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       const RunReportOptions& options, std::vector<std::string>& notes);

/// Adds "keys", the keys in which a run differs from its case, and "has_keys" to the data of a
/// template.
void set_changed_keys(const Catalogue& catalogue, const SavedRun& run, PageData& section);

}  // namespace breakwater
