#include <breakwater/identification/axis_parameters.h>

#include <limits>

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

}  // namespace breakwater
