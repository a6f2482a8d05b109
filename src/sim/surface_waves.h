// A water surface in a model's pictures, as the waves that it is made of.
#pragma once

#include <string>
#include <vector>

#include <breakwater/sim/model.h>

namespace breakwater {

/// One plane wave, a w(t) cos(k_x x + k_y y − ω t + φ) [m] in the world. Its weight w goes from
/// `weight_before` to `weight_after` in a straight line between two times.
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

/// A geom, a level height field on the world, whose height in the world is the sum of its waves.
struct WavingSurface {
  std::string geom;
  std::vector<SurfaceWave> waves;

  /// z [m].
  double elevation(double time_s, double x_m, double y_m) const;
};

/// Gives the surface's height field its heights at that time. Throws as set_heights() of
/// sim/height_field.h.
void set_heights(Model& model, const WavingSurface& surface, double time_s);

}  // namespace breakwater
