#include "motor_estimation/identified_motor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace breakwater {
namespace {

constexpr int kMostBits = 30;
constexpr double kMostStaticRatio = 1e3;  // the largest that friction.static_ratio may have

std::vector<std::string> sets_of(const IdentifiedPlant& plant) {
  std::vector<std::string> sets;
  const auto set = [&](const char* key, double value) {
    sets.push_back(fmt::format("{}={:.9g}", key, value));
  };
  // models/motor.xml has 1 kg m².
  set("plant.inertia_ratio", plant.inertia);
  set("plant.viscous_friction_Nms_rad", plant.viscous_friction);
  set("plant.coulomb_friction_Nm", plant.coulomb_friction);
  constexpr double kLeastShare = 1e-3;
  if (plant.breakaway_friction > kLeastShare * plant.coulomb_friction &&
      plant.coulomb_friction > 0.0) {
    sets.emplace_back("friction.law=stribeck");
    set("friction.static_ratio",
        std::min(kMostStaticRatio, 1.0 + plant.breakaway_friction / plant.coulomb_friction));
    set("friction.stribeck_velocity", plant.stribeck_speed);
  }
  set("nominal.inertia_kgm2", plant.inertia);
  set("nominal.viscous_friction_Nms_rad", plant.viscous_friction);
  set("control.period_s", plant.period_s);
  set("physics.timestep_s", plant.period_s);
  const double counts = plant.quantum == 0.0 ? 0.0 : 2.0 * std::numbers::pi / plant.quantum;
  int bits = 0;
  // Printed digits leave a power of two a little too small.
  while (bits < kMostBits && std::ldexp(1.0, bits + 1) <= counts * (1.0 + 1e-5)) ++bits;
  sets.push_back(fmt::format("encoder.bits={}", bits));
  if (bits > 0) {
    const double ratio = counts / std::ldexp(1.0, bits);
    set("encoder.gear_ratio", std::abs(ratio - 1.0) < 1e-5 ? 1.0 : ratio);
  }
  sets.push_back(fmt::format("encoder.rounding={}",
                             plant.rounding == EncoderRounding::nearest ? "nearest" : "truncate"));
  set("noise.std_rad", plant.noise_std);
  sets.push_back(fmt::format("sensor.delay_samples={}",
                             std::max(0L, std::lround(plant.delay_s / plant.period_s))));
  // The shipped gains are for 1 kg m².
  set("controller.kp", 10.0 * plant.inertia);
  set("controller.kd", 5.0 * plant.inertia);
  set("disturbance.amplitude_Nm", 0.5 * plant.largest_torque);
  return sets;
}

}  // namespace

IdentifiedScenarioKind identified_motor() {
  return {"motor_estimation",
          "stf",
          sets_of,
          "plant.inertia_ratio",
          "plant.viscous_friction_Nms_rad",
          "plant.coulomb_friction_Nm"};
}

}  // namespace breakwater
