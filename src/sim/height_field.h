// Changes a surface in a model's pictures.
#pragma once

#include <functional>
#include <string>

#include <breakwater/sim/model.h>

namespace breakwater {

/// Sets the height field of a level or inverted geom to z(x, y) in the world [m], limited by its
/// size. The geom is on the world body. Throws std::invalid_argument if the model has no such geom
/// or it is no such height field.
void set_heights(Model& model, const std::string& geom,
                 const std::function<double(double, double)>& height_m);

}  // namespace breakwater
