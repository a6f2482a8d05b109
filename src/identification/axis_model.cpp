#include <breakwater/identification/axis_model.h>

#include <breakwater/identification/axis_start.h>
#include <breakwater/identification/friction_axis.h>

namespace breakwater {
namespace {

AxisValues one_inertia(const AxisValues& values) {
  AxisValues rigid = values;
  rigid[kCoulomb] = rigid[kBreakaway] = rigid[kOffset] = rigid[kDelay] = 0.0;
  return rigid;
}

}  // namespace

bool is_logarithmic(AxisParameter parameter) {
  switch (parameter) {
    case kInertia:
    case kStribeckSpeed:
    case kMotorInertia:
    case kLoadInertia:
    case kStiffness:
    case kTorqueConstant:
      return true;
    default:
      return false;
  }
}

bool is_positive(AxisParameter parameter) {
  switch (parameter) {
    case kViscous:
    case kCoulomb:
    case kBreakaway:
    case kDamping:
    case kBacklash:
    case kMotorViscous:
    case kLoadViscous:
    case kMotorCoulomb:
    case kLoadCoulomb:
      return true;
    default:
      return false;
  }
}

bool is_torque(AxisParameter parameter) {
  return parameter != kStribeckSpeed && parameter != kBacklash && parameter != kDelay;
}

std::size_t AxisData::rows() const {
  std::size_t rows = 0;
  for (const AxisStretch& stretch : stretches) rows += stretch.positions.size();
  return rows;
}

const AxisModel& friction_axis() {
  static const AxisModel model{.name = "axis",
                               .parameters = {kInertia, kViscous, kCoulomb, kOffset, kDelay},
                               .known_inertia = kInertia,
                               .start_values = 2,
                               .has_backlash = false,
                               .has_motor_encoder = true,
                               .move = move_axis,
                               .candidates = start_candidates,
                               .rigid = one_inertia};
  return model;
}

}  // namespace breakwater
