#include "axes_catalogue.h"

#include <breakwater/program/scenario_program.h>
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {

Catalogue axes_catalogue() {
  Catalogue catalogue = arm_catalogue();
  catalogue.add(
      axis_kind({.name = "cart_position",
                 .summary = "position control of a cart with friction, quantised drive and encoder",
                 .axis = cart_axis(),
                 .totals = qp_totals}));
  catalogue.add(axis_kind({.name = "cart_offset_free",
                           .summary = "predictive control of a cart under input and output "
                                      "disturbance: the remaining error",
                           .axis = cart_axis(),
                           .controller = "mpc",
                           .disturbance = DisturbanceKind::step,
                           .totals = qp_totals}));
  catalogue.add(cart_constrained());
  catalogue.add(cart_estimation());
  catalogue.add(axis_kind(
      {.name = "motor_estimation",
       .summary = "disturbance estimators on a motor: encoder quantisation and white noise",
       .axis = motor_axis(),
       .controller = "pd"}));
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
