// Ids of a model's elements by their names.
#pragma once

#include <string>

#include <breakwater/sim/model.h>

namespace breakwater {

/// The id of a named element. Throws std::invalid_argument `FILE: has no KIND named "NAME"`.
inline int geom_id(const Model& model, const std::string& name) {
  return model.id(mjOBJ_GEOM, name);
}
inline int site_id(const Model& model, const std::string& name) {
  return model.id(mjOBJ_SITE, name);
}

inline bool has_geom(const Model& model, const std::string& name) {
  return model.has(mjOBJ_GEOM, name);
}

}  // namespace breakwater
