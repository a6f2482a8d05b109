// Impacts by Breakwater's Hunt-Crossley law and by Simbody's: one table. Exit status 1 if a peak or
// a duration differs by more than 0.5 %.
//
// A sphere of 1 kg strikes a half space. The three-link arm of models/arm.xml, without joint
// friction and rotor inertia, is driven against it by constant torques. Simbody's HuntCrossleyForce
// is k x^1.5 (1 + 1.5 c v), with k = 4/3 sqrt(R) E and E = E1/2^1.5 for two equal materials.
#include <cstdio>

#include <breakwater/sim/contact.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include <breakwater/sim/wall_contact.h>
#include "bench/simbody_impacts.h"
#include "sim/small_models.h"

namespace {

using simbody_bench::Material;
using simbody_bench::Pulse;

constexpr double kLargestDeviation = 0.005;

Pulse by_breakwater(breakwater::Model model, const Material& material, double wall_x_m,
                    const std::vector<double>& start, const std::vector<double>& speeds,
                    double duration_s) {
  using namespace breakwater;
  model.set_physics(simbody_bench::kStep_s, Integrator::rk4);
  place_wall(model, "wall", wall_x_m);
  breakwater::testing::FunctionController torques([](const Sample&, Eigen::Ref<Eigen::VectorXd> u) {
    for (Eigen::Index i = 0; i < u.size(); ++i)
      u(i) = simbody_bench::kTorques_Nm[static_cast<std::size_t>(i)];
  });
  Simulation simulation(std::move(model), torques, {}, 1);
  WallContact contact(
      simulation.model(), "tip", "wall",
      std::make_unique<HuntCrossley>(material.stiffness, 1.5, material.dissipation_s_m), {});
  contact.set_solid(true);
  simulation.add(contact);
  simulation.set_collidable(simulation.model().id(mjOBJ_GEOM, "wall"), false);
  simulation.set_position(start);
  simulation.set_velocity(speeds);
  Pulse pulse;
  while (simulation.time_s() < duration_s && !pulse.has_ended) {
    simulation.step();
    pulse.add(contact.force_N());
  }
  return pulse;
}

Pulse sphere_by_breakwater(const Material& material, double speed_m_s) {
  return by_breakwater(breakwater::Model::load_physics(
                           breakwater::testing::source_file("models/impact.xml"), {"tip", "wall"}),
                       material, 0.0, {-1e-3}, {speed_m_s}, 2.0);
}

Pulse arm_by_breakwater(const Material& material, double distance_m) {
  breakwater::Model model = breakwater::Model::load_physics(
      breakwater::testing::source_file("models/arm.xml"), {"tip", "wall"});
  for (int i = 0; i < model->nv; ++i) model.get()->dof_armature[i] = 0.0;
  for (const char* joint : {"joint1", "joint2", "joint3"}) {
    breakwater::set_coulomb_friction(model, model.id(mjOBJ_JOINT, joint), 0.0);
  }
  return by_breakwater(std::move(model), material, 0.45 + distance_m,
                       {simbody_bench::kAngles_rad.begin(), simbody_bench::kAngles_rad.end()},
                       {0.0, 0.0, 0.0}, 2.0);
}

bool compare(const std::string& name, const Pulse& ours, const Pulse& theirs) {
  const double peak = ours.peak_N / theirs.peak_N - 1.0;
  const double duration = ours.duration_s / theirs.duration_s - 1.0;
  std::printf("| %s | %.4f | %.4f | %+.3f %% | %.2f | %.2f | %+.3f %% |\n", name.c_str(),
              ours.peak_N, theirs.peak_N, 100.0 * peak, 1e3 * ours.duration_s,
              1e3 * theirs.duration_s, 100.0 * duration);
  return ours.has_ended && theirs.has_ended && std::abs(peak) <= kLargestDeviation &&
         std::abs(duration) <= kLargestDeviation;
}

}  // namespace

int main() {
  std::printf(
      "| impact | peak [N] | Simbody [N] | difference | duration [ms] | Simbody [ms] | "
      "difference |\n|---|---|---|---|---|---|---|\n");
  bool agrees = true;
  for (const Material& material : {Material{2e5, 0.0}, Material{2e5, 1.0}, Material{1e7, 0.5}}) {
    char law[100];
    std::snprintf(law, sizeof(law), "k = %.0e, α = %g", material.stiffness,
                  material.dissipation_s_m);
    for (const double speed : {0.05, 0.2, 1.0}) {
      char name[200];
      std::snprintf(name, sizeof(name), "sphere, %s, %g m/s", law, speed);
      agrees &= compare(name, sphere_by_breakwater(material, speed),
                        simbody_bench::sphere_by_simbody(material, speed));
    }
    for (const double distance_m : {0.002, 0.006}) {
      char name[200];
      std::snprintf(name, sizeof(name), "arm, %s, %g mm away", law, 1e3 * distance_m);
      agrees &= compare(name, arm_by_breakwater(material, distance_m),
                        simbody_bench::arm_by_simbody(material, distance_m));
    }
  }
  return agrees ? 0 : 1;
}
