// Axes of drawings: from values to positions.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// A linear or logarithmic axis:
///     p(x) = a + (b − a) (s(x) − s(low))/(s(high) − s(low)),  s(x) = x or ln x
class ChartScale {
 public:
  /// Maps [low, high] to the positions a and b. A range of zero width is widened around its value.
  /// A logarithmic axis needs 0 < low ≤ high.
  ChartScale(double low, double high, bool is_log, double a, double b);

  double operator()(double x) const;
  /// p(x) with a = 0 and b = 1, limited to [0, 1].
  double share(double x) const;

  struct Tick {
    double value;
    std::string label;
  };
  /// About `count` round values within the range.
  std::vector<Tick> ticks(int count) const;

 private:
  double low_, high_;
  bool is_log_;
  double a_, b_;
};

/// Whether the range suits a logarithmic axis: it is positive and wider than two and a half
/// decades.
bool is_for_log(double low, double high);

}  // namespace breakwater
