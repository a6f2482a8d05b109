#include <breakwater/rigs/drive_settings.h>

#include <numbers>

#include <breakwater/config/column_table.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/sim/joint_friction.h>

namespace breakwater {

void bind_sine(Fields& fields, const std::string& stem, const std::string& amplitude_suffix,
               PositionSine& sine, const AxisUnits& units, const std::string& doc) {
  const std::string amplitude = stem + "_" + amplitude_suffix;
  const bool turns = units.turns();
  const std::string periods = stem + (turns ? "_per_turn" : "_per_m");
  fields.optional_number(amplitude, sine.amplitude, not_negative(), doc);
  fields.optional_number(periods, sine.periods, positive(),
                         std::string("periods of that sine in a ") + (turns ? "turn" : "metre"));
  sine.length = turns ? 2.0 * std::numbers::pi : 1.0;
  fields.only_with({periods}, amplitude);
}

void DriveSettings::bind(Fields& fields, const AxisUnits& units) {
  friction.bind(fields);
  const std::string constant =
      (units.turns() ? "drive.torque_constant_" : "drive.force_constant_") + units.force_suffix +
      "_A";
  ElectricDrive& e = electric;
  fields.optional_number("drive.current_bandwidth_rad_s", e.bandwidth_rad_s, not_negative(),
                         "bandwidth of the current loop; 0: the current follows at once");
  fields.optional_number("drive.current_damping_ratio", e.damping_ratio, not_negative(),
                         "damping ratio of the current loop; 0: it is of first order");
  fields.only_with({"drive.current_damping_ratio"}, "drive.current_bandwidth_rad_s");
  fields.optional_number(
      constant, e.torque_constant, positive(),
      "k: force of one ampere, and back-EMF [" + units.force + "/A, V per " + units.velocity + "]");
  fields.optional_number("drive.current_limit_A", e.current_limit_A, not_negative(),
                         "limit of the current's reference; 0: none");
  fields.optional_number("drive.voltage_limit_V", e.voltage_limit_V, not_negative(),
                         "limit of the voltage at the motor; 0: none");
  fields.optional_number("drive.resistance_ohm", e.resistance_ohm, not_negative(),
                         "R: resistance of the winding");
  fields.optional_number("drive.inductance_H", e.inductance_H, not_negative(),
                         "L: inductance of the winding [H]");
  fields.only_with({"drive.resistance_ohm", "drive.inductance_H"}, "drive.voltage_limit_V");
  bind_sine(fields, "drive.cogging", units.force_suffix, e.cogging, units,
            "amplitude of the cogging, a sine of the position");
  bind_sine(fields, "drive.ripple", "ratio", e.ripple, units,
            "amplitude of the ripple, a sine of the position, over the force of the current");
}

void DriveSettings::check(const Config& config, double coulomb) const {
  friction.check(config, coulomb);
  if (electric.voltage_limit_V > 0.0 && electric.resistance_ohm == 0.0) {
    config.fail("drive.resistance_ohm", "must be above 0 where drive.voltage_limit_V is not 0");
  }
}

void TimingSettings::bind(Fields& fields) {
  fields.optional_number("control.delay_s", delays_.delay_s, not_negative(),
                         "delay of the command to the drives, any part of a timestep");
  constexpr const char* kJitter = "control.jitter";
  fields.optional_choice(kJitter, has_file_, {{"uniform", false}, {"csv", true}},
                         "further delay of each command: a random one, or that of a file");
  fields.optional_number("control.jitter_s", delays_.jitter_s, not_negative(),
                         "largest further delay, uniform from 0");
  fields.only_for({"control.jitter_s"}, kJitter, {"uniform"});
  {
    const Fields::OfPart part(fields, kJitter, "csv");
    fields.file("control.jitter_file", file_,
                "table with the column jitter_s: a row for each sample, repeated [s]");
  }
  fields.optional_number("control.drop_probability", delays_.drop_probability, between(0.0, 0.999),
                         "probability that a command is lost: the drives hold the one before");
}

CommandDelays TimingSettings::delays() const {
  CommandDelays delays = delays_;
  if (has_file_) {
    delays.jitter_s = 0.0;
    delays.jitters_s = std::move(read_columns(file_, {{"jitter_s"}}).columns[0]);
    if (delays.jitters_s.empty()) throw std::invalid_argument(file_ + ": has no rows");
  }
  return delays;
}

void TimingSettings::check(const Config& config, const PhysicsSettings& physics) const {
  const char* key = has_file_ ? "control.jitter_file" : "control.delay_s";
  config.blame(
      key, [&] { CommandTiming(delays(), 0, physics.timestep_s, physics.steps_per_sample(), 1); });
}

void TransmissionSettings::bind_plant(Fields& fields, const AxisUnits& u) {
  const std::string stiffness = "transmission.stiffness_" + u.stiffness_suffix();
  const std::string position = "_" + u.position, friction = "_" + u.friction_suffix;
  fields.optional_number("transmission.ratio", design.ratio, positive(),
                         "N: motion of the motor for one of the load");
  fields.optional_number(stiffness, design.stiffness, not_negative(),
                         "K: stiffness between motor and load, at the load; 0: rigid");
  fields.optional_number("transmission.damping" + friction, design.damping, not_negative(),
                         "damping of this spring");
  fields.optional_number("transmission.backlash" + position, design.backlash, not_negative(),
                         "b: play of the load while the motor stands");
  fields.optional_number("transmission.kinematic_error" + position, design.kinematic_error, any(),
                         "amplitude of the transmission's error, at the load");
  fields.optional_number("transmission.kinematic_error_per_turn", design.error_per_turn, any(),
                         "periods of this error in a turn of the motor");
  motor_inertia_key_ = "motor_inertia_" + u.inertia_suffix;
  fields.optional_number(
      "transmission." + motor_inertia_key_, motor_inertia, not_negative(),
      "inertia of the motor, in place of its joint's (0: the joint's own). Without a joint it adds "
      "to the armature of the axis' joint");
  fields.optional_number("transmission.motor_viscous_friction" + friction, motor_friction,
                         not_negative(),
                         "viscous friction of the motor, besides that of its joint in the model");
  const auto side = [&fields](const std::string& key, Side& target, const std::string& what) {
    fields.optional_choice(key, target, {{"load", Side::load}, {"motor", Side::motor}},
                           "side of the transmission with the " + what);
  };
  side("friction.side", friction_side, "dry friction");
  side("encoder.side", measured, "encoder");
  fields.only_with(
      {"transmission.damping" + friction, "transmission.backlash" + position,
       "transmission.kinematic_error" + position, "transmission.kinematic_error_per_turn",
       "transmission.motor_viscous_friction" + friction, "friction.side", "encoder.side"},
      stiffness);
}

void TransmissionSettings::bind(Fields& fields, const AxisUnits& u) {
  bind_plant(fields, u);
  const std::string stiffness = "_" + u.stiffness_suffix();
  const std::string friction = "_" + u.friction_suffix;
  fields.optional_number("transmission.motor_coulomb_friction_" + u.force_suffix, motor_coulomb,
                         not_negative(),
                         "Coulomb friction of the motor, besides that of its joint in the model");
  fields.optional_text("transmission.motor_joint", motor_joint,
                       "joint of the motor in the model, for a transmission with a stiffness; "
                       "empty: the model has none");
  fields.optional_choice(
      "nominal.model", nominal_model,
      {{"rigid", NominalModel::rigid},
       {"motor", NominalModel::motor},
       {"spring", NominalModel::spring}},
      "model of controller and observer: motor and load as one inertia, the motor alone, "
      "or both with the spring");
  fields.optional_number("nominal." + motor_inertia_key_, nominal.motor_inertia, not_negative(),
                         "nominal inertia of the motor");
  fields.optional_number("nominal.stiffness" + stiffness, nominal.stiffness, not_negative(),
                         "nominal stiffness of the transmission");
  fields.optional_number("nominal.damping" + friction, nominal.damping, not_negative(),
                         "nominal damping of the transmission");
  fields.optional_number("nominal.motor_viscous_friction" + friction, nominal.motor_friction,
                         not_negative(), "nominal viscous friction of the motor");

  const std::string spring = "transmission.stiffness" + stiffness;
  // Resonance ratio control and controllers of all axes use them with a rigid nominal model too.
  fields.only_where({"nominal.stiffness" + stiffness, "nominal.damping" + friction},
                    spring + " is not 0, or nominal.model is motor or spring",
                    [this] { return is_elastic() || nominal_model != NominalModel::rigid; });
  fields.only_with(
      {"transmission.motor_joint", "transmission.motor_coulomb_friction_" + u.force_suffix},
      spring);
}

double TransmissionSettings::rotor_inertia(const Model& model, const std::string& load) const {
  return motor_inertia + model->dof_armature[model.dof(load)] / (design.ratio * design.ratio);
}

void TransmissionSettings::check_motor(const Model& model, const std::string& load) const {
  if (!is_elastic()) return;
  if (!adds_rotor()) {
    model.id(mjOBJ_JOINT, motor_joint);
  } else if (!(rotor_inertia(model, load) > 0.0)) {
    throw WrongKey(
        "transmission." + motor_inertia_key_,
        "must be above 0 where the transmission has a stiffness. There is no joint "
        "of the motor (in a plant transmission.motor_joint names it), and no armature of "
        "the load's joint");
  }
}

void TransmissionSettings::author(Model& model, const std::string& load, int actuator) const {
  const int joint = model.id(mjOBJ_JOINT, load);
  if (!is_elastic()) {
    if (design.ratio == 1.0 && motor_inertia == 0.0) return;
    model.add_gear(actuator, joint, design.ratio, motor_inertia);
    return;
  }
  const int dof = model->jnt_dofadr[joint];
  if (adds_rotor()) {
    const double inertia = rotor_inertia(model, load);
    model.get()->dof_armature[dof] = 0.0;
    model.add_rotor(actuator, joint, design.ratio, inertia, motor(load));
  }
  const int motor_id = model.id(mjOBJ_JOINT, motor(load));
  const int motor_dof = model->jnt_dofadr[motor_id];
  if (!adds_rotor() && motor_inertia > 0.0) {
    // The motor of the file may have more than that.
    model.add_armature(motor_id, motor_inertia - model->dof_M0[motor_dof]);
  }
  double dry = 0.0;
  if (friction_side == Side::motor) {
    dry = model->dof_frictionloss[dof];
    set_coulomb_friction(model, joint, 0.0);
  }
  author_friction(model, motor_id, model->dof_damping[motor_dof] + motor_friction,
                  model->dof_frictionloss[motor_dof] + motor_coulomb + dry);
}

std::unique_ptr<Transmission> TransmissionSettings::make(const Model& model,
                                                         const std::string& load) const {
  auto transmission = std::make_unique<Transmission>(model, motor(load), load, design);
  transmission->check_stability(model);
  return transmission;
}

TwoInertia TransmissionSettings::true_numbers(const Model& model, const Eigen::MatrixXd& M,
                                              const std::string& load) const {
  const int dof = model.dof(load);
  TwoInertia numbers{
      .load_inertia = M(dof, dof), .load_friction = model->dof_damping[dof], .ratio = design.ratio};
  if (!is_elastic()) return numbers;
  const int motor_dof = model.dof(motor(load));
  numbers.motor_inertia = M(motor_dof, motor_dof);
  numbers.motor_friction = model->dof_damping[motor_dof];
  numbers.stiffness = design.stiffness;
  numbers.damping = design.damping;
  return numbers;
}

TransmissionDesign TransmissionSettings::linear_design(NominalFrom from) const {
  TransmissionDesign linear = design;
  linear.backlash = linear.kinematic_error = 0.0;
  if (from == NominalFrom::keys) {
    linear.stiffness = nominal.stiffness;
    linear.damping = nominal.damping;
  }
  return linear;
}

StateSpace TransmissionSettings::linear(const TwoInertia& numbers) const {
  if (is_elastic()) return motor_and_load(numbers, measured);
  StateSpace plant = damped_inertia(numbers.load_inertia, numbers.load_friction);
  plant.B *= numbers.ratio;
  return plant;
}

void TransmissionSettings::describe(NominalAxis& axis, const TwoInertia& numbers,
                                    NominalFrom from) const {
  if (measured == Side::motor && !is_elastic() && design.ratio != 1.0) {
    throw WrongKey("encoder.side",
                   "motor needs a transmission with a stiffness: see encoder.gear_ratio for a "
                   "rigid one");
  }
  const double N = numbers.ratio;
  axis.measured = measured;
  axis.measured_ratio = measured_ratio();
  const auto need = [](double number, const std::string& key, const char* model) {
    if (number > 0.0) return;
    throw WrongKey(key, std::string("must be positive for nominal.model = \"") + model + '"');
  };
  const std::string table = from == NominalFrom::keys ? "nominal." : "transmission.";
  const std::string stiffness = table + "stiffness_" + axis.units.stiffness_suffix();
  const std::string motor_inertia_key = table + motor_inertia_key_;
  if (!(numbers.motor_inertia > 0.0)) axis.why_no_inertias = motor_inertia_key;
  if (!(numbers.stiffness > 0.0)) axis.why_no_inertias = stiffness;
  if (axis.why_no_inertias.empty()) axis.inertias = numbers;
  switch (nominal_model) {
    case NominalModel::rigid: {
      const double scale = axis.measured_ratio * axis.measured_ratio;
      axis.plant = damped_inertia((numbers.load_inertia + N * N * numbers.motor_inertia) / scale,
                                  (numbers.load_friction + N * N * numbers.motor_friction) / scale);
      axis.plant.B *= N / axis.measured_ratio;
      return;
    }
    case NominalModel::motor:
      if (measured != Side::motor) {
        throw WrongKey("encoder.side", "must be motor for nominal.model = \"motor\"");
      }
      if (from == NominalFrom::model) need(numbers.stiffness, stiffness, "motor");
      need(numbers.motor_inertia, motor_inertia_key, "motor");
      axis.plant = damped_inertia(numbers.motor_inertia, numbers.motor_friction);
      return;
    case NominalModel::spring:
      need(numbers.stiffness, stiffness, "spring");
      need(numbers.motor_inertia, motor_inertia_key, "spring");
      axis.plant = motor_and_load(numbers, measured);
      axis.E = load_torque_input(numbers, measured);
      axis.controlled = measured == Side::load ? 0 : 2;
      axis.inertia = (numbers.load_inertia + N * N * numbers.motor_inertia) / axis.measured_ratio;
      return;
  }
}

// The friction laws: the keys of each, and how it is made of them.
namespace {

using Friction = std::unique_ptr<FrictionLaw>;

struct Stribeck {
  StribeckFriction::Curve curve;
  Bristles bristles;

  void bind(Fields& fields) {
    fields.number("friction.static_ratio", curve.static_ratio, between(1.0, 1e3),
                  "F_S/F_C: largest friction at rest, over the Coulomb friction");
    fields.number("friction.stribeck_velocity", curve.velocity, positive(),
                  "v_S: velocity at which the friction has fallen from F_S towards F_C [velocity]");
    fields.optional_number("friction.stribeck_exponent", curve.exponent, positive(),
                           "delta: exponent of the velocity over v_S");
  }
  Friction make(double coulomb) const {
    StribeckFriction::Curve known = curve;
    known.coulomb = coulomb;
    return std::make_unique<StribeckFriction>(known, bristles);
  }
};

struct LuGre : Stribeck {
  void bind(Fields& fields) {
    Stribeck::bind(fields);
    fields.number("friction.bristle_stiffness", bristles.stiffness, positive(),
                  "sigma_0: stiffness of the bristles [force per position]");
    fields.number("friction.bristle_damping", bristles.damping, not_negative(),
                  "sigma_1: damping of the bristles [force per velocity]");
  }
  Friction make(double coulomb) const { return Stribeck::make(coulomb); }
};

struct LoadDependent {
  double ratio = 0.0;

  void bind(Fields& fields) {
    fields.number("friction.load_ratio", ratio, between(0.0, 0.99),
                  "mu: friction that the transmitted force adds, over that force");
  }
  Friction make(double coulomb) const {
    return std::make_unique<LoadDependentFriction>(coulomb, ratio);
  }
};

}  // namespace

std::vector<FrictionKind> friction_laws() {
  return {{"coulomb", "a constant level, of the engine", [](double) { return Friction(); }},
          {"stribeck", "falls from its static level as the joint begins to slide", &Stribeck::make},
          {"lugre", "bristles bend before the joint slides", &LuGre::make},
          {"load_dependent", "grows with the transmitted force, as in a strain-wave gear",
           &LoadDependent::make}};
}

}  // namespace breakwater
