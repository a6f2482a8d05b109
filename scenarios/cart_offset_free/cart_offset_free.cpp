// Scenario cart_offset_free: predictive control under input and output disturbance (2.3.6, 3.3.3).
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

void bind_offsets(Fields& fields, AxisSettings& axis) {
  fields.flag("noise.enabled", axis.has_noise, "add the noise");
  fields.only_where({"noise.std_m", "noise.input_std_N"}, "noise.enabled is true",
                    [&axis] { return axis.has_noise; });
  fields.number("reference.position_m", axis.reference.value, any(),
                "r: reference of the position");
  fields.number("reference.start_s", axis.reference.from_s, not_negative(),
                "time of the step of the reference from 0 to r");
  Disturbance& force = axis.disturbance.shape;
  force.kind = axis.output.kind = DisturbanceKind::step;
  fields.number("disturbance.input_N", force.amplitude, any(),
                "d_i: input disturbance, which opposes the drive");
  fields.number("disturbance.output_m", axis.output.amplitude, any(),
                "d_o: output disturbance, added to the measured position");
  fields.number("disturbance.start_s", force.start_s, not_negative(),
                "time at which both disturbances begin");
}

}  // namespace

// The cart must go to a position and stay there, while a force pushes it and its position sensor
// has an offset. Estimation is faster than control. The question is whether an error remains.
ScenarioKind cart_offset_free() {
  return axis_kind({.name = "cart_offset_free",
                    .summary = "predictive control of a cart under input and output disturbance: "
                               "the remaining error",
                    .axis = cart_axis(),
                    .controller = "mpc",
                    .bind = bind_offsets,
                    .optimises = true});
}

}  // namespace breakwater
