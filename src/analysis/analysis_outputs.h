// The outputs of an analysis: a table on the terminal, CSV and a page.
#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/signals/axis_units.h>

namespace breakwater {

struct BodeCurve {
  std::vector<double> omega_rad_s;
  std::vector<std::complex<double>> gain;
  std::vector<bool> is_unsure = {};  ///< marks drawn grey; empty: none
};

/// The curves of one loop: a designed line and measured marks. Either may be empty.
struct BodeLoop {
  std::string label;
  Identity look;
  BodeCurve line;
  BodeCurve marks;
  std::optional<LoopMargins> margins = {};  ///< drawn on the line
};

/// Two charts, in dB and degrees. `unit` is the unit of the gain, "" for a number. None if no loop
/// has a curve.
PageData bode_charts(const std::string& id, const std::string& unit,
                     const std::vector<BodeLoop>& loops);

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

inline constexpr const char* kAnalyze = "analyze";

/// `PROGRAM analyze SCENARIO|FILE.toml [OPTION...]`: frequency responses of loops of one axis.
/// argv[0] is the command's name. Returns the exit status.
int analyze_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
