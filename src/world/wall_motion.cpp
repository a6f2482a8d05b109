#include <breakwater/world/wall_motion.h>

namespace breakwater {
namespace {

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
    case WallMotionKind::csv: {
      const auto [position_m, rate_m_s] = table.at(time_s);
      return {position_m, rate_m_s};
    }
    case WallMotionKind::fixed:
    case WallMotionKind::free:
      break;
  }
  return {};
}

}  // namespace breakwater
