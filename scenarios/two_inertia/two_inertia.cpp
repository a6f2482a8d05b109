#include "two_inertia/two_inertia.h"

#include <algorithm>
#include <utility>

#include <breakwater/math/float_environment.h>
#include <breakwater/record/window_metrics.h>
#include <breakwater/rigs/predictive_settings.h>

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
    : plant_(load(), catalogue), parts_(catalogue, "pd") {}

std::vector<MetricDefinition> TwoInertiaDrive::metric_definitions() const {
  return with_qp_metrics(
      {{"overshoot_rad", "rad",
        "position_step, reversal: largest distance of the load beyond its last reference"},
       {"settling_time_s", "s",
        "position_step, reversal: time from the last step of the reference until the load stays "
        "within metrics.settled_within_rad of it"},
       {"recovery_time_s", "s",
        "torque_step: time from the step until the load stays within metrics.settled_within_rad of "
        "its reference"},
       {"peak_deviation_rad", "rad",
        "torque_step: largest distance of the load from its reference after the step"},
       {"steady_state_error_rad", "rad",
        "mean of reference minus position of the load, from metrics.from_s to metrics.to_s"},
       {"residual_vibration_rad_s", "rad/s",
        "root mean square of the load's velocity, from metrics.from_s to metrics.to_s"},
       {"rms_torque_Nm", "N m", "root mean square of the motor's torque from task.from_s"},
       {"rmse_load_velocity_rad_s", "rad/s",
        "root mean square error of the estimated velocity of the load from task.from_s. A model "
        "with one inertia takes the motor's velocity for it"},
       {"rmse_disturbance_Nm", "N m",
        "root mean square error of the estimated torque on the load from task.from_s. A model of "
        "the "
        "motor alone takes the spring's torque for it"}});
}

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
}

Recording TwoInertiaDrive::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const AxisTask task = this->task();
  const NominalAxis& nominal = task.axis;
  const AxisLoop loop = parts_.make(task);
  loop.controller->set_watched(control.logs);
  const AxisPlant plant = this->plant();
  const Reference& reference = plant.axis().reference;
  AxisRig rig(plant, *loop.controller);
  rig.know_loop(parts_, task);

  const double end_s = plant.run.duration_s;
  const double last_step_s = kind_ == Kind::reversal ? reversal_s_ : from_s_;
  const double direction = reference.at(end_s) < 0.0 ? -1.0 : 1.0;
  const TimeWindow window = TimeWindow{window_from_s_, plant.judged_to_s}.within(end_s);
  const TimeWindow moved{from_s_}, judged = TimeWindow{last_step_s}.within(end_s);
  WindowStatistics error(window), vibration(window), torque(moved), beyond(judged);
  WindowStatistics velocity_error(moved), disturbance_error(moved);
  SettlingTime settling(TimeWindow{last_step_s, plant.judged_to_s}.within_and_on(end_s),
                        settled_within_rad_);
  const bool has_spring = nominal.E.size() != 0;

  const auto sample = [&](double t) {
    const double missing = reference.at(t) - rig.position();
    error.add(t, missing);
    settling.add(t, missing);
    beyond.add(t, -direction * missing);
    vibration.add(t, rig.velocity());
    torque.add(t, rig.actuation());
    if (!loop.estimates()) return;
    const DisturbanceEstimator::View x = loop.estimator->state();
    const double ratio = plant.axis().transmission.design.ratio;
    const double velocity = has_spring ? x(nominal.controlled + 1) : x(1) / nominal.measured_ratio;
    const double d = loop.estimator->disturbance()(0) * (has_spring ? 1.0 : ratio);
    velocity_error.add(t, velocity - rig.velocity());
    disturbance_error.add(t, d - rig.disturbance());
  };
  const auto measured = [&] {
    std::vector<Metric> metrics;
    if (kind_ == Kind::torque_step) {
      add(metrics, "recovery_time_s", "s", settling.value());
      add(metrics, "peak_deviation_rad", "rad", beyond.peak());
    } else {
      if (const auto largest = beyond.largest()) {
        add(metrics, "overshoot_rad", "rad", std::max(*largest, 0.0));
      }
      add(metrics, "settling_time_s", "s", settling.value());
    }
    add(metrics, "steady_state_error_rad", "rad", error.mean());
    add(metrics, "residual_vibration_rad_s", "rad/s", vibration.rms());
    add(metrics, "rms_torque_Nm", "N m", torque.rms());
    add(metrics, "rmse_load_velocity_rad_s", "rad/s", velocity_error.rms());
    add(metrics, "rmse_disturbance_Nm", "N m", disturbance_error.rms());
    return metrics;
  };
  Recording recording = rig.run(control, rig.signals(), sample, measured);
  if (!recording.failure) add_qp_metrics(*loop.controller, recording);
  return recording;
}

}  // namespace breakwater
