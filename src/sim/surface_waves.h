// The water surface in a model's pictures, as a sum of waves.
#pragma once

#include <string>
#include <vector>

#include <breakwater/sim/model.h>

namespace breakwater {

/// A plane wave, w(t) a cos(k_x x + k_y y − ω t + φ) [m] in the world. Its weight w changes
/// linearly from `weight_before` to `weight_after` between two times.
struct SurfaceWave {
  double amplitude_m = 0.0;
  double wave_x_rad_m = 0.0;
  double wave_y_rad_m = 0.0;
  double omega_rad_s = 0.0;
  double phase_rad = 0.0;
  double weight_before = 1.0;
  double weight_after = 1.0;
  double change_from_s = 0.0;
  double change_to_s = 0.0;

  double weight(double time_s) const;
};

/// A geom whose height in the world is the sum of its waves: a level height field on the world.
struct WavingSurface {
  std::string geom;
  std::vector<SurfaceWave> waves;

  /// The height z [m].
  double elevation(double time_s, double x_m, double y_m) const;
};

/// Sets the surface's height field, level or inverted, to the heights at a time, limited by its
/// size. Throws std::invalid_argument if the world has no such geom or it is no such height field.
void set_heights(Model& model, const WavingSurface& surface, double time_s);

}  // namespace breakwater
