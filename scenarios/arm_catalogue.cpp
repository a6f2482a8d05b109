#include <utility>

#include <breakwater/program/scenario_program.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_parts.h>
#include <breakwater/rigs/contact_settings.h>
#include <breakwater/rigs/drive_settings.h>
#include <breakwater/thesis/printed_results.h>

#include "axes_catalogue.h"

namespace breakwater {

Catalogue arm_catalogue() {
  Catalogue catalogue;
  catalogue.add(arm_wall_contact());
  catalogue.add(arm_push());
  for (ArmControllerKind& kind : arm_controllers()) catalogue.add(std::move(kind));
  for (ContactLawKind& kind : contact_laws()) catalogue.add(std::move(kind));
  for (FrictionKind& kind : friction_laws()) catalogue.add(std::move(kind));
  for (AxisEstimatorKind& kind : axis_estimators()) catalogue.add(std::move(kind));
  catalogue.add(printed_references());
  return catalogue;
}

}  // namespace breakwater
