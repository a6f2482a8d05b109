#include <breakwater/program/program.h>
#include <breakwater/recorded/recorded_estimation.h>
#include <breakwater/rigs/quadrotor_parts.h>

#include "axes_catalogue.h"

namespace breakwater {

Catalogue standard_catalogue() {
  Catalogue catalogue = axes_catalogue();
  catalogue.add(quadrotor_kind(
      "quadrotor_waves",
      "underwater quadrotor under JONSWAP waves: nonlinear estimators, backstepping"));
  for (QuadrotorEstimatorKind& kind : quadrotor_estimators()) catalogue.add(std::move(kind));
  for (QuadrotorControllerKind& kind : quadrotor_controllers()) catalogue.add(std::move(kind));
  catalogue.add(estimate_command());
  return catalogue;
}

}  // namespace breakwater
