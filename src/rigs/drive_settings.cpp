#include <breakwater/rigs/drive_settings.h>

#include <numbers>

#include <breakwater/config/column_table.h>

namespace breakwater {
namespace {

// A sine of the position: its amplitude, and its periods per turn or metre.
void bind_sine(Fields& fields, const std::string& stem, const std::string& amplitude_suffix,
               PositionSine& sine, const AxisUnits& units, const std::string& doc) {
  const std::string amplitude = stem + "_" + amplitude_suffix;
  const bool turns = units.position == "rad";
  const std::string periods = stem + (turns ? "_per_turn" : "_per_m");
  fields.optional_number(amplitude, sine.amplitude, not_negative(), doc);
  fields.optional_number(periods, sine.periods, positive(),
                         std::string("periods of that sine in a ") + (turns ? "turn" : "metre"));
  sine.length = turns ? 2.0 * std::numbers::pi : 1.0;
  fields.only_where({periods}, amplitude + " is not 0", [&sine] { return sine.amplitude != 0.0; });
}

}  // namespace

DriveSettings::DriveSettings(const Catalogue& catalogue)
    : friction_(std::make_shared<PartChoice<FrictionKind>>(catalogue, "friction.law", "coulomb")) {}

void DriveSettings::bind(Fields& fields, const AxisUnits& units) {
  friction_->bind(fields);
  const std::string constant =
      (units.position == "rad" ? "drive.torque_constant_" : "drive.force_constant_") +
      units.force_suffix + "_A";
  const std::string unit = " [" + units.force + "]";
  ElectricDrive& e = electric_;
  fields.optional_number("drive.current_bandwidth_rad_s", e.bandwidth_rad_s, not_negative(),
                         "bandwidth of the current loop; 0: the current follows at once [rad/s]");
  fields.optional_number("drive.current_damping_ratio", e.damping_ratio, not_negative(),
                         "damping ratio of the current loop; 0: it is of first order");
  fields.only_where({"drive.current_damping_ratio"}, "drive.current_bandwidth_rad_s is not 0",
                    [&e] { return e.bandwidth_rad_s != 0.0; });
  fields.optional_number(
      constant, e.torque_constant, positive(),
      "k: force of one ampere, and back-EMF [" + units.force + "/A, V per " + units.velocity + "]");
  fields.optional_number("drive.current_limit_A", e.current_limit_A, not_negative(),
                         "limit of the current's reference; 0: none [A]");
  fields.optional_number("drive.voltage_limit_V", e.voltage_limit_V, not_negative(),
                         "limit of the voltage at the motor; 0: none [V]");
  fields.optional_number("drive.resistance_ohm", e.resistance_ohm, not_negative(),
                         "R: resistance of the winding [ohm]");
  fields.optional_number("drive.inductance_H", e.inductance_H, not_negative(),
                         "L: inductance of the winding [H]");
  fields.only_where({"drive.resistance_ohm", "drive.inductance_H"},
                    "drive.voltage_limit_V is not 0", [&e] { return e.voltage_limit_V != 0.0; });
  bind_sine(fields, "drive.cogging", units.force_suffix, e.cogging, units,
            "amplitude of the cogging, a sine of the position" + unit);
  bind_sine(fields, "drive.ripple", "ratio", e.ripple, units,
            "amplitude of the ripple, a sine of the position, over the force of the current");
}

void DriveSettings::check(const Config& config, double coulomb) const {
  friction_->check(config, coulomb);
  if (electric_.voltage_limit_V > 0.0 && electric_.resistance_ohm == 0.0) {
    config.fail("drive.resistance_ohm", "must be above 0 where drive.voltage_limit_V is not 0");
  }
}

std::unique_ptr<FrictionLaw> DriveSettings::make_friction(double coulomb) const {
  return friction_->make(coulomb);
}

void ScaleSettings::bind(Fields& fields, const AxisUnits& units) {
  const std::string unit = " [" + units.position + "]";
  bind_sine(fields, "encoder.eccentricity", units.position_suffix, eccentricity, units,
            "amplitude of the error of a scale that is not centred" + unit);
  bind_sine(fields, "encoder.interpolation", units.position_suffix, interpolation, units,
            "amplitude of the error between two lines of the scale" + unit);
}

void ScaleSettings::apply(Encoder& encoder) const {
  encoder.eccentricity = eccentricity;
  encoder.interpolation = interpolation;
}

void TimingSettings::bind(Fields& fields) {
  fields.optional_number("control.delay_s", delays_.delay_s, not_negative(),
                         "delay of the command to the drives, any part of a timestep [s]");
  constexpr const char* kJitter = "control.jitter";
  fields.choice(kJitter, jitter_, {{"uniform", Jitter::uniform}, {"csv", Jitter::csv}},
                "further delay of each command: a random one, or that of a file");
  fields.standard(kJitter, {std::string("uniform")});
  fields.optional_number("control.jitter_s", delays_.jitter_s, not_negative(),
                         "largest further delay, uniform from 0 [s]");
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
  if (jitter_ == Jitter::csv) {
    delays.jitter_s = 0.0;
    delays.jitters_s = std::move(read_columns(file_, {{"jitter_s"}}).columns[0]);
    if (delays.jitters_s.empty()) throw std::invalid_argument(file_ + ": has no rows");
  }
  return delays;
}

void TimingSettings::check(const Config& config, const PhysicsSettings& physics) const {
  const char* key = jitter_ == Jitter::csv ? "control.jitter_file" : "control.delay_s";
  config.blame(
      key, [&] { CommandTiming(delays(), 0, physics.timestep_s, physics.steps_per_sample(), 1); });
}

}  // namespace breakwater
