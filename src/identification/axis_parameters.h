// Names of the parameters of an axis in the file of an identification.
#pragma once

#include <breakwater/identification/axis_model.h>

namespace breakwater {

/// A parameter of a rotation.
struct KnownParameter {
  AxisParameter parameter;
  const char* key;   ///< "inertia_kgm2"
  const char* unit;  ///< "kg m^2"
  const char* name;
  double largest_std;  ///< limit for an identifiable parameter, in its scale
};

const KnownParameter& known_parameter(AxisParameter parameter);

inline const char* parameter_key(AxisParameter parameter) {
  return known_parameter(parameter).key;
}
inline const char* parameter_unit(AxisParameter parameter) {
  return known_parameter(parameter).unit;
}

}  // namespace breakwater
