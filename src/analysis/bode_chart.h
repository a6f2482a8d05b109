// Gain and phase over frequency, as a chart in a page.
#pragma once

#include <complex>
#include <string>
#include <vector>

namespace breakwater {

struct BodeCurve {
  std::vector<double> omega_rad_s;
  std::vector<std::complex<double>> gain;
};

/// The curves of one loop: a designed line and measured marks. Either may be empty.
struct BodeLoop {
  std::string label;
  BodeCurve line;
  BodeCurve marks;
};

/// SVG with two panels, in dB and degrees, without a script. The loops have the page's colours c0,
/// c1, …. `unit` is the unit of the gain, "" for a number.
std::string draw_bode(const std::string& title, const std::string& unit,
                      const std::vector<BodeLoop>& loops);

}  // namespace breakwater
