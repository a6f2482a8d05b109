// breakwater report: pages about a user's own runs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <breakwater/report/page_chart.h>
#include <breakwater/report/printed_results.h>
#include <breakwater/scenario/catalogue.h>
#include <breakwater/scenario/saved_run.h>

namespace breakwater {

/// All signals of a run as charts over one time axis: what differs by _true, _measured, _hat or
/// _ref alone is in one, and so are a vector's values.
std::vector<PageChart> all_charts(const SavedRun& run, const std::string& id);

/// The printed numbers of a run by our names for them. Empty unless it has the settings of one of
/// the project's own cases: only then do they mean something.
std::map<std::string, PrintedValue> printed_of(const Catalogue& catalogue, const SavedRun& run);

/// One page about some runs: numbers, beside printed ones where there are any, and all signals.
std::string run_report(const Catalogue& catalogue, const std::vector<SavedRun>& runs);

/// How to tell runs apart: by case, else by folder.
std::vector<std::string> labels_of(const std::vector<SavedRun>& runs);

}  // namespace breakwater
