#include "axes_catalogue.h"

#include <breakwater/program/scenario_program.h>
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

void bind_offsets(Fields& fields, AxisSettings& axis) {
  fields.flag("noise.enabled", axis.has_noise, "add the noise");
  fields.only_where({"noise.std_m", "noise.input_std_N"}, "noise.enabled is true",
                    [&axis] { return axis.has_noise; });
  fields.number("reference.position_m", axis.reference.value, any(),
                "r: reference of the position [m]");
  fields.number("reference.start_s", axis.reference.from_s, not_negative(),
                "time of the step of the reference from 0 to r [s]");
  Disturbance& force = axis.disturbance.shape;
  force.kind = axis.output.kind = DisturbanceKind::step;
  fields.number("disturbance.input_N", force.amplitude, any(),
                "d_i: input disturbance, which opposes the drive [N]");
  fields.number("disturbance.output_m", axis.output.amplitude, any(),
                "d_o: output disturbance, added to the measured position [m]");
  fields.number("disturbance.start_s", force.start_s, not_negative(),
                "time at which both disturbances begin [s]");
}

}  // namespace

Catalogue axes_catalogue() {
  Catalogue catalogue = arm_catalogue();
  const auto bind_position = [](Fields& fields, AxisSettings& cart) {
    cart.bind_step(fields);
    fields.number(
        "metrics.high_pass_Hz", cart.high_pass_Hz, positive(),
        "passband of the high-pass behind which the noise of the estimate is measured [Hz]");
  };
  catalogue.add(
      axis_kind({.name = "cart_position",
                 .summary = "position control of a cart with friction, quantised drive and encoder",
                 .axis = cart_axis(),
                 .bind = bind_position,
                 .optimises = true}));
  // The cart must go to a position and stay there, while a force pushes it and its position sensor
  // has an offset. Estimation is faster than control. The question is whether an error remains.
  catalogue.add(
      axis_kind({.name = "cart_offset_free",
                 .summary = "predictive control of a cart under input and output disturbance: "
                            "the remaining error",
                 .axis = cart_axis(),
                 .controller = "mpc",
                 .bind = bind_offsets,
                 .optimises = true}));
  catalogue.add(cart_constrained());
  catalogue.add(cart_estimation());
  const auto bind_disturbance = [](Fields& fields, AxisSettings& axis) {
    axis.bind_disturbance(fields);
  };
  catalogue.add(axis_kind(
      {.name = "motor_estimation",
       .summary = "disturbance estimators on a motor: encoder quantisation and white noise",
       .axis = motor_axis(),
       .controller = "pd",
       .bind = bind_disturbance}));
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
