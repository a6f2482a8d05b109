#include <breakwater/rigs/axis_settings.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <breakwater/config/column_table.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/sim/model.h>

namespace breakwater {

namespace {

// The id of the element that a key names.
int id_of(const Config& own, const char* key, const Model& model, mjtObj kind,
          const std::string& name) {
  if (own.find(key) == nullptr) return model.id(kind, name);  // the scenario gives the name
  return own.blame(key, [&] { return model.id(kind, name); });
}

// The transmission with the motor's angle over the ratio in place of its angle. The command and the
// encoder are then those of the joint for every ratio.
TransmissionSettings at_joint(TransmissionSettings transmission) {
  const double ratio = std::exchange(transmission.design.ratio, 1.0);
  transmission.motor_inertia *= ratio * ratio;
  transmission.motor_friction *= ratio * ratio;
  transmission.design.error_per_turn *= ratio;
  return transmission;
}

}  // namespace

int actuator_id(const Model& model, const Axis& axis) {
  if (axis.actuator != Axis::kJoint) return model.id(mjOBJ_ACTUATOR, axis.actuator);
  // A transmission with a rotor moves it there.
  for (const std::string& joint : {axis.joint, TransmissionSettings().motor(axis.joint)}) {
    if (!model.has(mjOBJ_JOINT, joint)) continue;
    const int id = model.id(mjOBJ_JOINT, joint);
    for (int i = 0; i < model->nu; ++i) {
      if (model.drives(i, id)) return i;
    }
  }
  throw std::invalid_argument(model.file() + ": no actuator drives joint \"" + axis.joint + '"');
}

Axis named_axis(const std::string& name, const std::string& joint, const std::string& actuator,
                bool is_hinge) {
  return {.name = name,
          .joint = joint,
          .actuator = actuator,
          .position_sensor = Axis::kJoint,
          .channel = !name.empty() ? name
                     : is_hinge    ? "angle"
                                   : "position",
          .units = is_hinge ? rotation_units() : translation_units()};
}

Axis motor_axis() {
  return named_axis("", "shaft", "motor", true);
}

Axis cart_axis() {
  return named_axis("", "rail", "drive", false);
}

void AxisSettings::bind_nominal(Fields& fields) {
  const char* const doc = "nominal value for the controller and the observer";
  TwoInertia& nominal = of_motor ? of_motor->nominal : transmission.nominal;
  fields.number("nominal." + axis.units.inertia + "_" + axis.units.inertia_suffix,
                nominal.load_inertia, positive(), doc);
  const std::string friction = "nominal.viscous_friction_" + axis.units.friction_suffix;
  fields.number(friction, nominal.load_friction, not_negative(), doc);
  if (of_motor) fields.standard(friction, {0.0});
}

void AxisSettings::bind_nominal_from(Fields& fields) {
  const AxisUnits& u = axis.units;
  const char* const from = "nominal.from";
  fields.choice(from, nominal_from, {{"model", NominalFrom::model}, {"keys", NominalFrom::keys}},
                "source of the nominal numbers: keys, or the model at the pose of start.keyframe "
                "with all other joints held, and the keys of the transmission");
  fields.standard(from, {std::string("model")});
  fields.only_for(
      {"nominal.motor_inertia_" + u.inertia_suffix,
       "nominal.motor_viscous_friction_" + u.friction_suffix,
       "nominal.stiffness_" + u.stiffness_suffix(), "nominal.damping_" + u.friction_suffix},
      from, {"keys"});
  {
    const Fields::OfPart keys(fields, from, "keys");
    bind_nominal(fields);
  }
}

void AxisSettings::bind(Fields& fields) {
  const Fields::Under under(fields, axis.prefix());
  const AxisUnits& u = axis.units;
  const bool is_named = !axis.name.empty();
  if (!is_named || of_motor) bind_nominal(fields);
  bind_parts(fields);
  if (is_named) {
    if (!of_motor) bind_nominal_from(fields);
    fields.optional_text("joint", axis.joint, "hinge or slide of the model");
    fields.optional_text(
        "actuator", axis.actuator,
        "actuator of the joint or of transmission.motor_joint; a motor with gear 1 "
        "replaces it; joint: it has no name; none: the axis is only measured");
    fields.optional_text("position_sensor", axis.position_sensor,
                         "sensor of the model that measures the position; joint: the joint itself");
  }
  fields.optional_number("start.position_" + u.position, start_position, any(),
                         "distance of the start from the pose of start.keyframe");
  fields.optional_number("start.velocity_" + u.velocity_suffix, start_velocity, any(),
                         "velocity at the start");
  const char* const kind = "reference.kind";
  fields.optional_choice(kind, reference.kind,
                         {{"hold", ReferenceShape::hold},
                          {"step", ReferenceShape::step},
                          {"sine", ReferenceShape::sine},
                          {"csv", ReferenceShape::csv}},
                         "reference of the position: hold the pose of start.keyframe, step from it "
                         "to a value, a sine about it, or a table");
  const std::string value = "reference.value_" + u.position;
  fields.number(value, reference.value, any(), "position after a step; amplitude of a sine");
  if (!of_motor) fields.standard(value, {reference.value});
  fields.optional_number("reference.from_s", reference.from_s, not_negative(),
                         "start of the step, the sine or the table");
  fields.optional_number("reference.frequency_rad_s", reference.frequency_rad_s, any(),
                         "frequency of a sine");
  fields.only_for({value}, kind, {"step", "sine"});
  fields.only_for({"reference.from_s"}, kind, {"step", "sine", "csv"});
  fields.only_for({"reference.frequency_rad_s"}, kind, {"sine"});
  {
    const Fields::OfPart csv(fields, kind, "csv");
    fields.file(
        "reference.file", reference_file,
        "table with the columns time_s, from reference.from_s, and value [" + u.position + "]");
  }
  if (!has_disturbance_keys) return;
  const bool is_step = disturbance.shape.kind == DisturbanceKind::step;
  disturbance.bind(fields, u.force_suffix, u.force);
  fields.standard("disturbance.kind", {std::string(is_step ? "step" : "none")});
  fields.standard("disturbance.amplitude_" + u.force_suffix, {0.0});
  fields.optional_number("disturbance.output_" + u.position, output.amplitude, any(),
                         "d_o: error of the measured position from disturbance.start_s on");
}

void AxisSettings::bind_parts(Fields& fields) {
  const AxisUnits& u = axis.units;
  fields.optional_number("plant.viscous_friction_" + u.friction_suffix, viscous_friction, any(),
                         "viscous friction of the plant; negative: that of the model file");
  fields.optional_number("plant.coulomb_friction_" + u.force_suffix, coulomb_friction, any(),
                         "Coulomb friction of the plant; negative: that of the model file");
  fields.optional_number("drive.limit_" + u.force_suffix, drive_limit, not_negative(),
                         "0: the actuator's ctrlrange, or none");
  fields.optional_number("drive.resolution_" + u.force_suffix, drive_resolution, not_negative(),
                         "step of the drive's PWM; 0: not quantised");
  drive.bind(fields, u);
  if (axis.units.turns()) {
    fields.optional_count("encoder.bits", counts.bits, between(0, 60),
                          "n: the encoder has 2^n pulses per turn of its shaft; 0: not quantised");
    fields.optional_number("encoder.multiplication", counts.multiplication, positive(),
                           "number of edges that count in a pulse");
    fields.optional_number("encoder.gear_ratio", counts.gear_ratio, positive(),
                           "turns of the encoder's shaft per turn of the axis");
    fields.only_with({"encoder.multiplication", "encoder.gear_ratio"}, "encoder.bits");
    fields.optional_number("encoder.counts_per_turn", counts_per_turn, between(0.0, 1e12),
                           "counts per turn of the axis; 0: those of encoder.bits");
    fields.only_where({"encoder.bits", "encoder.multiplication", "encoder.gear_ratio"},
                      "encoder.counts_per_turn is 0", [this] { return counts_per_turn == 0.0; });
  } else {
    fields.optional_number("encoder.resolution_" + u.position, encoder.quantum, not_negative(),
                           "encoder resolution, one count; 0: not quantised");
  }
  fields.optional_number("encoder.phase_" + u.position, encoder.phase, any(),
                         "distance of the start from the middle of a count");
  fields.optional_choice(
      "encoder.origin", encoder.origin,
      {{"counted", EncoderOrigin::counted}, {"calibrated", EncoderOrigin::calibrated}},
      "zero of the encoder: it counts from the start, or is calibrated to the true 0. The two "
      "differ only with a phase");
  bind_encoder_rounding(fields, encoder.rounding);
  fields.only_where({"encoder.phase_" + u.position, "encoder.origin", "encoder.rounding"},
                    "the encoder is quantised", [this] { return quantum() != 0.0; });
  bind_sine(fields, "encoder.eccentricity", u.position, encoder.eccentricity, u,
            "amplitude of the error of a scale that is not centred");
  bind_sine(fields, "encoder.interpolation", u.position, encoder.interpolation, u,
            "amplitude of the error between two lines of the scale");
  fields.optional_flag("noise.enabled", has_noise, "add the noise");
  fields.optional_number("noise.std_" + u.position, noise_std, not_negative(),
                         "standard deviation of the measurement's white noise");
  fields.optional_number("noise.input_std_" + u.force_suffix, input_noise_std, not_negative(),
                         "standard deviation of a random force, constant in each sample");
  fields.only_where({"noise.std_" + u.position, "noise.input_std_" + u.force_suffix},
                    "noise.enabled is true", [this] { return has_noise; });
  fields.optional_count("sensor.delay_samples", delay_samples, between(0, 1e6),
                        "delay of the measurement in control periods");
  of_motor ? of_motor->bind_plant(fields, u) : transmission.bind(fields, u);
}

double AxisSettings::pulses_per_revolution() const {
  if (!axis.units.turns()) return encoder.quantum > 0.0 ? 1.0 / encoder.quantum : 0.0;
  if (counts_per_turn > 0.0) return counts_per_turn;
  return counts.bits == 0 ? 0.0 : counts.counts_per_revolution();
}

double AxisSettings::quantum() const {
  if (!axis.units.turns()) return encoder.quantum;
  const double pulses = pulses_per_revolution();
  return pulses > 0.0 ? 2.0 * std::numbers::pi / pulses : 0.0;
}

double AxisSettings::force_limit() const {
  return drive_limit > 0.0 ? drive_limit : model_limit;
}

void AxisPlant::learn(const Config& config) {
  std::vector<std::string> names = config.names_in("axis");
  std::set<std::string> of_chain;
  if (const auto file = config.text("model.urdf")) {
    chain =
        std::make_shared<PlanarChain>(load_planar_chain(config.find_file_of("model.urdf", *file)));
    for (Eigen::Index i = 0; i < chain->joints(); ++i) {
      const std::string& joint = *of_chain.insert(chain->joint(i).name).first;
      if (std::find(names.begin(), names.end(), joint) == names.end()) names.push_back(joint);
    }
  }
  for (const AxisSettings& one : axes) std::erase(names, one.axis.name);
  if (names.empty() && axes.empty()) {
    config.fail("axis", "there is no table [axis.NAME]: a plant needs at least one axis");
  }
  // Missing keys are reported when all keys are read.
  std::optional<Model> model;
  if (const std::string file = config.text("model.mjcf").value_or(""); !file.empty()) {
    ModelFile wanted(config.find_file_of("model.mjcf", file));
    if (const auto most = config.number("model.most_elements");
        most && *most >= 0.0 && *most < 1e9) {
      wanted.most_elements = static_cast<std::uint64_t>(*most);
    }
    model = Model::load_physics(wanted);
  }
  std::multimap<int, Axis> found;  // by joint
  for (const std::string& name : names) {
    const Config own = config.under("axis." + name + ".");
    const std::string joint_name = own.text("joint").value_or(of_chain.contains(name) ? name : "");
    const std::string motor_name = own.text("transmission.motor_joint").value_or("");
    int joint = -1;
    Axis axis = named_axis(name, joint_name, Axis::kNone, true);
    if (joint_name.empty()) own.fail("joint", "must name a hinge or a slide of the model");
    if (model) {
      const Model& m = *model;
      joint = id_of(own, "joint", m, mjOBJ_JOINT, joint_name);
      axis = named_axis(name, joint_name, Axis::kNone, m->jnt_type[joint] != mjJNT_SLIDE);
      const int driven = motor_name.empty()
                             ? joint
                             : id_of(own, "transmission.motor_joint", m, mjOBJ_JOINT, motor_name);
      for (int i = m->nu - 1; i >= 0; --i) {
        if (!m.drives(i, driven)) continue;
        const std::string found_name = m.name(mjOBJ_ACTUATOR, i);
        axis.actuator = found_name.empty() ? Axis::kJoint : found_name;
        axis.is_replaced = !m.is_motor(i);
      }
      const std::string chosen = own.text("actuator").value_or("");
      if (m.has(mjOBJ_ACTUATOR, chosen)) {
        axis.is_replaced = !m.is_motor(m.id(mjOBJ_ACTUATOR, chosen));
      }
    }
    found.emplace(joint, std::move(axis));
  }
  for (auto& [joint, axis] : found) {
    AxisSettings& one = axes.emplace_back(std::move(axis), *catalogue_);
    if (of_chain.contains(one.axis.name)) {
      one.of_motor.emplace();
      one.axis.channel = "q" + std::to_string(axes.size());
    } else {
      one.reference.kind = ReferenceShape::hold;
    }
  }
  for (const std::string& name : config.names_in("push")) pushes.emplace_back().name = name;
  for (const std::string& name : config.names_in("contact")) {
    contacts.emplace_back(name, *catalogue_);
  }
  for (const auto& [key, entry] : config.entries()) {
    if (!tip && (key.starts_with("tip.") || key.starts_with("force."))) tip.emplace();
  }
}

void AxisPlant::bind(Fields& fields) {
  bind_model(fields, mjcf);
  if (chain) {
    fields.file("model.urdf", urdf,
                "URDF file of a planar arm, the controllers' nominal model: its joints are axes");
  }
  physics.bind(fields);
  timing.bind(fields);
  run.bind(fields);
  fields.optional_number("plant.inertia_ratio", inertia_ratio, positive(),
                         "the plant's inertia, or mass, divided by that of its model file");
  if (axes.empty() || !axis().axis.name.empty()) {
    fields.optional_text("start.keyframe", keyframe,
                         "keyframe of the pose that axes hold and models are linearised about; "
                         "none: the joints' own");
    fields.optional_flag(
        "sensor.true_state", senses_true_state,
        "samples also have the true positions and the true velocities of all axes");
  }
  for (AxisSettings& one : axes) one.bind(fields);
  for (PushSettings& one : pushes) one.bind(fields);
  for (ContactSettings& one : contacts) one.bind(fields);
  if (tip) tip->bind(fields);
  std::vector<std::string> channels;
  for (const AxisSettings& one : axes) channels.push_back(one.axis.channel);
  if (tip) channels.insert(channels.end(), {"force", "force_raw"});
  faults.bind(fields, fmt::format("{}", fmt::join(channels, ", ")), run.duration_s);
}

void AxisPlant::bind_fine(Fields& fields) {
  fields.number("record.fine_from_s", fine_from_s, not_negative(),
                "time from which forces are logged at the physics rate");
  fields.number("record.fine_to_s", fine_to_s, not_negative(),
                "time until which forces are logged at the physics rate");
}

NominalAxis AxisPlant::nominal(std::size_t i) const {
  const AxisSettings& one = axes[i];
  NominalAxis axis{
      .period_s = physics.control_period_s,
      .force_limit = one.force_limit(),
      .sensor = {Eigen::VectorXd::Constant(1, one.quantum()),
                 Eigen::VectorXd::Constant(1, one.measurement_noise()), one.encoder.rounding},
      .pulses_per_revolution = one.pulses_per_revolution(),
      .units = one.axis.units};
  one.transmission.describe(
      axis, one.nominal_from == NominalFrom::model ? one.model_numbers : one.transmission.nominal,
      one.nominal_from);
  return axis;
}

std::vector<std::string> AxisPlant::warnings() const {
  std::vector<std::string> lines;
  std::string replaced;
  for (const AxisSettings& one : axes) {
    if (one.axis.is_replaced) replaced += (replaced.empty() ? "" : ", ") + one.axis.name;
    const TransmissionSettings& transmission = one.transmission;
    if (one.nominal_from == NominalFrom::keys && !one.of_motor &&
        (transmission.is_elastic() || transmission.motor_inertia > 0.0) &&
        transmission.nominal_model == NominalModel::rigid &&
        transmission.nominal.motor_inertia == 0.0) {
      lines.push_back(one.axis.prefix() + "nominal.motor_inertia_" + one.axis.units.inertia_suffix +
                      ": is 0, so nominal.inertia_" + one.axis.units.inertia_suffix +
                      " must be that of load and motor");
    }
  }
  if (!replaced.empty()) {
    lines.push_back("a motor with gear 1 and the limit of its force replaces the actuator of " +
                    replaced + ": a command is a force at the joint");
  }
  return lines;
}

// Checks what a named axis asks of the model, and names the wrong key.
void AxisPlant::check_names(const Model& model, const Config& config) const {
  std::set<int> joints, motors, actuators;
  // Each axis needs its own.
  const auto take = [](const Config& own, const char* key, std::set<int>& taken, int id,
                       const char* reason) {
    if (!taken.insert(id).second) own.fail(key, reason);
  };
  for (const AxisSettings& one : axes) {
    const Config own = config.under(one.axis.prefix());
    const int joint = id_of(own, "joint", model, mjOBJ_JOINT, one.axis.joint);
    if (!model.is_axis(joint)) own.fail("joint", "must be a hinge or a slide");
    own.blame("transmission.motor_joint",
              [&] { one.transmission.check_motor(model, one.axis.joint); });
    take(own, "joint", joints, joint, "has another axis: each joint may have one");
    if (one.transmission.adds_rotor() && !one.axis.is_driven()) {
      own.fail("actuator", "none: a motor that the model lacks needs an actuator of the joint");
    }
    const bool has_motor = one.transmission.is_elastic() && !one.transmission.adds_rotor();
    const std::string& driven = has_motor ? one.transmission.motor_joint : one.axis.joint;
    const int driven_joint = id_of(own, "transmission.motor_joint", model, mjOBJ_JOINT, driven);
    if (has_motor) {
      take(own, "transmission.motor_joint", motors, driven_joint,
           "has another axis: each motor may have one load");
    }
    if (one.axis.is_driven()) {
      const int actuator = one.axis.actuator == Axis::kJoint
                               ? actuator_id(model, one.axis)
                               : id_of(own, "actuator", model, mjOBJ_ACTUATOR, one.axis.actuator);
      take(own, "actuator", actuators, actuator,
           "drives another axis: set \"none\" for an axis that is only measured");
      if (!model.drives(actuator, driven_joint)) {
        if (!has_motor && !one.transmission.motor_joint.empty()) {
          own.fail("transmission.motor_joint",
                   "needs a transmission with a stiffness: a rigid motor has no joint of its own");
        }
        own.fail("actuator",
                 fmt::format("\"{}\" must drive joint \"{}\"", one.axis.actuator, driven));
      }
      for (int other = 0; other < model->nu; ++other) {
        const bool acts =
            model.drives(other, driven_joint) && model->actuator_biastype[other] != mjBIAS_NONE;
        if (acts && other != actuator) {
          own.fail("actuator", fmt::format("joint \"{}\" has a servo besides: remove it", driven));
        }
      }
      const mjtNum* range = model->actuator_ctrlrange + 2 * actuator;
      const bool is_limited = model->actuator_ctrllimited[actuator] != 0;
      if (model.is_motor(actuator) && is_limited && range[0] != -range[1]) {
        own.fail("actuator",
                 '"' + one.axis.actuator + "\" must have a ctrlrange that is symmetric about 0");
      }
    }
    if (!one.axis.measures_joint()) {
      id_of(own, "position_sensor", model, mjOBJ_SENSOR, one.axis.position_sensor);
    }
  }
  for (const AxisSettings& one : axes) {
    if (!one.transmission.is_elastic() || one.transmission.motor_joint != one.axis.joint) continue;
    config.under(one.axis.prefix())
        .fail("transmission.motor_joint", "must be another joint than that of the axis");
  }
}

Model AxisPlant::load_model(const Config* config) const {
  // Contacts may name what is decoration in the file.
  std::vector<std::string> named;
  for (const ContactSettings& one : contacts) named.insert(named.end(), {one.geom_1, one.geom_2});
  Model model = Model::load_physics(mjcf, named);
  model.set_physics(physics.timestep_s, physics.integrator);
  if (config != nullptr) {
    check_names(model, *config);
    check_contacts(model, *config);
    if (tip) check_tip(model, *config);
  }
  for (const AxisSettings& one : axes) {
    if (!one.axis.is_driven()) continue;
    const int actuator = actuator_id(model, one.axis);
    if (!model.is_motor(actuator)) model.make_motor(actuator);
  }
  model.scale_inertia(inertia_ratio);
  if (tip && tip->sensor != Axis::kNone && tip->tool_mass_kg != 0.0) {
    const int sensor = model.id(mjOBJ_SENSOR, tip->sensor);
    model.add_mass(model->site_bodyid[model->sensor_objid[sensor]], tip->tool_mass_kg);
  }
  author_friction(model);  // also of joints that are no axis
  for (const AxisSettings& one : axes) {
    const int joint = model.id(mjOBJ_JOINT, one.axis.joint), dof = model->jnt_dofadr[joint];
    const auto or_file = [](double key, double file) { return key < 0.0 ? file : key; };
    author_friction(model, joint, or_file(one.viscous_friction, model->dof_damping[dof]),
                    or_file(one.coulomb_friction, model->dof_frictionloss[dof]));
    const bool is_driven = one.axis.is_driven();
    const int actuator = is_driven ? actuator_id(model, one.axis) : -1;
    if (is_driven && one.drive_limit > 0.0) model.limit_actuator(actuator, one.force_limit());
    if (is_driven || one.transmission.is_elastic()) {
      one.transmission.author(model, one.axis.joint, actuator);
    }
  }
  for (const ContactSettings& one : contacts) {
    const auto apply = [&] { one.prepare(model); };
    config != nullptr ? config->under(one.prefix()).blame("law", apply) : apply();
  }
  return model;
}

void AxisPlant::check_contacts(const Model& model, const Config& config) const {
  std::map<std::string, std::string> authored;  // the geoms whose parameters a law sets
  std::map<std::pair<std::string, std::string>, std::string> known;
  std::map<std::string, std::string> tilted;  // the walls
  for (const ContactSettings& one : contacts) {
    const Config own = config.under(one.prefix());
    const int first = id_of(own, "geom_1", model, mjOBJ_GEOM, one.geom_1);
    const int second = id_of(own, "geom_2", model, mjOBJ_GEOM, one.geom_2);
    one.check(config, physics);
    const auto [same, is_new] = known.emplace(std::minmax(one.geom_1, one.geom_2), one.name);
    if (!is_new) own.fail("geom_1", "contact \"" + same->second + "\" has the same two geoms");
    if (one.angle_rad() != 0.0) {
      const auto [other, is_first] = tilted.emplace(one.geoms(model).second, one.name);
      if (!is_first) {
        own.fail("wall.angle_rad",
                 fmt::format("contact \"{}\" tilts \"{}\" already", other->second, other->first));
      }
    }
    // A file with the keys of a law means to have one.
    const bool lacks_law = one.is_of_file() && own.find("law") == nullptr;
    for (const auto& [key, entry] : config.entries()) {
      if (!lacks_law || !key.starts_with(one.prefix()) || !entry.given.empty()) continue;
      const std::string rest = key.substr(one.prefix().size());
      if (rest.starts_with("geom_") || rest.starts_with("wall.")) continue;
      config.fail(key, "needs " + one.prefix() + "law");
    }
    const bool may_touch = bits_match(*model.get(), first, second);
    if (one.begins_solid() && one.is_of_engine() && !may_touch && model->npair == 0) {
      own.fail("geom_2", fmt::format("contype and conaffinity let \"{}\" and \"{}\" not touch; a "
                                     "law that is a force, kelvin_voigt_clipped, needs neither",
                                     one.geom_1, one.geom_2));
    }
    for (const std::string& geom : {one.geom_1, one.geom_2}) {
      if (one.is_of_file() || !one.is_of_engine()) continue;
      const auto [other, is_first] = authored.emplace(geom, one.name);
      if (is_first) continue;
      own.fail("law", fmt::format("kelvin_voigt: geom \"{}\" has it in contact \"{}\" too; "
                                  "kelvin_voigt_clipped has a value for each contact",
                                  geom, other->second));
    }
  }
}

void AxisPlant::check_tip(const Model& model, const Config& config) const {
  const auto known = std::ranges::find(contacts, tip->contact, &ContactSettings::name);
  if (known == contacts.end() && tip->contact != Axis::kNone) {
    config.fail("tip.contact", "there is no table [contact." + tip->contact + "]");
  }
  for (const AxisSettings& one : axes) {
    if (one.axis.channel == "force" || one.axis.channel == "force_raw") {
      config.under(one.axis.prefix()).fail("joint", "a sensor of the tip has this axis' name");
    }
  }
  check_multiple(config, "sensor.force_period_s", tip->raw.electronics.period_s, physics.timestep_s,
                 "physics.timestep_s");
  check_multiple(config, "sensor.force_delay_s", tip->raw.electronics.delay_s, physics.timestep_s,
                 "physics.timestep_s");
  if (tip->sensor == Axis::kNone) {
    if (tip->contact != Axis::kNone) return;
    config.fail("tip.contact", "must name a contact, or tip.sensor a sensor");
  }
  const int sensor = id_of(config, "tip.sensor", model, mjOBJ_SENSOR, tip->sensor);
  const int type = model->sensor_type[sensor];
  if (type != mjSENS_FORCE && type != mjSENS_TOUCH) {
    config.fail("tip.sensor", "must be a <force> or a <touch>");
  }
  if (tip->component >= model->sensor_dim[sensor]) {
    config.fail("tip.component", "must be 0: a <touch> has one value");
  }
}

double AxisPlant::coulomb_friction_at_drive(std::size_t i) const {
  const Model model = load_model();
  const TransmissionSettings& transmission = axes[i].transmission;
  const std::string& load = axes[i].axis.joint;
  const double of_load =
      model->dof_frictionloss[model.dof(load)] / std::abs(transmission.design.ratio);
  if (!transmission.is_elastic()) return of_load;
  return of_load + model->dof_frictionloss[model.dof(transmission.motor(load))];
}

Model AxisPlant::model_of_file() const {
  AxisPlant plant = *this;
  plant.inertia_ratio = 1.0;
  if (plant.tip) plant.tip->tool_mass_kg = 0.0;
  for (AxisSettings& one : plant.axes) one.viscous_friction = one.coulomb_friction = -1.0;
  return plant.load_model();
}

Model AxisPlant::nominal_model() const {
  Model model = model_of_file();
  const Eigen::MatrixXd file = joint_inertia(model, pose(model));
  Eigen::MatrixXd M = file;
  const auto set = [&](const std::string& joint, double inertia, double friction) {
    const int dof = model.dof(joint);
    M(dof, dof) = inertia;
    model.get()->dof_armature[dof] += inertia - file(dof, dof);
    model.get()->dof_damping[dof] = friction;
  };
  for (const AxisSettings& one : axes) {
    if (one.nominal_from != NominalFrom::keys) continue;
    const TransmissionSettings& transmission = one.transmission;
    const TwoInertia& numbers = transmission.nominal;
    if (transmission.is_elastic()) {
      if (!(numbers.motor_inertia > 0.0 && numbers.stiffness > 0.0)) {
        throw std::invalid_argument(fmt::format(
            "{0}nominal.motor_inertia_{1} and {0}nominal.stiffness_{2} must be positive for a "
            "linear model of the plant",
            one.axis.prefix(), one.axis.units.inertia_suffix, one.axis.units.stiffness_suffix()));
      }
      set(one.axis.joint, numbers.load_inertia, numbers.load_friction);
      set(transmission.motor(one.axis.joint), numbers.motor_inertia, numbers.motor_friction);
      continue;
    }
    const double squared = numbers.ratio * numbers.ratio;
    set(one.axis.joint, numbers.load_inertia + squared * numbers.motor_inertia,
        numbers.load_friction + squared * numbers.motor_friction);
  }
  if (M.llt().info() != Eigen::Success) {
    throw std::invalid_argument(
        "the nominal inertias are too small for the joints' coupling: the mass matrix is not "
        "positive definite");
  }
  return model;
}

Eigen::VectorXd AxisPlant::reference_at_start() const {
  Eigen::VectorXd start(static_cast<Eigen::Index>(axes.size()));
  for (Eigen::Index i = 0; const AxisSettings& one : axes) start(i++) = one.reference.at(0.0);
  return start;
}

std::vector<double> AxisPlant::pose(const Model& model) const {
  const mjtNum* pose = model->qpos0;
  if (keyframe != Axis::kNone) {
    pose = model->key_qpos + static_cast<std::ptrdiff_t>(model->nq) * model.id(mjOBJ_KEY, keyframe);
  }
  return {pose, pose + model->nq};
}

std::vector<double> AxisPlant::start_pose(const Model& model) const {
  std::vector<double> qpos = pose(model);
  for (const AxisSettings& one : axes) {
    const int joint = model.id(mjOBJ_JOINT, one.axis.joint);
    qpos[static_cast<std::size_t>(model->jnt_qposadr[joint])] += one.start_position;
  }
  return qpos;
}

SensingSetup AxisPlant::sensing(const double* contact_force_N) const {
  SensingSetup setup;
  for (const AxisSettings& one : axes) {
    const std::string joint = one.measured_joint();
    const bool is_own = one.axis.measures_joint() || joint != one.axis.joint;
    setup.channels.push_back({.name = one.axis.channel,
                              .sensor = is_own ? joint : one.axis.position_sensor,
                              .reading = is_own ? Reading::joint_position : Reading::component,
                              .disturbance = one.output,
                              .encoder = one.encoder,
                              .noise_std = one.measurement_noise(),
                              .delay_samples = one.delay_samples});
    setup.channels.back().encoder.quantum = one.quantum();
  }
  const auto add_true = [&](const std::string& what, Reading reading) {
    for (const AxisSettings& one : axes) {
      setup.channels.push_back({.name = one.axis.name.empty() ? what : one.axis.name + " " + what,
                                .sensor = one.axis.joint,
                                .reading = reading});
    }
  };
  if (senses_true_state) {
    add_true("true position", Reading::joint_position);
    add_true("true velocity", Reading::joint_velocity);
  }
  if (tip) {
    const auto force = tip->channels(contact_force_N);
    setup.channels.insert(setup.channels.end(), force.begin(), force.end());
  }
  faults.apply(setup);
  setup.seed = run.seed;
  return setup;
}

void AxisPlant::check(const Config& config) {
  physics.check(config, run);
  timing.check(config, physics);
  for (AxisSettings& one : axes) {
    if (one.of_motor) one.transmission = at_joint(*one.of_motor);
    one.transmission.nominal.ratio = one.transmission.design.ratio;
  }
  if (fine_to_s < fine_from_s) {
    config.fail("record.fine_to_s", "must not be before record.fine_from_s");
  }
  const Model model = load_model(&config);
  const Model of_file = model_of_file();  // the true plant may differ from the nominal one
  if (keyframe != Axis::kNone) id_of(config, "start.keyframe", of_file, mjOBJ_KEY, keyframe);
  const std::vector<double> pose = this->pose(of_file);
  const Eigen::MatrixXd inertia = joint_inertia(of_file, pose);
  for (PushSettings& one : pushes) {
    const Config own = config.under(one.prefix());
    id_of(own, "body", of_file, mjOBJ_BODY, one.body);
    if (one.along.size() != 3 || one.along == std::vector{0.0, 0.0, 0.0}) {
      own.fail("along", "must be three numbers that are not all 0");
    }
    one.disturbance.load(own);
  }
  for (AxisSettings& one : axes) {
    const Config own = config.under(one.axis.prefix());
    const int joint = of_file.id(mjOBJ_JOINT, one.axis.joint);
    one.reference.before = pose[static_cast<std::size_t>(of_file->jnt_qposadr[joint])];
    if (one.reference.kind == ReferenceShape::csv) {
      own.blame("reference.file",
                [&] { one.reference.table = read_function(one.reference_file, "value"); });
    }
    one.disturbance.load(own);
    one.force = one.disturbance.make(run.seed, one.axis.own("disturbance"));
    one.output.start_s = one.force.start_s;
    one.model_numbers = one.transmission.true_numbers(of_file, inertia, one.axis.joint);
    if (!one.axis.is_driven()) continue;
    const int actuator = actuator_id(of_file, one.axis);
    one.model_limit = of_file->actuator_ctrllimited[actuator] != 0
                          ? of_file->actuator_ctrlrange[2 * actuator + 1]
                          : std::numeric_limits<double>::infinity();
  }
  const double no_force_N = 0.0;
  const SensingSetup setup = sensing(&no_force_N);
  faults.check(config, setup.channels);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    config.under(axes[i].axis.prefix()).blame("nominal.model", [&] { nominal(i); });
  }
  for (const AxisSettings& one : axes) {
    const std::string rubs = one.transmission.friction_joint(one.axis.joint);
    one.drive.check(config.under(one.axis.prefix()), model->dof_frictionloss[model.dof(rubs)]);
    if (one.transmission.is_elastic()) one.transmission.make(model, one.axis.joint);
  }
  const Sensing check_only(model, setup);
}

void PushSettings::bind(Fields& fields) {
  const Fields::Under under(fields, prefix());
  fields.text("body", body, "body of the model that the force pushes at its centre of mass");
  fields.numbers("along", along, any(), "direction of the force in the world, of any length");
  disturbance.bind(fields, "N", "N");
}

void TipSettings::bind(Fields& fields) {
  fields.optional_text(
      "tip.contact", contact,
      "name of the contact whose normal force is force_true_N; none: there is no such "
      "signal");
  fields.optional_text(
      "tip.sensor", sensor,
      "<force> or <touch> of the model that measures the force; none: the force of "
      "tip.contact is measured");
  fields.optional_count(
      "tip.component", component, between(0, 2),
      "value of the sensor, from 0: 0 is the force with which the tip presses along x of its site");
  fields.optional_number("sensor.force_noise_N", raw.noise_std, not_negative(),
                         "standard deviation of white noise on each force sample");
  fields.optional_number(
      "sensor.force_tool_mass_kg", tool_mass_kg, not_negative(),
      "mass before the force sensor beside the tip's own: the sensor reads its inertia");
  fields.optional_number("sensor.force_resonance_Hz", resonance_Hz, not_negative(),
                         "natural frequency of the sensor's body; 0: rigid");
  fields.optional_number("sensor.force_damping_ratio", raw.body.damping_ratio, between(0.0, 0.99),
                         "damping ratio of the sensor's body");
  fields.only_with({"sensor.force_damping_ratio"}, "sensor.force_resonance_Hz");
  fields.optional_number("sensor.force_bias_N", raw.electronics.bias, any(),
                         "constant error of the sensor");
  fields.optional_number("sensor.force_drift_N_sqrt_s", raw.electronics.drift_per_sqrt_s,
                         not_negative(),
                         "drift, a random walk: its standard deviation after 1 s [N/s^0.5]");
  fields.optional_number("sensor.force_range_N", raw.electronics.range, not_negative(),
                         "range: larger forces of either sign are clipped; 0: no limit");
  fields.optional_number("sensor.force_quantum_N", raw.electronics.quantum, not_negative(),
                         "one step of the converter; 0: no quantisation");
  fields.optional_number("sensor.force_period_s", raw.electronics.period_s, not_negative(),
                         "the sensor's own sampling period; 0: physics.timestep_s");
  fields.optional_number("sensor.force_delay_s", raw.electronics.delay_s, not_negative(),
                         "delay of the sensor's samples");
  fields.optional_number("sensor.force_weighed_kg", raw.weighed_kg,
                         between(SensorChannel::kAllBeyond, 1e3),
                         "mass beyond the sensor whose weight is taken off each sample, as the "
                         "sensor is turned; negative: all that the model has there");
  fields.optional_number(
      "sensor.force_tare_at_s", raw.tare_at_s, between(SensorChannel::kNever, 1e9),
      "time whose value, before noise, is taken off all samples from then on; -1: none");
  fields.only_where({"tip.component", "sensor.force_tool_mass_kg", "sensor.force_weighed_kg"},
                    "tip.sensor names a sensor", [this] { return sensor != Axis::kNone; });
  if (std::isinf(reference.from_s)) return;
  fields.optional_number("force.filter_time_constant_s", low_pass_s, not_negative(),
                         "time constant of the force sensor's low-pass; 0: none");
  fields.optional_number("force.reference_N", reference.value, any(),
                         "reference of the force, for the controller and the log");
  fields.optional_number("force.from_s", reference.from_s, not_negative(),
                         "time from which the reference counts; before, it is 0");
}

void DisturbanceSettings::bind(Fields& fields, const std::string& suffix, const std::string& unit) {
  const char* const kind = "disturbance.kind";
  const std::string amplitude = "disturbance.amplitude_" + suffix;
  const std::string second = "disturbance.second_amplitude_" + suffix;
  fields.choice(kind, shape.kind,
                {{"none", DisturbanceKind::none},
                 {"step", DisturbanceKind::step},
                 {"ramp", DisturbanceKind::ramp},
                 {"sine", DisturbanceKind::sine},
                 {"two_sines", DisturbanceKind::two_sines},
                 {"chirp", DisturbanceKind::chirp},
                 {"noise", DisturbanceKind::noise},
                 {"csv", DisturbanceKind::csv}},
                "shape of the disturbance");
  fields.number(
      amplitude, shape.amplitude, any(),
      "amplitude of a step, sine or chirp [" + unit + "]; slope of a ramp [" + unit + "/s]");
  fields.optional_number(
      "disturbance.frequency_rad_s", shape.frequency_rad_s, any(),
      "frequency of a sine, of the first of two sines, or of a chirp at its start");
  fields.only_for({amplitude}, kind,
                  {"step", "ramp", "sine", "two_sines", "chirp", "noise", "csv"});
  fields.only_for({"disturbance.frequency_rad_s"}, kind, {"sine", "two_sines", "chirp"});
  fields.optional_number(second, shape.second_amplitude, any(), "amplitude of the second sine");
  fields.optional_number("disturbance.second_frequency_rad_s", shape.second_frequency_rad_s, any(),
                         "frequency of the second sine");
  fields.only_for({second, "disturbance.second_frequency_rad_s"}, kind, {"two_sines"});
  fields.optional_number("disturbance.end_frequency_rad_s", shape.end_frequency_rad_s, any(),
                         "frequency that a chirp reaches at a constant rate and then keeps");
  fields.optional_number("disturbance.sweep_s", shape.sweep_s, positive(),
                         "time that a chirp takes to reach its last frequency");
  fields.only_for({"disturbance.end_frequency_rad_s", "disturbance.sweep_s"}, kind, {"chirp"});
  fields.optional_number("disturbance.start_s", shape.start_s, not_negative(),
                         "time at which the disturbance begins");
  fields.optional_number("disturbance.end_s", end_s, not_negative(),
                         "time at which the disturbance ends; a step between both times is a "
                         "pulse; 0: the end of the run");
  fields.optional_number("disturbance.offset_" + suffix, shape.offset, any(),
                         "constant part, from the start of the run");
  {
    const Fields::OfPart noise(fields, kind, "noise");
    fields.number(
        "disturbance.hold_s", shape.hold_s, positive(),
        "time for which each number of the noise lasts; the amplitude is its standard deviation");
  }
  const Fields::OfPart csv(fields, kind, "csv");
  fields.file(
      "disturbance.file", file,
      "table with the columns time_s, from the start, and value, a factor on the amplitude; "
      "linear between its rows, with the last value after them");
}

void DisturbanceSettings::load(const Config& config) {
  if (end_s != 0.0 && end_s <= shape.start_s) {
    config.fail("disturbance.end_s",
                "must be later than disturbance.start_s, or 0 for the end of the run");
  }
  if (shape.kind != DisturbanceKind::csv) return;
  config.blame("disturbance.file", [&] { shape.table = read_function(file, "value"); });
}

Disturbance DisturbanceSettings::make(std::uint64_t seed, const std::string& channel) const {
  Disturbance made = shape;
  if (end_s != 0.0) made.end_s = end_s;
  if (made.kind == DisturbanceKind::noise) made.noise.emplace(seed, channel);
  return made;
}

std::array<SensorChannel, 2> TipSettings::channels(const double* contact_force_N) const {
  SensorChannel before = raw;
  before.name = "force_raw";
  before.sensor = sensor;
  before.source = sensor != Axis::kNone ? nullptr : contact_force_N;
  before.component = component;
  before.body.resonance_rad_s = 2.0 * std::numbers::pi * resonance_Hz;
  SensorChannel behind = before;
  behind.name = "force";
  behind.low_pass_s = low_pass_s;
  return {std::move(behind), std::move(before)};
}

}  // namespace breakwater
