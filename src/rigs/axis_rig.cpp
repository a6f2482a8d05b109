#include <breakwater/rigs/axis_rig.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <breakwater/plants/damped_inertia.h>
#include <breakwater/sim/friction.h>

namespace breakwater {
namespace {

Encoder encoder(const AxisSettings& settings) {
  return {.quantum = settings.quantum(),
          .phase = settings.encoder_phase,
          .origin = settings.encoder_origin,
          .rounding = settings.encoder_rounding};
}

Model load_model(const AxisSettings& settings) {
  const Axis& axis = settings.axis;
  Model model = Model::load_physics(settings.mjcf);
  model.set_physics(settings.physics.timestep_s, settings.physics.integrator);
  const int joint = model.id(mjOBJ_JOINT, axis.joint);
  const int actuator = model.id(mjOBJ_ACTUATOR, axis.actuator);
  if (model->nv != 1 || model->nu != 1) {
    throw std::invalid_argument(model.file() + ": must have one joint and one actuator");
  }
  model.scale_inertia(settings.inertia_ratio);
  author_friction(model, joint, settings.viscous_friction, settings.coulomb_friction);
  model.limit_actuator(actuator, settings.force_limit());
  return model;
}

SensingSetup sensing_setup(const AxisSettings& settings, const Disturbance& output) {
  SensingSetup setup;
  setup.channels.push_back({.name = settings.axis.channel,
                            .sensor = settings.axis.position_sensor,
                            .disturbance = output,
                            .encoder = encoder(settings),
                            .noise_std = settings.noise_std,
                            .delay_samples = settings.delay_samples});
  if (settings.senses_true_state) {
    setup.channels.push_back({.name = "true position", .sensor = settings.axis.position_sensor});
    setup.channels.push_back({.name = "true velocity", .sensor = settings.axis.velocity_sensor});
  }
  settings.faults.apply(setup);
  setup.seed = settings.run.seed;
  return setup;
}

}  // namespace

Axis motor_axis() {
  return {.joint = "shaft",
          .actuator = "motor",
          .position_sensor = "shaft_pos",
          .velocity_sensor = "shaft_vel",
          .channel = "angle",
          .counts_pulses = true,
          .inertia_name = "inertia",
          .inertia_suffix = "kgm2",
          .friction_suffix = "Nms_rad",
          .units = rotation_units()};
}

Axis cart_axis() {
  return {.joint = "rail",
          .actuator = "drive",
          .position_sensor = "cart_pos",
          .velocity_sensor = "cart_vel",
          .channel = "position",
          .counts_pulses = false,
          .inertia_name = "mass",
          .inertia_suffix = "kg",
          .friction_suffix = "Ns_m",
          .units = translation_units()};
}

void AxisSettings::bind(Fields& fields) {
  const AxisUnits& u = axis.units;
  const auto key = [](const std::string& stem, const std::string& suffix) {
    return stem + "_" + suffix;
  };
  bind_model(fields, mjcf);
  physics.bind(fields);
  run.bind(fields);
  fields.number("plant." + key(axis.inertia_name, "ratio"), inertia_ratio, positive(),
                "the plant's " + axis.inertia_name + ", divided by that of its model file");
  fields.number("plant." + key("viscous_friction", axis.friction_suffix), viscous_friction,
                not_negative(),
                "viscous friction of the plant [" + u.force + " per " + u.velocity + "]");
  fields.number("plant." + key("coulomb_friction", u.force_suffix), coulomb_friction,
                not_negative(), "Coulomb friction of the plant [" + u.force + "]");
  fields.number("nominal." + key(axis.inertia_name, axis.inertia_suffix), nominal_inertia,
                positive(), "nominal value for the controller and the observer");
  fields.number("nominal." + key("viscous_friction", axis.friction_suffix), nominal_friction,
                not_negative(), "nominal value for the controller and the observer");
  fields.number("drive." + key("limit", u.force_suffix), drive_limit, not_negative(),
                "0: none [" + u.force + "]");
  fields.number("drive." + key("resolution", u.force_suffix), drive_resolution, not_negative(),
                "step of the drive's PWM; 0: not quantised [" + u.force + "]");
  if (axis.counts_pulses) {
    fields.count("encoder.bits", encoder_bits, between(0, 60),
                 "n: the encoder has 2^n pulses per turn of its shaft; 0: not quantised");
    fields.number("encoder.multiplication", encoder_multiplication, positive(),
                  "number of edges that count in a pulse");
    fields.number("encoder.gear_ratio", encoder_gear_ratio, positive(),
                  "turns of the encoder's shaft per turn of the axis");
    fields.only_where({"encoder.multiplication", "encoder.gear_ratio"}, "encoder.bits is not 0",
                      [this] { return encoder_bits != 0; });
  } else {
    fields.number("encoder." + key("resolution", u.position_suffix), encoder_resolution,
                  not_negative(),
                  "encoder resolution, one count; 0: not quantised [" + u.position + "]");
  }
  fields.number("encoder." + key("phase", u.position_suffix), encoder_phase, any(),
                "distance of the start from the middle of a count [" + u.position + "]");
  fields.choice("encoder.origin", encoder_origin,
                {{"counted", EncoderOrigin::counted}, {"calibrated", EncoderOrigin::calibrated}},
                "zero of the encoder: the start (counted), or the true 0 (calibrated)");
  bind_encoder_rounding(fields, "encoder.rounding", encoder_rounding);
  fields.only_where(
      {"encoder." + key("phase", u.position_suffix), "encoder.origin", "encoder.rounding"},
      "the encoder is quantised", [this] { return quantum() != 0.0; });
  fields.number("noise." + key("std", u.position_suffix), noise_std, not_negative(),
                "standard deviation of the measurement's white noise [" + u.position + "]");
  fields.number("noise." + key("input_std", u.force_suffix), input_noise_std, not_negative(),
                "standard deviation of a random force, constant in each sample [" + u.force + "]");
  fields.count("sensor.delay_samples", delay_samples, between(0, 1e6),
               "delay of the measurement in control periods");
  faults.bind(fields, axis.channel);
}

double AxisSettings::pulses_per_revolution() const {
  if (!axis.counts_pulses) return encoder_resolution > 0.0 ? 1.0 / encoder_resolution : 0.0;
  if (encoder_bits == 0) return 0.0;
  return EncoderCounts{static_cast<double>(encoder_bits), encoder_multiplication,
                       encoder_gear_ratio}
      .counts_per_revolution();
}

double AxisSettings::quantum() const {
  if (!axis.counts_pulses) return encoder_resolution;
  if (encoder_bits == 0) return 0.0;
  return EncoderCounts{static_cast<double>(encoder_bits), encoder_multiplication,
                       encoder_gear_ratio}
      .quantum_rad();
}

double AxisSettings::force_limit() const {
  return drive_limit > 0.0 ? drive_limit : std::numeric_limits<double>::infinity();
}

NominalAxis AxisSettings::nominal() const {
  return {.plant = damped_inertia(nominal_inertia, nominal_friction),
          .period_s = physics.control_period_s,
          .force_limit = force_limit(),
          .sensor = {Eigen::VectorXd::Constant(1, quantum()),
                     Eigen::VectorXd::Constant(1, noise_std), encoder_rounding},
          .pulses_per_revolution = pulses_per_revolution(),
          .units = axis.units};
}

void check_axis(const AxisSettings& settings, const Config& config) {
  settings.physics.check(config, settings.run);
  const SensingSetup sensing = sensing_setup(settings, {});
  settings.faults.check(config, sensing.channels);
  const Sensing check_only(load_model(settings), sensing);
}

StateSpace linear_axis(const AxisSettings& settings) {
  const Model model = load_model(settings);
  return damped_inertia(model->dof_M0[0], settings.viscous_friction);
}

AxisRig::AxisRig(const AxisSettings& settings, const AxisDisturbances& disturbances,
                 Controller& controller)
    : units_(settings.axis.units),
      reference_(settings.reference),
      disturbances_(disturbances),
      input_noise_(settings.run.seed, "input"),
      input_noise_std_(settings.input_noise_std),
      steps_per_sample_(settings.physics.steps_per_sample()),
      controller_(controller) {
  Model model = load_model(settings);
  force_ = std::make_unique<JointForce>(model, settings.axis.joint);
  simulation_ = std::make_unique<Simulation>(std::move(model), controller,
                                             sensing_setup(settings, disturbances.position),
                                             steps_per_sample_);
  simulation_->set_pwm(0, Pwm{settings.drive_resolution});
  simulation_->add(*force_);
  simulation_->set_position({&settings.start_position, 1});
  simulation_->set_velocity({&settings.start_velocity, 1});
  position_ = &simulation_->sensor(settings.axis.position_sensor);
  velocity_ = &simulation_->sensor(settings.axis.velocity_sensor);
}

void AxisRig::step() {
  const std::int64_t k = simulation_->steps();
  disturbance_ = disturbances_.force.value(simulation_->time_of(k));
  if (k % steps_per_sample_ == 0 && input_noise_std_ > 0.0) {
    input_noise_value_ =
        input_noise_std_ * input_noise_(static_cast<std::uint64_t>(k / steps_per_sample_));
  }
  force_->hold(input_noise_value_ - disturbance_);
  simulation_->step();
  saturated_ = simulation_->saturated() ? 1.0 : 0.0;
}

std::vector<Signal> AxisRig::signals() const {
  const Simulation& sim = *simulation_;
  std::vector<Signal> signals = {
      {"qpos", units_.position, "the engine's generalised positions", sim.qpos()},
      {"position_true_" + units_.position_suffix, units_.position, "position, true",
       view(*position_)},
      {"velocity_true_" + units_.velocity_suffix, units_.velocity, "velocity, true",
       view(*velocity_)},
      {"d_true_" + units_.force_suffix, units_.force, "true disturbance, which opposes the drive",
       view(disturbance_)},
      {"position_measured_" + units_.position_suffix, units_.position, "sampled position",
       view(sim.sample().y).first(1)},
      {"command_" + units_.force_suffix, units_.force, "commanded input", view(sim.command())},
      {"applied_" + units_.force_suffix, units_.force, "applied input, saturated and rounded",
       view(sim.actuation())},
      {"saturated", "1", "1 where the drive is at its limit", view(saturated_)}};
  for (const Signal& signal : controller_.signals()) signals.push_back(signal);
  return signals;
}

}  // namespace breakwater
