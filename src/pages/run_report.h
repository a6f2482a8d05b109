// breakwater report: pages about a user's own runs.
#pragma once

#include <kainjow/mustache.hpp>
#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/references.h>
#include <breakwater/experiment/saved_run.h>

namespace breakwater {

/// The reference values of a run by metric. Empty unless it has the settings of one of
/// the project's own cases: only then do they mean something.
std::map<std::string, ReferenceValue> printed_of(const Catalogue& catalogue, const SavedRun& run);

struct RunReportOptions {
  bool with_replay = true;
};

/// One page about some runs: each in three dimensions, what it differs in from its case, the shot
/// list's signals over the shot list's window, all other signals, and its numbers, beside printed
/// ones where there are any. `notes`, one line each, say what of a replay could not be shown.
std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs,
                       const RunReportOptions& options, std::vector<std::string>& notes);

/// The keys in which a run differs from its case, for a template: "keys", and "has_keys" where
/// there are any.
void set_changed_keys(const Catalogue& catalogue, const SavedRun& run,
                      kainjow::mustache::data& section);

}  // namespace breakwater
