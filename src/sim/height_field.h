// Moves a surface in a model's pictures.
#pragma once

#include <functional>
#include <string>

#include <breakwater/sim/model.h>

namespace breakwater {

/// Gives the height field of a geom on the world, level or upside down, the height z(x, y) in the
/// world [m], within what its size allows. Throws std::invalid_argument if the model has no such
/// geom, or it is not such a height field.
void set_heights(Model& model, const std::string& geom,
                 const std::function<double(double, double)>& height_m);

}  // namespace breakwater
