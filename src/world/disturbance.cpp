#include <breakwater/world/disturbance.h>

#include <breakwater/math/functions.h>

namespace breakwater {

double Disturbance::value(double time_s) const {
  const double elapsed_s = time_s - start_s;
  if (elapsed_s < 0.0) return 0.0;
  switch (kind) {
    case DisturbanceKind::none:
      return 0.0;
    case DisturbanceKind::step:
      return amplitude;
    case DisturbanceKind::ramp:
      return amplitude * elapsed_s;
    case DisturbanceKind::sine:
      return amplitude * math::sin(frequency_rad_s * elapsed_s);
  }
  return 0.0;
}

double Disturbance::rate(double time_s) const {
  const double elapsed_s = time_s - start_s;
  if (elapsed_s < 0.0) return 0.0;
  switch (kind) {
    case DisturbanceKind::none:
    case DisturbanceKind::step:
      return 0.0;
    case DisturbanceKind::ramp:
      return amplitude;
    case DisturbanceKind::sine:
      return amplitude * frequency_rad_s * math::cos(frequency_rad_s * elapsed_s);
  }
  return 0.0;
}

}  // namespace breakwater
