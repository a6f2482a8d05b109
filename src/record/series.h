// A value over time, as in a log.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace breakwater {

/// Increasing times and their values. It is linear between them and constant outside.
struct Series {
  std::vector<double> times_s;
  std::vector<double> values;

  double at(double time_s) const {
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    if (after == times_s.begin()) return values.front();
    if (after == times_s.end()) return values.back();
    const auto i = static_cast<std::size_t>(after - times_s.begin());
    const double part = (time_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
    return values[i - 1] + part * (values[i] - values[i - 1]);
  }
};

}  // namespace breakwater
