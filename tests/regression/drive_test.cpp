// The drive as it is, in the scenarios of axes and arms.
#include "regression/run_case.h"
#include "tables.h"

namespace breakwater::drive_test {

// The drive as it is, in the scenarios of axes and arms.
using testing::completed_run;
using testing::Sets;
using testing::operator+;

constexpr const char* kMotor = "motor_estimation";

// The balance of momentum over a sample gives d, since the motor's inertia is 1 kg m² and its drive
// ideal.
TEST(Drive, TheTrueDisturbanceHasTheDryFriction) {
  const std::vector<Sets> laws = {
      {"friction.law=coulomb"},
      {"friction.law=stribeck", "friction.static_ratio=1.5", "friction.stribeck_velocity=0.05"},
      {"friction.law=load_dependent", "friction.load_ratio=0.1"}};
  for (const Sets& law : laws) {
    const Recording run = completed_run(
        kMotor, "dkf",
        Sets{"run.duration_s=10", "disturbance.kind=two_sines", "plant.coulomb_friction_Nm=0.5"} +
            law);
    const Track& track = run.track("control");
    const auto d = track.values("d_true_Nm"), velocity = track.values("velocity_true_rad_s"),
               torque = track.values("applied_Nm"), friction = track.values("friction_Nm");
    std::size_t sliding = 0;
    for (std::size_t k = 1500; k + 1 < d.size(); ++k) {
      if (std::abs(velocity[k]) < 0.02 || velocity[k] * velocity[k + 1] < 0.0) continue;
      ++sliding;
      ASSERT_NEAR(d[k], torque[k] - (velocity[k + 1] - velocity[k]) / 1e-3, 0.02)
          << law.front() << " in row " << k;
      ASSERT_LT(friction[k] * velocity[k], 0.0);
    }
    EXPECT_GT(sliding, 1000U) << law.front();
    // The shaft sticks after a step. An observer finds all of d.
    const Sets held = Sets{"plant.coulomb_friction_Nm=0.5"} + law;
    EXPECT_LT(completed_run(kMotor, "dkf", held).metric("rmse_disturbance_Nm").value(), 0.1)
        << law.front();
  }
}

TEST(Drive, EachPartChangesTheMotorAndLogsItsSignals) {
  const Sets brief = {"run.duration_s=3"};
  const Recording ideal = completed_run(kMotor, "vfakfd", brief);
  const auto names_of = [](const Recording& run) {
    std::vector<std::string> names;
    const Track& track = run.track("control");
    for (std::size_t i = 0; i < track.signals(); ++i) names.push_back(track.signal(i).name);
    return names;
  };
  for (const auto& row : testing::rows_of("DriveParts")) {
    const Sets signals = testing::words_in(row.at(1));
    const Recording run = completed_run(kMotor, "vfakfd", brief + testing::words_in(row.at(0)));
    EXPECT_NE(run.state_hash, ideal.state_hash) << row.at(0);
    std::vector<std::string> expected = names_of(ideal);
    for (const std::string& name : names_of(run)) {
      const bool was_there = std::find(expected.begin(), expected.end(), name) != expected.end();
      const bool is_its_own = std::find(signals.begin(), signals.end(), name) != signals.end();
      EXPECT_NE(was_there, is_its_own) << name;
    }
    EXPECT_EQ(names_of(run).size(), expected.size() + signals.size()) << row.at(0);
  }
}

// Without load dependence the law has the bits of the engine's friction. The log has that of all.
TEST(Drive, ALawOfOneJointLeavesTheOthersTheirFriction) {
  const Sets brief = {"run.duration_s=2", "push.start_s=0.1", "push.rise_s=0.5"};
  const auto run = [&](const Sets& sets) {
    return completed_run("arm_push", "proposed-link1", sets + brief);
  };
  const Recording law =
      run({"axis.joint3.friction.law=load_dependent", "axis.joint3.friction.load_ratio=0"});
  EXPECT_EQ(law.state_hash, run({}).state_hash);
  const std::vector<double> friction = law.track("control").values("friction_Nm"),
                            speed = law.track("control").values("dq_true_rad_s");
  int sliding = 0;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (std::abs(speed[i]) < 0.05) continue;
    ++sliding;
    EXPECT_NEAR(friction[i], -std::copysign(4.0, speed[i]), 0.02) << i;
  }
  EXPECT_GT(sliding, 0);
}

// Scenario two_inertia, and transmissions in the axis rig.

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

}  // namespace breakwater::drive_test
