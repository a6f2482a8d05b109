// Scenario two_inertia, and transmissions in the axis rig.

#include <cmath>

#include "regression/run_case.h"

namespace breakwater::two_inertia_test {
namespace {

using Sets = std::vector<std::string>;

double metric(const std::string& case_name, const std::string& name, const Sets& sets = {}) {
  return testing::completed_run("two_inertia", case_name, sets).metric(name).value_or(NAN);
}

const std::vector<std::string> kWithSpring = {"sf-kfd", "sf-stf", "sf-qbank", "lmpc"};

TEST(TwoInertiaScenario, CancelledReactionVibratesAndItsFeedbackDamps) {
  const double rrc = metric("rrc", "residual_vibration_rad_s");
  EXPECT_LT(rrc, 2e-3);
  EXPECT_GT(metric("pd-dob", "residual_vibration_rad_s"), 20.0 * rrc);
  EXPECT_LT(metric("rrc", "overshoot_rad"), 0.002);
  EXPECT_GT(metric("pd-dob", "overshoot_rad"), 0.02);
}

TEST(TwoInertiaScenario, ModelsWithTheSpringEstimateTheLoad) {
  for (const std::string& name : kWithSpring) {
    EXPECT_LT(metric(name, "rmse_load_velocity_rad_s"), 0.03) << name;
    EXPECT_LT(metric(name, "residual_vibration_rad_s"), 3e-3) << name;
  }
  EXPECT_GT(metric("rrc", "rmse_load_velocity_rad_s"), 0.1);
}

// At rest under a load torque d the spring twists by d/K. PD control has K_p e = d, and resonance
// ratio control has K_p e = K_r d.
TEST(TwoInertiaScenario, LoadTorqueLeavesTheErrorsOfTheClosedForms) {
  constexpr double kTorque = 1.0, kGain = 25.0, kStiffness = 50.0, kReaction = 2.0;
  const auto error = [](const std::string& name) {
    return metric(name, "steady_state_error_rad", {"task.kind=torque_step"});
  };
  EXPECT_NEAR(error("pd"), kTorque * (1.0 / kGain + 1.0 / kStiffness), 1e-3);
  EXPECT_NEAR(error("rrc"), kTorque * (kReaction / kGain + 1.0 / kStiffness), 1e-3);
  for (const std::string& name : kWithSpring) {
    EXPECT_NEAR(error(name), 0.0, 2e-4) << name;
    EXPECT_LT(metric(name, "recovery_time_s", {"task.kind=torque_step"}), 0.3) << name;
  }
}

TEST(TwoInertiaScenario, EncoderMayBeAtTheLoadAndTheMotorBehindAGear) {
  for (const Sets& sets : {Sets{"encoder.side=load"}, Sets{"transmission.ratio=3"},
                           Sets{"transmission.ratio=3", "encoder.side=load"}}) {
    EXPECT_NEAR(metric("sf-kfd", "steady_state_error_rad", sets), 0.0, 2e-4) << sets.front();
  }
  EXPECT_NEAR(metric("rrc", "steady_state_error_rad", {"transmission.ratio=3"}), 0.0, 2e-4);
}

// N = 2, J_m = 1/4 and J_l = 1 move as N = 1 and J_l = 1, if the torque on the load is twice as
// large.
TEST(TwoInertiaScenario, RigidGearReflectsTheInertiaOfItsMotor) {
  const auto peak = [](const Sets& sets) {
    return *testing::completed_run("motor_estimation", "idob", sets).metric("peak_position_rad");
  };
  const double geared = peak({"transmission.ratio=2", "transmission.motor_inertia_kgm2=0.25",
                              "nominal.motor_inertia_kgm2=0.25", "disturbance.amplitude_Nm=20"});
  EXPECT_NEAR(geared, peak({}), 1e-9);
}

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

TEST(TwoInertiaScenario, BacklashMakesADifferenceOnlyWhereItIsThere) {
  const auto hash = [](const Sets& sets) {
    return testing::completed_run("two_inertia", "rrc", sets).state_hash;
  };
  EXPECT_EQ(hash({}), hash({"transmission.backlash_rad=0.03"}));
  EXPECT_NE(hash({"task.kind=reversal"}),
            hash({"task.kind=reversal", "transmission.backlash_rad=0.03"}));
  EXPECT_NE(hash({}), hash({"transmission.kinematic_error_rad=1e-4"}));
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

TEST(TwoInertiaScenario, RefusesWhatContradictsItself) {
  const auto expect_refused = [](const std::string& name, const Sets& sets,
                                 const std::string& words) {
    try {
      testing::prepare("two_inertia", name, sets);
      ADD_FAILURE() << "accepted: " << words;
    } catch (const std::invalid_argument& refused) {
      EXPECT_TRUE(has(refused.what(), words)) << refused.what();
    }
  };
  expect_refused("rrc", {"encoder.side=load"}, "encoder.side: must be motor for nominal.model");
  expect_refused("rrc", {"nominal.model=spring", "observer.name=stf"},
                 "nominal.model: must be motor for resonance ratio control");
  expect_refused("sf-kfd", {"nominal.stiffness_Nm_rad=0"},
                 "nominal.stiffness_Nm_rad: must be positive for nominal.model");
  expect_refused("rrc", {"nominal.stiffness_Nm_rad=0"},
                 "nominal.stiffness_Nm_rad: must be positive for resonance ratio control");
  expect_refused("rrc", {"nominal.model=rigid", "nominal.motor_inertia_kgm2=0"},
                 "nominal.motor_inertia_kgm2: must be positive for resonance ratio control");
  expect_refused("sf-kfd", {"observer.name=idob"},
                 "nominal.model: must be rigid or motor for idob");
  expect_refused(
      "sf-kfd", {"transmission.motor_joint=\"\""},
      "transmission.motor_inertia_kgm2: must be above 0 where the transmission has a stiffness");
  expect_refused("sf-kfd", {"transmission.stiffness_Nm_rad=1e9"},
                 "beyond the stability limit for a timestep of 0.0005 s");
  expect_refused("sf-kfd", {"transmission.stiffness_Nm_rad=0"},
                 "must have one joint and one actuator");
  expect_refused("sf-kfd",
                 {"transmission.motor_joint=\"\"", "transmission.motor_inertia_kgm2=0.01"},
                 "must have one joint and one actuator");
  expect_refused("sf-kfd", {"task.kind=reversal", "task.reversal_s=0.05"},
                 "task.reversal_s: must be later than task.from_s");
}

}  // namespace
}  // namespace breakwater::two_inertia_test
