#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/recorded/recorded_estimation.h>

#include "beyond_axes.h"

namespace breakwater {
namespace {

constexpr int kMostBits = 30;
constexpr double kMostStaticRatio = 1e3;  // the largest that friction.static_ratio may have

double disturbance_of(const IdentifiedPlant& plant) {
  return 0.5 * plant.largest_torque;
}

std::vector<std::string> plant_sets(const IdentifiedPlant& plant) {
  // models/motor.xml has 1 kg m².
  std::vector<std::string> sets = {
      number_set("plant.inertia_ratio", plant.inertia),
      number_set("plant.viscous_friction_Nms_rad", plant.viscous_friction),
      number_set("plant.coulomb_friction_Nm", plant.coulomb_friction),
      number_set("disturbance.offset_Nm", plant.offset_torque),
      number_set("control.delay_s", plant.delay_s)};
  if (plant.quantum > 0.0) sets.push_back(number_set("encoder.phase_rad", plant.phase));
  if (plant.stribeck_speed > 0.0) {
    sets.emplace_back("friction.law=stribeck");
    sets.push_back(number_set(
        "friction.static_ratio",
        std::min(kMostStaticRatio, 1.0 + plant.breakaway_friction / plant.coulomb_friction)));
    sets.push_back(number_set("friction.stribeck_velocity", plant.stribeck_speed));
  }
  return sets;
}

std::vector<std::string> other_sets(const IdentifiedPlant& plant) {
  std::vector<std::string> sets = {
      number_set("nominal.inertia_kgm2", plant.inertia),
      number_set("nominal.viscous_friction_Nms_rad", plant.viscous_friction),
      number_set("control.period_s", plant.period_s),
      number_set("physics.timestep_s", plant.period_s)};
  const double counts = plant.quantum == 0.0 ? 0.0 : 2.0 * std::numbers::pi / plant.quantum;
  int bits = 0;
  // Printed digits leave a power of two a little too small.
  while (bits < kMostBits && std::ldexp(1.0, bits + 1) <= counts * (1.0 + 1e-5)) ++bits;
  sets.push_back(fmt::format("encoder.bits={}", bits));
  if (bits > 0) {
    const double ratio = counts / std::ldexp(1.0, bits);
    sets.push_back(number_set("encoder.gear_ratio", std::abs(ratio - 1.0) < 1e-5 ? 1.0 : ratio));
  }
  sets.push_back(rounding_set(plant.rounding));
  sets.push_back(number_set("noise.std_rad", plant.noise_std));
  // The shipped gains are for 1 kg m².
  sets.push_back(number_set("controller.kp", 10.0 * plant.inertia));
  sets.push_back(number_set("controller.kd", 5.0 * plant.inertia));
  sets.push_back(number_set("disturbance.amplitude_Nm", disturbance_of(plant)));
  return sets;
}

std::string tuning_of(const IdentifiedPlant& plant) {
  // Delay and period bound the frequencies of controller and observer. A torque beyond that of
  // disturbance and friction is noise or a limit cycle.
  const double fastest = 1.0 / (plant.delay_s + plant.period_s);
  const double slowest = 0.02 * fastest;
  const double J = plant.inertia;
  // The filter's poles have about the magnitude (Q/(J² R T²))^(1/6).
  const auto process_noise = [&](double frequency) {
    const double cubed = frequency * frequency * frequency;
    return cubed * cubed * J * J * plant.period_s * plant.period_s;
  };
  return fmt::format(
      "algorithm = \"cmaes\"\nbudget = 192\n\n"
      "[set]\nobserver.name = \"kfd\"\nobserver.process_noise_on = \"disturbance\"\n"
      "observer.initial_covariance = [1, 1, 1]\nrun.duration_s = 2.0\n\n"
      "[search]\n"
      "controller.kp = {{ log_uniform = [{:.6g}, {:.6g}] }}\n"
      "controller.kd = {{ log_uniform = [{:.6g}, {:.6g}] }}\n"
      "observer.process_noise = {{ log_uniform = [{:.6g}, {:.6g}] }}\n\n"
      "[objective]\nrms_position_rad = {{ goal = \"min\", over = \"q90\" }}\n\n"
      "[constraint]\nrms_torque_Nm = {{ max = {:.6g} }}\n",
      J * slowest * slowest, J * fastest * fastest, J * slowest, 2.0 * J * fastest,
      process_noise(slowest), process_noise(fastest),
      1.1 * (disturbance_of(plant) + std::abs(plant.offset_torque) + plant.coulomb_friction));
}

}  // namespace

IdentifiedScenarioKind identified_motor() {
  return {"motor_estimation", "stf", plant_sets, other_sets, tuning_of};
}

}  // namespace breakwater
