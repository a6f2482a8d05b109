// Windows over records for linear least squares on the equation of motion.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <breakwater/identification/axis_model.h>

namespace breakwater {

inline constexpr int kShortestWindow = 8;  ///< rows
inline constexpr int kWindowLengths = 7;   ///< each twice the one before
inline constexpr double kMostStuck = 0.2;  ///< share of a window without motion

/// Rows from one window to the next.
std::size_t hop_of(const AxisData& data, std::size_t rows);

/// Calls use(k, s, length_s, dt) for each row of a window, with s from 0 to 1 and the trapezoids'
/// widths dt.
template <typename Use>
void for_rows(const AxisStretch& stretch, std::size_t first, std::size_t rows, const Use& use) {
  const std::vector<double>& t = stretch.times_s;
  const std::size_t last = first + rows - 1;
  const double length = t[last] - t[first];
  for (std::size_t k = first; k <= last; ++k) {
    const double dt = 0.5 * (t[std::min(k + 1, last)] - t[std::max(k, first + 1) - 1]);
    use(k, (t[k] - t[first]) / length, length, dt);
  }
}

/// The sign of the velocity from `reach` rows on both sides; 0 if it moves by less than two counts.
double direction(const AxisStretch& stretch, std::size_t k, std::size_t reach, double quantum);

/// The input at each row of a stretch: the mean of those that act just before and just after.
std::vector<double> inputs_at_rows(const AxisStretch& stretch, double delay_s);

}  // namespace breakwater
