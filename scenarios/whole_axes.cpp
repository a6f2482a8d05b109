#include <breakwater/program/scenario_program.h>
#include <breakwater/rigs/axis_parts.h>

namespace breakwater {

Catalogue whole_axes_catalogue() {
  Catalogue catalogue = axes_catalogue();
  for (AxisEstimatorKind& kind : published_estimators()) catalogue.add(std::move(kind));
  return catalogue;
}

}  // namespace breakwater
