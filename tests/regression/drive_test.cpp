// The drive as it is, in the scenarios of axes and arms.
#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::completed_run;
using testing::prepare;
using testing::run_case;
using Sets = std::vector<std::string>;

constexpr const char* kMotor = "motor_estimation";

Sets with(Sets sets, const Sets& others) {
  sets.insert(sets.end(), others.begin(), others.end());
  return sets;
}

TEST(Drive, PartsThatAreOnButNeutralAreTheIdealDrive) {
  const Sets brief = {"run.duration_s=3"};
  const std::uint64_t ideal = completed_run(kMotor, "vfakfd", brief).state_hash;
  EXPECT_EQ(completed_run(kMotor, "vfakfd", with(brief, {"drive.current_limit_A=1e9"})).state_hash,
            ideal);
  EXPECT_EQ(completed_run(kMotor, "vfakfd", with(brief, {"control.jitter_s=1e-12"})).state_hash,
            ideal);
  const Sets dry = with(brief, {"plant.coulomb_friction_Nm=0.5"});
  EXPECT_EQ(completed_run(kMotor, "vfakfd",
                          with(dry, {"friction.law=load_dependent", "friction.load_ratio=0"}))
                .state_hash,
            completed_run(kMotor, "vfakfd", dry).state_hash);
  EXPECT_NE(completed_run(kMotor, "vfakfd", dry).state_hash, ideal);
}

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
        with({"run.duration_s=10", "disturbance.kind=two_sines", "plant.coulomb_friction_Nm=0.5"},
             law));
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
    const Sets held = with({"plant.coulomb_friction_Nm=0.5"}, law);
    EXPECT_LT(completed_run(kMotor, "dkf", held).metric("rmse_disturbance_Nm").value(), 0.1)
        << law.front();
  }
}

// Each part: its keys for the motor, and the signals that it adds.
struct Part {
  Sets keys;
  std::vector<std::string> signals;
};

std::vector<Part> parts() {
  return {
      {{"plant.coulomb_friction_Nm=0.5", "friction.law=stribeck", "friction.static_ratio=1.5",
        "friction.stribeck_velocity=0.05"},
       {"friction_Nm"}},
      {{"plant.coulomb_friction_Nm=0.5", "friction.law=lugre", "friction.static_ratio=1.5",
        "friction.stribeck_velocity=0.05", "friction.bristle_stiffness=1e4",
        "friction.bristle_damping=10"},
       {"friction_Nm"}},
      {{"plant.coulomb_friction_Nm=0.5", "friction.law=load_dependent", "friction.load_ratio=0.1"},
       {"friction_Nm"}},
      {{"drive.current_bandwidth_rad_s=200"}, {"current_A", "motor_Nm"}},
      {{"drive.voltage_limit_V=24", "drive.resistance_ohm=2", "drive.inductance_H=1e-3"},
       {"current_A", "motor_Nm"}},
      {{"drive.cogging_Nm=0.1", "drive.cogging_per_turn=12"}, {"current_A", "motor_Nm"}},
      {{"drive.ripple_ratio=0.05", "drive.ripple_per_turn=6"}, {"current_A", "motor_Nm"}},
      {{"control.delay_s=1.5e-3"}, {}},
      {{"control.jitter_s=1e-3"}, {}},
      {{"control.drop_probability=0.1"}, {}},
      {{"encoder.eccentricity_rad=1e-3"}, {}},
      {{"encoder.interpolation_rad=1e-3", "encoder.interpolation_per_turn=64"}, {}}};
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
  for (const Part& part : parts()) {
    const Recording run = completed_run(kMotor, "vfakfd", with(brief, part.keys));
    EXPECT_NE(run.state_hash, ideal.state_hash) << part.keys.back();
    std::vector<std::string> expected = names_of(ideal);
    for (const std::string& name : names_of(run)) {
      const bool was_there = std::find(expected.begin(), expected.end(), name) != expected.end();
      const bool is_its_own =
          std::find(part.signals.begin(), part.signals.end(), name) != part.signals.end();
      EXPECT_NE(was_there, is_its_own) << name;
    }
    EXPECT_EQ(names_of(run).size(), expected.size() + part.signals.size()) << part.keys.back();
  }
}

TEST(Drive, EachJointOfTheArmHasItsParts) {
  const Sets brief = {"run.duration_s=12"};
  const std::uint64_t ideal = completed_run("arm_push", "proposed-link2", brief).state_hash;
  const std::vector<Sets> parts = {
      {"friction.law=lugre", "friction.static_ratio=1.2", "friction.stribeck_velocity=0.01",
       "friction.bristle_stiffness=1e5", "friction.bristle_damping=300"},
      {"drive.current_bandwidth_rad_s=2000", "drive.current_damping_ratio=0.7"},
      {"control.delay_s=5e-4"},
      {"sensor.encoder_eccentricity_rad=1e-5"}};
  for (const Sets& part : parts) {
    EXPECT_NE(completed_run("arm_push", "proposed-link2", with(brief, part)).state_hash, ideal)
        << part.front();
  }
}

const Sets kElastic = {"transmission.stiffness_Nm_rad=[2e4,1e4,5e3]",
                       "transmission.damping_Nms_rad=5", "sensor.encoder_side=motor",
                       "friction.side=motor"};

// The link is light without the inertia of its motor, and needs a hand with less damping.
constexpr const char* kSoftHand = "push.damping_Nms_rad=10";

// At rest under the hand's moment M about joint 3, the spring of this joint has the twist −M/K.
TEST(Drive, SpringOfAJointOfTheArmTwistsByTheHandsMoment) {
  const Recording run =
      completed_run("arm_push", "proposed-link3", with(kElastic, {kSoftHand, "run.duration_s=5"}));
  // The value of the last joint at the last sample.
  const auto last = [&](const char* name) { return run.track("control").values(name).back(); };
  const double moment_Nm = last("push_moment_Nm");
  EXPECT_GT(std::abs(moment_Nm), 5.0);
  EXPECT_NEAR(last("motor_q_true_rad") - last("q_true_rad"), -moment_Nm / 5e3,
              0.01 * std::abs(moment_Nm) / 5e3);
  EXPECT_NEAR(last("transmission_Nm"), -moment_Nm, 0.01 * std::abs(moment_Nm));
}

// A rigid joint beside it gets the true torque of its motor.
TEST(Drive, RigidJointOfAnElasticArmGetsTheTorqueOfItsMotor) {
  const Recording run = completed_run(
      "arm_push", "proposed-link3",
      {"transmission.stiffness_Nm_rad=[2e4,0,0]", "transmission.damping_Nms_rad=5",
       "sensor.encoder_side=motor", "friction.side=motor", "drive.current_bandwidth_rad_s=2000",
       "drive.current_damping_ratio=0.7", kSoftHand, "run.duration_s=5"});
  // The values of joint 3, the last of each sample.
  const auto of_joint_3 = [&](const char* name) {
    const std::vector<double> all = run.track("control").values(name);
    std::vector<double> own;
    for (std::size_t i = 2; i < all.size(); i += 3) own.push_back(all[i]);
    return own;
  };
  EXPECT_EQ(of_joint_3("transmission_Nm"), of_joint_3("motor_Nm"));
  EXPECT_NE(of_joint_3("transmission_Nm"), of_joint_3("torque_applied_Nm"));
}

// The same motion with the inertia and the friction of the motor before and behind the gear.
TEST(Drive, RatioOfAJointOfTheArmReflectsItsMotor) {
  const auto overshoot = [](const Sets& sets) {
    return *completed_run("arm_push", "proposed-link2",
                          with(with(kElastic, sets), {"run.duration_s=8"}))
                .metric("max_push_rad");
  };
  const double direct = overshoot(
      {"transmission.motor_inertia_kgm2=0.25", "transmission.motor_viscous_friction_Nms_rad=0.5"});
  const double geared =
      overshoot({"transmission.motor_inertia_kgm2=1e-4",
                 "transmission.motor_viscous_friction_Nms_rad=2e-4", "transmission.ratio=50"});
  EXPECT_NEAR(geared, direct, 1e-9);
  EXPECT_NE(overshoot({}), direct);
}

// The armature of a joint is the inertia of its motor, also where this gets a rotor.
TEST(Drive, StiffTransmissionOfTheArmIsARigidOne) {
  const auto peak = [](const Sets& sets) {
    return *completed_run("arm_push", "proposed-link1",
                          with(sets, {kSoftHand, "run.duration_s=10"}))
                .metric("peak_speed_rad_s");
  };
  const double rigid = peak({});
  EXPECT_NEAR(peak({"transmission.stiffness_Nm_rad=3e5", "transmission.damping_Nms_rad=4",
                    "friction.side=motor"}),
              rigid, 0.005 * rigid);
}

TEST(Drive, ElasticArmHoldsTheContactWithEachLaw) {
  for (const char* law : {"kelvin_voigt", "hunt_crossley"}) {
    const Recording run = completed_run(
        "arm_wall_contact", "proposed-2N",
        with(kElastic, {"run.duration_s=20", "force.from_s=12", "wall.solid_from_s=10",
                        "metrics.from_s=16", "metrics.to_s=20", "record.fine_from_s=0",
                        "record.fine_to_s=0", std::string("contact.law=") + law}));
    EXPECT_NEAR(run.metric("mean_force_error_N").value_or(9.0), 0.0, 0.25) << law;
    EXPECT_EQ(run.track("control").signal(0).name, "qpos");
    EXPECT_EQ(run.track("control").signal(0).values.size(), 3U);
  }
}

TEST(Drive, AListGivesEachJointItsNumber) {
  const auto hash = [](const Sets& sets) {
    return completed_run("arm_push", "proposed-link1", with(sets, {"run.duration_s=4"})).state_hash;
  };
  const std::uint64_t one = hash({"drive.current_bandwidth_rad_s=500", "plant.friction_Nm=3"});
  EXPECT_EQ(hash({"drive.current_bandwidth_rad_s=[500,500,500]", "plant.friction_Nm=[3,3,3]"}),
            one);
  EXPECT_NE(hash({"drive.current_bandwidth_rad_s=[500,500,400]", "plant.friction_Nm=3"}), one);
  EXPECT_NE(hash({"drive.current_bandwidth_rad_s=500", "plant.friction_Nm=[3,3,2]"}), one);
  // The effective configuration gives the same run.
  const PreparedRun run =
      prepare("arm_push", "proposed-link1", {"transmission.stiffness_Nm_rad=[0,0,5e3]"});
  EXPECT_TRUE(has(run.config_text, "stiffness_Nm_rad = [0.0, 0.0, 5000.0]")) << run.config_text;
  EXPECT_TRUE(run.ineffective.empty());
}

TEST(Drive, ArmRefusesWrongKeys) {
  struct Row {
    Sets sets;
    std::vector<std::string> complaint;
  };
  const std::vector<Row> rows = {
      {{"transmission.stiffness_Nm_rad=[1e3,1e3]"},
       {"transmission.stiffness_Nm_rad: must be a number or an array of 3, has 2"}},
      {{"friction.law=lugre", "friction.static_ratio=1.2", "friction.stribeck_velocity=0.01",
        "friction.bristle_stiffness=[1e5,1e5,1e5,1e5]", "friction.bristle_damping=300"},
       {"friction.bristle_stiffness: must be a number or an array of 3, has 4"}},
      {{"drive.current_limit_A=[1,-1,1]"}, {"drive.current_limit_A[2]: must be 0 or more"}},
      {{"plant.friction_Nm=[-0.5,1,1]"}, {"plant.friction_Nm: must be -1"}},
      {{"transmission.stiffness_Nm_rad=1e3", "transmission.ratio=0"}, {"transmission.ratio"}},
      {{"transmission.stiffness_Nm_rad=[0,0,1e9]"},
       {"transmission to joint \"joint3\"", "beyond the stability limit"}},
      {{"sensor.encoder_side=both"}, {"sensor.encoder_side: must be one of load, motor"}},
      {{"transmission.motor_joint=a"}, {"transmission.motor_joint: unknown key"}}};
  for (const Row& row : rows) {
    EXPECT_TRUE(testing::has_all(
        complaint_of([&] { prepare("arm_push", "proposed-link1", row.sets); }), row.complaint))
        << row.sets.back() << "\n"
        << complaint_of([&] { prepare("arm_push", "proposed-link1", row.sets); });
  }
}

TEST(Drive, RefusesWrongKeys) {
  const testing::TemporaryPath empty("empty.csv", "jitter_s\n");
  const testing::TemporaryPath early("early.csv", "jitter_s\n-1\n");
  const testing::TemporaryPath other("other.csv", "time_s\n1\n");
  const auto table = [](const testing::TemporaryPath& path) {
    return Sets{"control.jitter=csv", "control.jitter_file=" + path.string()};
  };
  const Sets stribeck = {"friction.law=stribeck", "friction.static_ratio=1.5",
                         "friction.stribeck_velocity=0.05"};
  struct Row {
    Sets sets;
    std::vector<std::string> complaint;
  };
  const std::vector<Row> rows = {
      {{"friction.law=sticky"}, {"friction.law"}},
      {stribeck, {"friction.law: needs a Coulomb friction > 0"}},
      {{"friction.law=stribeck"}, {"friction.static_ratio: is missing"}},
      {with(stribeck, {"friction.static_ratio=0.9"}), {"friction.static_ratio"}},
      {{"friction.law=load_dependent", "friction.load_ratio=1"}, {"friction.load_ratio"}},
      {{"drive.torque_constant_Nm_A=0"}, {"drive.torque_constant_Nm_A"}},
      {{"drive.voltage_limit_V=24"}, {"drive.resistance_ohm: must be above 0"}},
      {{"drive.current_bandwidth_rad_s=-1"}, {"drive.current_bandwidth_rad_s"}},
      {{"drive.cogging_Nm=0.1", "drive.cogging_per_turn=0"}, {"drive.cogging_per_turn"}},
      {{"control.delay_s=-1e-3"}, {"control.delay_s"}},
      {{"control.delay_s=1e4"}, {"control.delay_s: a delay must be at most 1e6 physics steps"}},
      {{"control.drop_probability=1"}, {"control.drop_probability"}},
      {table(empty), {"control.jitter_file", "has no rows"}},
      {table(early), {"control.jitter_file: a delay must not be negative"}},
      {table(other), {"control.jitter_file", "jitter_s"}},
      {{"encoder.eccentricity_rad=-1"}, {"encoder.eccentricity_rad"}}};
  for (const Row& row : rows) {
    EXPECT_TRUE(
        testing::has_all(complaint_of([&] { prepare(kMotor, "vfakfd", row.sets); }), row.complaint))
        << row.sets.back();
  }
}

}  // namespace
}  // namespace breakwater
