#include <breakwater/program/scenario_program.h>
#include <breakwater/rigs/arm_parts.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/thesis/printed_references.h>

#include "on_axes.h"
#include "plant/plant.h"

namespace breakwater {

Catalogue axes_catalogue() {
  Catalogue catalogue;
  catalogue.add(arm_wall_contact());
  catalogue.add(arm_push());
  catalogue.add(cart_position());
  catalogue.add(cart_offset_free());
  catalogue.add(cart_constrained());
  catalogue.add(cart_estimation());
  catalogue.add(motor_estimation());
  catalogue.add(two_inertia());
  catalogue.add(impact_test());
  catalogue.add(plant_kind("plant",
                           "any plant of hinges and slides, described by its MJCF and a "
                           "TOML file"));
  catalogue.add(
      plant_kind("robot_wall_contact", "force control of a seven-joint arm against a wall"));
  for (ArmControllerKind& kind : arm_controllers()) catalogue.add(std::move(kind));
  for (ContactLawKind& kind : contact_laws()) catalogue.add(std::move(kind));
  for (FrictionKind& kind : friction_laws()) catalogue.add(std::move(kind));
  for (AxisEstimatorKind& kind : axis_estimators()) catalogue.add(std::move(kind));
  for (AxisControllerKind& kind : axis_controllers()) catalogue.add(std::move(kind));
  for (PlantControllerKind& kind : plant_controllers()) catalogue.add(std::move(kind));
  catalogue.add(printed_references());
  return catalogue;
}

}  // namespace breakwater
