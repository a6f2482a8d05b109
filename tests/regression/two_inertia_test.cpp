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

TEST(TwoInertiaScenario, BacklashMakesADifferenceOnlyWhereItIsThere) {
  const auto hash = [](const Sets& sets) {
    return testing::completed_run("two_inertia", "rrc", sets).state_hash;
  };
  EXPECT_EQ(hash({}), hash({"transmission.backlash_rad=0.03"}));
  EXPECT_NE(hash({"task.kind=reversal"}),
            hash({"task.kind=reversal", "transmission.backlash_rad=0.03"}));
  EXPECT_NE(hash({}), hash({"transmission.kinematic_error_rad=1e-4"}));
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
  expect_refused("rrc", {"encoder.side=load"}, "nominal.model: motor needs encoder.side");
  expect_refused("rrc", {"nominal.model=spring", "observer.name=stf"},
                 "nominal.model: must be motor for resonance ratio control");
  expect_refused("sf-kfd", {"nominal.stiffness_Nm_rad=0"},
                 "nominal.model: spring needs a nominal stiffness");
  expect_refused("sf-kfd", {"observer.name=idob"},
                 "nominal.model: must be rigid or motor for idob");
  expect_refused(
      "sf-kfd", {"transmission.motor_joint=\"\""},
      "transmission.motor_joint: a transmission with a stiffness needs the motor's joint");
  expect_refused("sf-kfd", {"transmission.stiffness_Nm_rad=1e9"},
                 "beyond the stability limit for a timestep of 0.0005 s");
  expect_refused("sf-kfd", {"transmission.stiffness_Nm_rad=0"},
                 "must have one joint and one actuator");
  expect_refused("sf-kfd", {"task.kind=reversal", "task.reversal_s=0.05"},
                 "task.reversal_s: must be later than task.from_s");
}

}  // namespace
}  // namespace breakwater::two_inertia_test
