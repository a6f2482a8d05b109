#include <breakwater/identification/axis_parameters.h>

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/record/input_file.h>

namespace breakwater {
namespace {

constexpr KnownParameter kKnown[] = {
    {kInertia, "inertia_kgm2", "kg m^2", "inertia", 0.25},
    {kViscous, "viscous_Nms", "N m s/rad", "viscous friction", 0.15},
    {kCoulomb, "coulomb_Nm", "N m", "Coulomb friction", 0.15},
    {kBreakaway, "breakaway_Nm", "N m", "breakaway friction", 0.15},
    {kStribeckSpeed, "stribeck_speed_rad_s", "rad/s", "Stribeck speed", 0.5},
    {kMotorInertia, "motor_inertia_kgm2", "kg m^2", "inertia of the motor", 0.25},
    {kLoadInertia, "load_inertia_kgm2", "kg m^2", "inertia of the load", 0.25},
    {kStiffness, "stiffness_Nm_rad", "N m/rad", "stiffness", 0.25},
    {kDamping, "damping_Nms_rad", "N m s/rad", "damping", 0.15},
    {kBacklash, "backlash_rad", "rad", "backlash", std::numeric_limits<double>::infinity()},
    {kMotorViscous, "motor_viscous_Nms", "N m s/rad", "viscous friction of the motor", 0.15},
    {kLoadViscous, "load_viscous_Nms", "N m s/rad", "viscous friction of the load", 0.15},
    {kMotorCoulomb, "motor_coulomb_Nm", "N m", "Coulomb friction of the motor", 0.15},
    {kLoadCoulomb, "load_coulomb_Nm", "N m", "Coulomb friction of the load", 0.15},
    {kOffset, "offset_Nm", "N m", "offset torque", 0.15},
    {kDelay, "delay_s", "s", "delay", 1.0},
    {kTorqueConstant, "torque_constant", "N m", "torque constant", 0.25}};

}  // namespace

const KnownParameter& known_parameter(AxisParameter parameter) {
  return kKnown[parameter];
}

AxisValues read_identified_axis(const std::string& file, AxisValues axis) {
  std::ifstream stream = open_input(file);
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  for (const AxisParameter p : {kInertia, kViscous, kCoulomb, kOffset, kDelay, kBreakaway,
                                kStribeckSpeed, kTorqueConstant}) {
    const bool may_be_absent = p == kBreakaway || p == kStribeckSpeed || p == kTorqueConstant;
    if (may_be_absent && json.is_object() && !json.contains(parameter_key(p))) continue;
    const nlohmann::json::json_pointer value(fmt::format("/{}/value", parameter_key(p)));
    if (!json.is_object() || !json.contains(value) || !json[value].is_number()) {
      throw std::invalid_argument(fmt::format("{}: has no value of {}: must be an identified.json",
                                              file, parameter_key(p)));
    }
    axis[p] = json[value].get<double>();
  }
  for (const AxisParameter p : {kInertia, kStribeckSpeed, kTorqueConstant}) {
    if (axis[p] > 0.0) continue;
    throw std::invalid_argument(fmt::format("{}: {}: must be > 0", file, parameter_key(p)));
  }
  return axis;
}

}  // namespace breakwater
