// The outputs of an analysis: a table on the terminal, CSV and a page.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/experiment/catalogue.h>
#include <breakwater/pages/html_page.h>

namespace breakwater {

/// A frequency response in the charts and tables.
struct BodeResponse {
  const char* name;  ///< begins the names of its columns
  std::complex<double> LoopPoint::*value;
  bool needs_estimator;
  std::string title;
  std::string about;
  std::string unit;  ///< unit of the gain; "" for a number
};

/// Two charts, in dB and degrees. None if no loop has a curve.
PageData bode_charts(const BodeResponse& response, const std::vector<LoopAnalysis>& loops,
                     const std::vector<LineStyle>& looks);

inline constexpr const char* kAnalyze = "analyze";

/// `PROGRAM analyze SCENARIO|FILE.toml [OPTION...]`: frequency responses of loops of one axis.
/// argv[0] is the command's name. Returns the exit status.
int analyze_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
