#include "on_axes.h"

#include <breakwater/program/scenario_program.h>
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

Catalogue axes_catalogue() {
  Catalogue catalogue = arm_catalogue();
  catalogue.add(cart_position());
  catalogue.add(cart_offset_free());
  catalogue.add(cart_constrained());
  catalogue.add(cart_estimation());
  catalogue.add(motor_estimation());
  catalogue.add(two_inertia());
  catalogue.add(impact_test());
  catalogue.add(axis_kind(
      {"plant", "any plant of hinges and slides, described by its MJCF and a TOML file"}));
  catalogue.add(
      axis_kind({"robot_wall_contact", "force control of a seven-joint arm against a wall"}));
  for (AxisEstimatorKind& kind : published_estimators()) catalogue.add(std::move(kind));
  for (AxisControllerKind& kind : axis_controllers()) catalogue.add(std::move(kind));
  for (PlantControllerKind& kind : plant_controllers()) catalogue.add(std::move(kind));
  return catalogue;
}

}  // namespace breakwater
