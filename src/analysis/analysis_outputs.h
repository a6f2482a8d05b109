// The outputs of an analysis: a table on the terminal, CSV and a page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

/// Says why a loop has no designed curve (it is not stable, or not linear), then its hints.
std::vector<std::string> notes(const LoopAnalysis& loop);

/// One column per loop and way (designed, measured); the rows are bandwidth, margins and peaks.
std::string margins_table(const std::vector<LoopAnalysis>& loops, std::size_t width);

/// `cases` are the scenario's, in whose colours the loops are drawn. Writes analysis.csv (one row a
/// loop, way and frequency), margins.csv and report.html into a new folder. Throws
/// OutputError.
void write_analysis(const std::vector<LoopAnalysis>& loops, const std::string& scenario,
                    const std::vector<std::string>& cases, const std::string& command,
                    const AxisUnits& units, const std::filesystem::path& folder);

}  // namespace breakwater
