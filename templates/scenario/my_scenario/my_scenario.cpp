#include "my_scenario.h"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <breakwater/experiment/run_loop.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/record/held_reference.h>
#include <breakwater/sim/friction.h>
#include <breakwater/sim/joint_force.h>

namespace my_scenario_lab {

using namespace breakwater;  // a scenario uses many of its names

// ---- keys --------------------------------------------------------------------------------------

Fields MyScenario::fields() {
  Fields fields;
  bind_model(fields, mjcf_);
  physics_.bind(fields);
  run_.bind(fields);
  fields.number("plant.mass_ratio", mass_ratio_, positive(),
                "masses and inertias of the plant, divided by those of its model file");
  fields.number("plant.viscous_friction_Nms_rad", friction_Nms_rad_, not_negative(),
                "viscous friction of the hinge [N m s/rad]");
  fields.number("sensor.resolution_rad", resolution_rad_, not_negative(),
                "encoder resolution, one count; 0: not quantised [rad]");
  fields.number("nominal.inertia_kgm2", nominal_inertia_kgm2_, positive(),
                "J: nominal inertia of the estimator and the controller [kg m^2]");
  parts_.bind(fields);
  fields.number("task.reference_rad", reference_.value, between(-3.0, 3.0),
                "reference of the angle; 0 is the hanging pose [rad]");
  fields.number("task.reference_from_s", reference_.from_s, not_negative(),
                "time of the step of the reference from 0 [s]");
  fields.choice("push.kind", push_.kind,
                {{"none", DisturbanceKind::none},
                 {"step", DisturbanceKind::step},
                 {"sine", DisturbanceKind::sine}},
                "shape of the push");
  fields.number("push.amplitude_Nm", push_.amplitude, any(),
                "amplitude of the push, against the motor [N m]");
  fields.number("push.frequency_rad_s", push_.frequency_rad_s, any(),
                "frequency of a sine [rad/s]");
  fields.number("push.start_s", push_.start_s, not_negative(), "time at which the push begins [s]");
  fields.only_for({"push.amplitude_Nm", "push.start_s"}, "push.kind", {"step", "sine"});
  fields.only_for({"push.frequency_rad_s"}, "push.kind", {"sine"});
  fields.number("metrics.from_s", from_s_, not_negative(), "start of the window of the errors [s]");
  fields.number("metrics.to_s", to_s_, not_negative(), "end of the window of the errors [s]");
  fields.number("metrics.settled_within_rad", settled_within_rad_, positive(),
                "distance from the reference within which the pendulum counts as settled [rad]");
  rows_.bind(fields);
  return fields;
}

void MyScenario::check(const Config& config) {
  physics_.check(config, run_);
  parts_.check(config, task());
  config.blame("model.mjcf", [&] {
    const Model model = plant();
    if (model->nv != 1 || model->nu != 1) {
      throw std::invalid_argument(model.file() + ": must have one joint and one actuator");
    }
    const Sensing check_only(model, sensing());
  });
  if (to_s_ <= from_s_) config.fail("metrics.to_s", "must be later than metrics.from_s");
  rows_.check(
      config, [this] { return fields(); }, physics_);
}

// ---- plant -------------------------------------------------------------------------------------

// The model must have the joint "hinge", the actuator "motor" and the sensors "angle" and "rate".
Model MyScenario::plant() const {
  Model model = Model::load_physics(mjcf_);
  model.set_physics(physics_.timestep_s, physics_.integrator);
  model.scale_inertia(mass_ratio_);
  author_friction(model, model.id(mjOBJ_JOINT, "hinge"), friction_Nms_rad_, 0.0);
  model.id(mjOBJ_ACTUATOR, "motor");
  return model;
}

SensingSetup MyScenario::sensing() const {
  SensorChannel angle;
  angle.name = "angle";
  angle.sensor = "angle";
  angle.encoder.quantum = resolution_rad_;
  SensingSetup setup;
  setup.channels = {angle};
  setup.seed = run_.seed;
  return setup;
}

AxisTask MyScenario::task() const {
  AxisTask task;
  task.axis.plant = damped_inertia(nominal_inertia_kgm2_, 0.0);
  task.axis.period_s = physics_.control_period_s;
  task.axis.sensor = {Eigen::VectorXd::Constant(1, resolution_rad_), Eigen::VectorXd::Zero(1)};
  task.axis.units = rotation_units();
  task.reference = reference_;
  return task;
}

// m g l sin q at the reference: the torque that holds the pendulum there.
double MyScenario::hold_torque_Nm(const Model& model) const {
  const int body = model.id(mjOBJ_BODY, "pendulum");
  const double* centre_m = model->body_ipos + 3 * body;
  const double length_m = std::hypot(centre_m[0], centre_m[2]);
  return model->body_mass[body] * -model->opt.gravity[2] * length_m * std::sin(reference_.value);
}

// ---- run ---------------------------------------------------------------------------------------

Recording MyScenario::run(const RunControl& control) const {
  const AxisLoop loop = parts_.make(task());
  Model model = plant();
  const double hold_Nm = hold_torque_Nm(model);
  JointForce push(model, "hinge");
  Simulation sim(std::move(model), *loop.controller, sensing(), physics_.steps_per_sample());
  sim.add(push);

  // The signals of the log: views of variables that are updated at each sample.
  double target_rad = 0.0;
  double push_Nm = 0.0;
  std::vector<Signal> signals = {
      {"qpos", "rad", "the engine's generalised positions", sim.qpos()},
      {"angle_true_rad", "rad", "true angle", view(sim.sensor("angle"))},
      {"rate_true_rad_s", "rad/s", "true velocity", view(sim.sensor("rate"))},
      {"angle_measured_rad", "rad", "sampled angle", view(sim.sample().y)},
      {"target_rad", "rad", "reference of the angle", view(target_rad)},
      {"push_Nm", "N m", "torque of the push, against the motor", view(push_Nm)},
      {"torque_Nm", "N m", "torque of the motor, within its limit", view(sim.actuation())}};
  for (const Signal& signal : loop.controller->signals()) signals.push_back(signal);

  // The rows of the metrics may be of signals that are not in the log.
  std::vector<Signal> of_metrics = signals;
  of_metrics.push_back({"hold_torque_Nm", "N m", "", view(hold_Nm)});
  MetricValues values(rows_, of_metrics, run_.duration_s);
  HeldReference held({reference_.from_s, run_.duration_s}, "the angle", "rad");
  held.ask(reference_.value);

  const auto step = [&](std::int64_t k) {
    push_Nm = push_.value(sim.time_of(k));
    push.hold(-push_Nm);
    sim.step();
  };
  const auto sample = [&](double t) {
    target_rad = reference_.at(t);
    held.add(t, target_rad - sim.qpos()[0]);
  };
  Recording recording = record_run(sim, physics_, physics_.step_at(run_.duration_s) + 1,
                                   std::move(signals), control, step, sample, &values);
  if (!recording.failure) held.warn(recording.warnings);
  return recording;
}

ScenarioKind my_scenario_kind() {
  const auto make = [](const Catalogue& catalogue) -> std::unique_ptr<Scenario> {
    return std::make_unique<MyScenario>(catalogue);
  };
  return {"my_scenario", make, MY_SCENARIO_FOLDER};
}

}  // namespace my_scenario_lab
