// From values to places in a drawing.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// A linear or logarithmic axis:
///     p(x) = a + (b − a) (s(x) − s(low))/(s(high) − s(low)),  s(x) = x or ln x
class ChartScale {
 public:
  /// From low ≤ high to the places a and b. A range without width is widened around its value; a
  /// logarithmic one needs 0 < low.
  ChartScale(double low, double high, bool is_log, double a, double b);

  double operator()(double x) const;
  /// p(x) with a = 0, b = 1, not below 0 nor above 1.
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

/// Whether values from low to high are better read on a logarithmic axis: positive and over more
/// than two and a half decades.
bool is_for_log(double low, double high);

}  // namespace breakwater
