// Gain and phase over frequency, as charts of a page.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/analysis/loop_margins.h>
#include <breakwater/pages/html_page.h>

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

}  // namespace breakwater
