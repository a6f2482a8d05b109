#include <breakwater/rigs/axis_settings.h>

#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <utility>

#include <breakwater/sim/friction.h>

namespace breakwater {

Axis motor_axis() {
  return {.name = "",
          .joint = "shaft",
          .actuator = "motor",
          .position_sensor = "",
          .channel = "angle",
          .counts_pulses = true,
          .inertia_name = "inertia",
          .inertia_suffix = "kgm2",
          .friction_suffix = "Nms_rad",
          .units = rotation_units()};
}

Axis cart_axis() {
  return {.name = "",
          .joint = "rail",
          .actuator = "drive",
          .position_sensor = "",
          .channel = "position",
          .counts_pulses = false,
          .inertia_name = "mass",
          .inertia_suffix = "kg",
          .friction_suffix = "Ns_m",
          .units = translation_units()};
}

void AxisSettings::bind(Fields& fields) {
  const Fields::Under under(fields, axis.prefix());
  const AxisUnits& u = axis.units;
  const auto key = [](const std::string& stem, const std::string& suffix) {
    return stem + "_" + suffix;
  };
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
  drive.bind(fields, u);
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
  scale.bind(fields, "encoder.", u);
  fields.number("noise." + key("std", u.position_suffix), noise_std, not_negative(),
                "standard deviation of the measurement's white noise [" + u.position + "]");
  fields.number("noise." + key("input_std", u.force_suffix), input_noise_std, not_negative(),
                "standard deviation of a random force, constant in each sample [" + u.force + "]");
  fields.count("sensor.delay_samples", delay_samples, between(0, 1e6),
               "delay of the measurement in control periods");
  transmission.bind(fields, u, axis.inertia_suffix, axis.friction_suffix);
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

Encoder AxisSettings::encoder() const {
  Encoder encoder = {.quantum = quantum(),
                     .phase = encoder_phase,
                     .origin = encoder_origin,
                     .rounding = encoder_rounding};
  scale.apply(encoder);
  return encoder;
}

void AxisPlant::bind(Fields& fields) {
  bind_model(fields, mjcf);
  physics.bind(fields);
  timing.bind(fields);
  run.bind(fields);
  const std::string inertia = axis().axis.inertia_name;
  fields.number("plant." + inertia + "_ratio", inertia_ratio, positive(),
                "the plant's " + inertia + ", divided by that of its model file");
  for (AxisSettings& one : axes) one.bind(fields);
  std::vector<std::string> channels;
  for (const AxisSettings& one : axes) channels.push_back(one.axis.channel);
  faults.bind(fields, fmt::format("{}", fmt::join(channels, ", ")));
}

NominalAxis AxisPlant::nominal(std::size_t i) const {
  const AxisSettings& one = axes[i];
  NominalAxis axis{.period_s = physics.control_period_s,
                   .force_limit = one.force_limit(),
                   .sensor = {Eigen::VectorXd::Constant(1, one.quantum()),
                              Eigen::VectorXd::Constant(1, one.noise_std), one.encoder_rounding},
                   .pulses_per_revolution = one.pulses_per_revolution(),
                   .units = one.axis.units};
  one.transmission.describe(axis, one.nominal_inertia, one.nominal_friction);
  return axis;
}

Model AxisPlant::load_model() const {
  Model model = Model::load_physics(mjcf);
  model.set_physics(physics.timestep_s, physics.integrator);
  const bool is_alone = axis().axis.name.empty();
  std::vector<std::pair<int, int>> ids;
  for (const AxisSettings& one : axes) {
    ids.emplace_back(model.id(mjOBJ_JOINT, one.axis.joint),
                     model.id(mjOBJ_ACTUATOR, one.axis.actuator));
  }
  const bool is_elastic = axis().transmission.is_elastic();
  if (is_alone && (model->nv != (is_elastic ? 2 : 1) || model->nu != 1)) {
    throw std::invalid_argument(model.file() +
                                (is_elastic ? ": must have two joints" : ": must have one joint") +
                                " and one actuator");
  }
  model.scale_inertia(inertia_ratio);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    author_friction(model, ids[i].first, axes[i].viscous_friction, axes[i].coulomb_friction);
    model.limit_actuator(ids[i].second, axes[i].force_limit());
    axes[i].transmission.author(model, axes[i].axis.joint, axes[i].axis.actuator);
  }
  return model;
}

SensingSetup AxisPlant::sensing() const {
  SensingSetup setup;
  for (const AxisSettings& one : axes) {
    const bool is_motor = one.transmission.is_elastic() && one.transmission.measured == Side::motor;
    const bool is_own = one.axis.position_sensor.empty() || is_motor;
    const std::string& joint = is_motor ? one.transmission.motor_joint : one.axis.joint;
    setup.channels.push_back({.name = one.axis.channel,
                              .sensor = is_own ? joint : one.axis.position_sensor,
                              .reading = is_own ? Reading::joint_position : Reading::component,
                              .disturbance = one.output,
                              .encoder = one.encoder(),
                              .noise_std = one.noise_std,
                              .delay_samples = one.delay_samples});
  }
  const auto add_true = [&](const std::string& what, Reading reading) {
    for (const AxisSettings& one : axes) {
      setup.channels.push_back(
          {.name = one.axis.own(what), .sensor = one.axis.joint, .reading = reading});
    }
  };
  if (senses_true_state) {
    add_true("true position", Reading::joint_position);
    add_true("true velocity", Reading::joint_velocity);
  }
  faults.apply(setup);
  setup.seed = run.seed;
  return setup;
}

void check_plant(const AxisPlant& plant, const Config& config) {
  plant.physics.check(config, plant.run);
  plant.timing.check(config, plant.physics);
  for (const AxisSettings& one : plant.axes) {
    one.drive.check(config.under(one.axis.prefix()), one.coulomb_friction);
  }
  const SensingSetup sensing = plant.sensing();
  plant.faults.check(config, sensing.channels);
  for (std::size_t i = 0; i < plant.axes.size(); ++i) {
    try {
      plant.nominal(i);
    } catch (const WrongKey& wrong) {
      config.under(plant.axes[i].axis.prefix()).fail(wrong.key(), wrong.what());
    }
  }
  const Model model = plant.load_model();
  for (const AxisSettings& one : plant.axes) {
    if (one.transmission.is_elastic()) one.transmission.make(model, one.axis.joint);
  }
  const Sensing check_only(model, sensing);
}

StateSpace linear_axis(const AxisPlant& plant) {
  const Model model = plant.load_model();
  const AxisSettings& axis = plant.axis();
  return axis.transmission.linear(model, axis.axis.joint, axis.viscous_friction);
}

}  // namespace breakwater
