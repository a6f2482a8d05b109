// Gain and phase over frequency, as a chart in a page.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <breakwater/analysis/loop_margins.h>
#include <breakwater/render/identity.h>

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

/// SVG with two panels, in dB and degrees, without a script. The loops have the page's colours c0,
/// c1, …. `unit` is the unit of the gain, "" for a number.
std::string draw_bode(const std::string& title, const std::string& unit,
                      const std::vector<BodeLoop>& loops);

}  // namespace breakwater
