// The water surface in a model's pictures.
#pragma once

#include <string>

#include <breakwater/sim/model.h>
#include <breakwater/world/waves.h>

namespace breakwater {

/// A geom whose height in the world is the elevation of a sea: a level height field on the world.
struct WavingSurface {
  std::string geom;
  ChangingSea sea;
};

/// Sets the surface's height field, level or inverted, to the heights at a time, limited by its
/// size. Throws std::invalid_argument if the world has no such geom or it is no such height field.
void set_heights(Model& model, const WavingSurface& surface, double time_s);

}  // namespace breakwater
