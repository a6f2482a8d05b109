#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/recorded/recorded_estimation.h>

#include "beyond_axes.h"

namespace breakwater {
namespace {

constexpr double kModelLoad = 0.02;       // kg m², in models/two_inertia.xml
constexpr double kLongestStep = 0.2;      // step of the physics times the resonance
constexpr double kLeastVariance = 1e-14;  // rad², for an encoder without counts and noise

std::vector<std::string> sets_of(const IdentifiedTwoInertia& plant) {
  std::vector<std::string> sets = {"task.kind=reversal", "nominal.model=spring"};
  const auto set = [&](const char* key, double value) { sets.push_back(number_set(key, value)); };
  const TwoInertia& p = plant.linear;
  set("plant.inertia_ratio", p.load_inertia / kModelLoad);
  set("plant.viscous_friction_Nms_rad", p.load_friction);
  set("plant.coulomb_friction_Nm", plant.load_coulomb);
  set("transmission.motor_inertia_kgm2", p.motor_inertia);
  set("transmission.motor_viscous_friction_Nms_rad", p.motor_friction);
  set("transmission.motor_coulomb_friction_Nm", plant.motor_coulomb);
  set("transmission.stiffness_Nm_rad", p.stiffness);
  set("transmission.damping_Nms_rad", p.damping);
  set("transmission.backlash_rad", plant.backlash);
  set("nominal.inertia_kgm2", p.load_inertia);
  set("nominal.viscous_friction_Nms_rad", p.load_friction);
  set("nominal.motor_inertia_kgm2", p.motor_inertia);
  set("nominal.motor_viscous_friction_Nms_rad", p.motor_friction);
  set("nominal.stiffness_Nm_rad", p.stiffness);
  set("nominal.damping_Nms_rad", p.damping);
  set("control.period_s", plant.period_s);
  set("physics.timestep_s",
      plant.period_s /
          std::max(1.0, std::ceil(plant.period_s * resonance_rad_s(p) / kLongestStep)));
  sets.emplace_back(plant.measured == Side::motor ? "encoder.side=motor" : "encoder.side=load");
  // A single count of 2π times a ratio: any quantum.
  sets.push_back(fmt::format("encoder.bits={}", plant.quantum > 0.0 ? 1 : 0));
  if (plant.quantum > 0.0) {
    sets.emplace_back("encoder.multiplication=1");
    set("encoder.gear_ratio", std::numbers::pi / plant.quantum);
  }
  sets.push_back(rounding_set(plant.rounding));
  set("noise.std_rad", plant.noise_std);
  set("control.delay_s", plant.delay_s);
  const double anti_resonance = antiresonance_rad_s(p);
  set("controller.kp", p.motor_inertia * anti_resonance * anti_resonance);
  set("controller.kd", 4.0 * p.motor_inertia * anti_resonance);
  sets.push_back(
      fmt::format("controller.poles_rad_s=[{0:.6g}, {0:.6g}, {0:.6g}, {0:.6g}]", -anti_resonance));
  const double share = p.load_inertia / kModelLoad;
  set("observer.process_noise", 1e-6 * share * share);
  set("observer.observation_noise",
      std::max(kLeastVariance,
               plant.quantum * plant.quantum / 12.0 + plant.noise_std * plant.noise_std));
  return sets;
}

}  // namespace

IdentifiedTwoInertiaKind identified_two_inertia() {
  return {"two_inertia", "sf-kfd", sets_of};
}

}  // namespace breakwater
