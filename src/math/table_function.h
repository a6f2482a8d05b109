// A function of time that a table gives.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace breakwater::math {

/// Rows of a function: linear between them, constant beyond.
struct TableFunction {
  struct Value {
    double value = 0.0;
    double rate = 0.0;
  };

  std::vector<double> times_s;  ///< rising, at least one
  std::vector<double> values;   ///< as many

  Value at(double time_s) const {
    if (time_s < times_s.front()) return {values.front(), 0.0};
    const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    if (next == times_s.end()) return {values.back(), 0.0};
    const auto i = static_cast<std::size_t>(next - times_s.begin());
    const double rate = (values[i] - values[i - 1]) / (times_s[i] - times_s[i - 1]);
    return {values[i - 1] + rate * (time_s - times_s[i - 1]), rate};
  }
};

}  // namespace breakwater::math

namespace breakwater {

/// Increasing times and their values, as in a log.
using Series = math::TableFunction;

}  // namespace breakwater
