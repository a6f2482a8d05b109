#include <breakwater/program/program.h>
#include <breakwater/recorded/recorded_estimation.h>

#include "identified.h"
#include "quadrotor_waves/quadrotor_waves.h"

namespace breakwater {

Catalogue standard_catalogue() {
  Catalogue catalogue = axes_catalogue();
  catalogue.add(
      ScenarioKind{"quadrotor_waves", [](const Catalogue& all) -> std::unique_ptr<Scenario> {
                     return std::make_unique<QuadrotorWaves>(all);
                   }});
  for (QuadrotorEstimatorKind& kind : quadrotor_estimators()) catalogue.add(std::move(kind));
  for (QuadrotorControllerKind& kind : quadrotor_controllers()) catalogue.add(std::move(kind));
  catalogue.add(estimate_command());
  catalogue.add(identified_motor());
  catalogue.add(identified_two_inertia());
  return catalogue;
}

}  // namespace breakwater
