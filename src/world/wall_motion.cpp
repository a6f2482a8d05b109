#include <breakwater/world/wall_motion.h>

#include <algorithm>

namespace breakwater {
namespace {

WallPosition in_table(const std::vector<double>& times_s, const std::vector<double>& positions_m,
                      double time_s) {
  if (time_s < times_s.front()) return {positions_m.front(), 0.0};
  const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  if (next == times_s.end()) return {positions_m.back(), 0.0};
  const auto i = static_cast<std::size_t>(next - times_s.begin());
  const double speed_m_s = (positions_m[i] - positions_m[i - 1]) / (times_s[i] - times_s[i - 1]);
  return {positions_m[i - 1] + speed_m_s * (time_s - times_s[i - 1]), speed_m_s};
}

WallPosition along(const Disturbance& path, double time_s) {
  return {path.value(time_s), path.rate(time_s)};
}

}  // namespace

WallPosition WallMotion::at(double time_s) const {
  switch (kind) {
    case WallMotionKind::ramp:
      return along({.kind = DisturbanceKind::ramp, .amplitude = speed_m_s, .start_s = start_s},
                   time_s);
    case WallMotionKind::sine:
      return along({.kind = DisturbanceKind::sine,
                    .amplitude = amplitude_m,
                    .frequency_rad_s = frequency_rad_s,
                    .start_s = start_s},
                   time_s);
    case WallMotionKind::csv:
      return in_table(times_s, positions_m, time_s);
    case WallMotionKind::fixed:
    case WallMotionKind::free:
      break;
  }
  return {};
}

}  // namespace breakwater
