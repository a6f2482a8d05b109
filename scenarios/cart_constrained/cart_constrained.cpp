#include "cart_constrained/cart_constrained.h"

namespace breakwater {

Fields CartConstrained::fields() {
  Fields fields;
  fields.choice("condition", condition_,
                {{"A", CartCondition::A},
                 {"B", CartCondition::B},
                 {"C", CartCondition::C},
                 {"D", CartCondition::D},
                 {"E", CartCondition::E}},
                "A: nominal. B, C: a force of 1 N or 2 N. D, E: half or one and a half times the "
                "nominal mass");
  plant_.bind(fields);
  fields.number("start.position_m", start_position_m_, any(),
                "position of the cart at the start [m]");
  fields.number("start.velocity_m_s", start_velocity_m_s_, any(),
                "velocity of the cart at the start [m/s]");
  parts_.bind(fields);
  fields.number("observer.start_position_m", estimated_start_position_m_, any(),
                "position with which the estimator starts [m]");
  fields.number("observer.start_velocity_m_s", estimated_start_velocity_m_s_, any(),
                "velocity with which the estimator starts [m/s]");
  fields.number("constraint.velocity_m_s", velocity_m_s_, positive(), "bound on |v| [m/s]");
  fields.number("constraint.input_lower_N", input_lower_N_, any(), "lower bound on the input [N]");
  fields.number("constraint.input_upper_N", input_upper_N_, any(), "upper bound on the input [N]");
  fields.number("disturbance.start_s", disturbance_start_s_, not_negative(),
                "in conditions B and C, the time at which the force begins [s]");
  fields.only_for({"disturbance.start_s"}, "condition", {"B", "C"});
  fields.number("metrics.violation_slack", violation_slack_, not_negative(),
                "excess over a limit above which the limit counts as violated [N, m/s]");
  fields.number("metrics.settled_within_m", settled_within_m_, positive(),
                "distance from 0 within which the position counts as settled [m]");
  rows_.bind(fields);
  return fields;
}

AxisPlant CartConstrained::plant() const {
  AxisPlant plant = plant_;
  plant.axis().start_position = start_position_m_;
  plant.axis().start_velocity = start_velocity_m_s_;
  plant.axis().force = disturbance();
  plant.senses_true_state = true;
  if (condition_ == CartCondition::D) plant.inertia_ratio *= 0.5;
  if (condition_ == CartCondition::E) plant.inertia_ratio *= 1.5;
  return plant;
}

Disturbance CartConstrained::disturbance() const {
  Disturbance force{DisturbanceKind::step, 0.0, 0.0, disturbance_start_s_};
  if (condition_ == CartCondition::B) force.amplitude = 1.0;
  if (condition_ == CartCondition::C) force.amplitude = 2.0;
  return force;
}

AxisTask CartConstrained::task() const {
  return {.axis = plant_.nominal(),
          .start_state = {estimated_start_position_m_, estimated_start_velocity_m_s_},
          .senses_true_state = true};
}

void CartConstrained::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
  const bool is_pushed = condition_ == CartCondition::B || condition_ == CartCondition::C;
  check_metrics(config, {.known = {{"push_s", is_pushed ? disturbance_start_s_ : 0.0}}});
}

}  // namespace breakwater
