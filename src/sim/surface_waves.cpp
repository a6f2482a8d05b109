#include <breakwater/sim/surface_waves.h>

#include <breakwater/math/functions.h>
#include <breakwater/sim/height_field.h>

namespace breakwater {

double SurfaceWave::weight(double time_s) const {
  if (time_s <= change_from_s) return weight_before;
  if (time_s >= change_to_s) return weight_after;
  const double part = (time_s - change_from_s) / (change_to_s - change_from_s);
  return weight_before + part * (weight_after - weight_before);
}

double WavingSurface::elevation(double time_s, double x_m, double y_m) const {
  double sum = 0.0;
  for (const SurfaceWave& wave : waves) {
    const double weight = wave.weight(time_s);
    if (weight == 0.0) continue;
    sum += weight * wave.amplitude_m *
           math::cos(wave.wave_x_rad_m * x_m + wave.wave_y_rad_m * y_m - wave.omega_rad_s * time_s +
                     wave.phase_rad);
  }
  return sum;
}

void set_heights(Model& model, const WavingSurface& surface, double time_s) {
  set_heights(model, surface.geom,
              [&](double x, double y) { return surface.elevation(time_s, x, y); });
}

}  // namespace breakwater
