// Scenario two_inertia, and transmissions in the axis rig.

#include <cmath>

#include "regression/run_case.h"

namespace breakwater::two_inertia_test {
namespace {

using Sets = std::vector<std::string>;

// With a stiff spring a rotor of its own moves as a rigid gear.
TEST(TwoInertiaScenario, MotorThatTheModelLacksGetsARotor) {
  const auto run = [](Sets sets) {
    sets.insert(sets.end(), {"transmission.ratio=2", "transmission.motor_inertia_kgm2=0.25",
                             "nominal.motor_inertia_kgm2=0.25", "disturbance.amplitude_Nm=20",
                             "physics.timestep_s=2e-4"});
    return testing::completed_run("motor_estimation", "idob", sets);
  };
  const auto peak = [](const Recording& of) { return *of.metric("peak_position_rad"); };
  const Recording stiff =
                      run({"transmission.stiffness_Nm_rad=1e6", "transmission.damping_Nms_rad=50"}),
                  rigid = run({});
  EXPECT_NEAR(peak(stiff), peak(rigid), 2e-3 * peak(rigid));
  EXPECT_NE(peak(stiff), peak(rigid));
  // The log has the positions of the model file, for pictures.
  const Track& track = stiff.track("control");
  EXPECT_EQ(track.signal(0).name, "qpos");
  EXPECT_EQ(track.signal(0).values.size(), 1U);
  EXPECT_EQ(rigid.track("control").signals() + 3, track.signals());
}

// Where a side moves, its dry friction has the Coulomb level and opposes its motion.
TEST(TwoInertiaScenario, DryFrictionActsOnTheSideOfItsKey) {
  const Sets sets = {"plant.coulomb_friction_Nm=0.2", "friction.law=stribeck",
                     "friction.static_ratio=1", "friction.stribeck_velocity=1"};
  std::vector<std::uint64_t> hashes;
  for (const auto& [side, velocity] :
       {std::pair{"load", "velocity_true_rad_s"}, std::pair{"motor", "motor_velocity_rad_s"}}) {
    Sets own = sets;
    own.push_back(std::string("friction.side=") + side);
    const Recording run = testing::completed_run("two_inertia", "pd", own);
    hashes.push_back(run.state_hash);
    const std::vector<double> friction = run.track("control").values("friction_Nm"),
                              speed = run.track("control").values(velocity);
    int moving = 0;
    for (std::size_t i = 0; i < speed.size(); ++i) {
      if (std::abs(speed[i]) < 0.1) continue;
      ++moving;
      EXPECT_NEAR(friction[i], -std::copysign(0.2, speed[i]), 0.02) << side << " " << i;
    }
    EXPECT_GT(moving, 100) << side;
    const Sets coulomb = {sets[0], own.back()};
    EXPECT_EQ(testing::completed_run("two_inertia", "pd", coulomb).state_hash, run.state_hash);
  }
  EXPECT_NE(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace breakwater::two_inertia_test
