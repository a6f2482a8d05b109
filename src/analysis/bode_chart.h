// Gain and phase over frequency, as a drawing in a page.
#pragma once

#include <complex>
#include <string>
#include <vector>

namespace breakwater {

struct BodeCurve {
  std::vector<double> omega_rad_s;
  std::vector<std::complex<double>> gain;
};

/// Of one loop: a line as designed, marks as measured. Either may be empty.
struct BodeLoop {
  std::string label;
  BodeCurve line;
  BodeCurve marks;
};

/// SVG with two panels, in dB and degrees, without a script. Loops are coloured c0, c1, … as the
/// page's style has them. `unit` is the gain's, "" for a number.
std::string draw_bode(const std::string& title, const std::string& unit,
                      const std::vector<BodeLoop>& loops);

}  // namespace breakwater
