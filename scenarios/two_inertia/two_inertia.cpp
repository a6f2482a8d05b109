#include "two_inertia/two_inertia.h"

namespace breakwater {
namespace {

// The axis is the load. Its motor has the same actuator as models/motor.xml.
Axis load() {
  Axis axis = motor_axis();
  axis.joint = "load";
  return axis;
}

}  // namespace

TwoInertiaDrive::TwoInertiaDrive(const Catalogue& catalogue)
    : AxisScenario(catalogue, "two_inertia", Optimises::yes),
      plant_(load(), catalogue),
      parts_(catalogue, "pd") {}

Fields TwoInertiaDrive::fields() {
  Fields fields;
  plant_.bind(fields);
  parts_.bind(fields);
  fields.choice("task.kind", kind_,
                {{"position_step", Kind::position_step},
                 {"torque_step", Kind::torque_step},
                 {"reversal", Kind::reversal}},
                "step of the load's reference, step of the torque on the load, or a step of the "
                "reference and then its opposite");
  fields.number("task.reference_rad", reference_rad_, any(), "reference of the load [rad]");
  fields.number("task.load_torque_Nm", torque_Nm_, any(), "torque against the load [N m]");
  fields.number("task.from_s", from_s_, not_negative(), "time of the step [s]");
  fields.number("task.reversal_s", reversal_s_, not_negative(),
                "time at which the reference changes its sign [s]");
  fields.number("metrics.from_s", window_from_s_, not_negative(),
                "start of the window of the steady state [s]");
  fields.number("metrics.to_s", plant_.judged_to_s, not_negative(),
                "end of the window of the steady state [s]");
  fields.number("metrics.settled_within_rad", settled_within_rad_, positive(),
                "distance from the reference within which the load counts as settled [rad]");
  fields.only_for({"task.reference_rad"}, "task.kind", {"position_step", "reversal"});
  fields.only_for({"task.load_torque_Nm"}, "task.kind", {"torque_step"});
  fields.only_for({"task.reversal_s", "transmission.backlash_rad"}, "task.kind", {"reversal"});
  rows_.bind(fields);
  return fields;
}

AxisPlant TwoInertiaDrive::plant() const {
  AxisPlant plant = plant_;
  AxisSettings& axis = plant.axis();
  axis.reference.from_s = from_s_;
  if (kind_ == Kind::torque_step) {
    axis.force = {.kind = DisturbanceKind::step, .amplitude = torque_Nm_, .start_s = from_s_};
  } else {
    axis.reference.value = reference_rad_;
  }
  if (kind_ == Kind::reversal) {
    axis.reference.reversed_from_s = reversal_s_;
  } else {
    axis.transmission.design.backlash = 0.0;
  }
  return plant;
}

void TwoInertiaDrive::check(const Config& config) {
  check_plant(plant_, config);
  parts_.check(config, task());
  if (plant_.judged_to_s <= window_from_s_) {
    config.fail("metrics.to_s", "must be later than metrics.from_s");
  }
  if (kind_ == Kind::reversal && reversal_s_ <= from_s_) {
    config.fail("task.reversal_s", "must be later than task.from_s");
  }
  check_metrics(config, {.known = {{"last_step", last_step_s()}}});
}

AxisAdditions TwoInertiaDrive::additions(const AxisRig& rig, const AxisLoop& loop) const {
  struct Load {
    double beyond_rad = 0.0;
    double velocity_hat = 0.0;
    double d_hat = 0.0;
  };
  const auto load = std::make_shared<Load>();
  const NominalAxis nominal = task().axis;
  const double direction = plant().axis().reference.at(plant_.run.duration_s) < 0.0 ? -1.0 : 1.0;
  const double ratio = plant_.axis().transmission.design.ratio;
  AxisAdditions own;
  own.unlogged = {{"beyond_rad", "rad", "distance beyond the reference", view(load->beyond_rad)}};
  if (loop.estimates()) {
    own.unlogged.push_back({"load_velocity_hat_rad_s", "rad/s", "", view(load->velocity_hat)});
    own.unlogged.push_back({"load_d_hat_Nm", "N m", "", view(load->d_hat)});
  }
  own.sample = [load, nominal, direction, ratio, &rig, &loop](double /*time_s*/) {
    load->beyond_rad = -direction * (rig.reference() - rig.position());
    if (!loop.estimates()) return;
    const DisturbanceEstimator::View x = loop.estimator->state();
    const bool has_spring = nominal.E.size() != 0;
    load->velocity_hat = has_spring ? x(nominal.controlled + 1) : x(1) / nominal.measured_ratio;
    load->d_hat = loop.estimator->disturbance()(0) * (has_spring ? 1.0 : ratio);
  };
  return own;
}

}  // namespace breakwater
