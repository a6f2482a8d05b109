// The contact of two geoms.
#pragma once

#include <string>

#include <breakwater/sim/model.h>

namespace breakwater {

/// Two geoms that may touch.
class GeomContact {
 public:
  /// Throws std::invalid_argument if the model lacks one of them.
  GeomContact(const Model& model, const std::string& geom_1, const std::string& geom_2);

  /// The sum of the normal forces of all their contacts [N], as the engine computed it last.
  double force_N(const Model& model, const mjData& data) const;

 private:
  int geom_1_;
  int geom_2_;
};

}  // namespace breakwater
