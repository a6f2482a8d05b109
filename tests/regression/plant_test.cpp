// The scenario plant: shipped scenarios written as a plant's file, its metrics, and its refusals.
#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/experiment/run_tables.h>
#include <breakwater/plants/xml_file.h>
#include <breakwater/record/recording.h>

#include <cmath>
#include <map>

#include "catalogue.h"

namespace breakwater {
namespace {

constexpr const char* kMotor = R"(
scenario = "plant"
default_case = "own"
[model]
mjcf = "models/motor.xml"
[physics]
timestep_s = 1e-3
integrator = "rk4"
[control]
period_s = 1e-3
[run]
duration_s = 10.0
seed = 1
[axis.angle]
joint = "shaft"
encoder.bits = 12
encoder.rounding = "truncate"
disturbance.kind = "step"
disturbance.amplitude_Nm = 10.0
disturbance.start_s = 1.0
controller.name = "pd"
controller.kp = 10.0
controller.kd = 5.0
observer.name = "vfakfd"
observer.disturbance_order = 0
observer.process_noise_on = "input"
observer.process_noise = 0.0
observer.initial_covariance = [1e-8, 1e-8, 1e-8]
observer.alpha = 0.0
observer.lambda_min = 0.8
observer.lambda_max = 1.0
metric.rmse_velocity = { of = "angle_velocity_hat_rad_s", minus = "angle_velocity_true_rad_s", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.rmse_position = { of = "angle_position_hat_rad", minus = "angle_position_true_rad", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.rmse_disturbance = { of = "angle_d_hat_Nm", minus = "angle_d_true_Nm", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.peak_position = { of = "angle_position_true_rad", kind = "peak" }
metric.rms_position = { of = "angle_position_true_rad", kind = "rms", from_s = 1.0 }
metric.rms_torque = { of = "angle_applied_Nm", kind = "rms", from_s = 1.0 }
metric.disturbance_settling_time = { of = "angle_d_hat_Nm", minus = "angle_d_true_Nm", kind = "settling", level = 0.5, from_s = 1.0, to_s = 10.0 }
metric.transient_rmse_disturbance = { of = "angle_d_hat_Nm", minus = "angle_d_true_Nm", kind = "rmse", from_s = 1.0, to_s = 5.0 }
metric.lambda_mean = { of = "angle_lambda", kind = "mean", from_s = 5.0, to_s = 10.0 }
metric.lambda_min = { of = "angle_lambda", kind = "min" }
metric.rmse_raw_velocity = { of = "angle_position_measured_rad", take = "difference", minus = "angle_velocity_true_rad_s", kind = "rmse", from_s = 5.0, to_s = 10.0 }
metric.slowest_pole_continuous = { of = "angle_poles_continuous_re_rad_s", take = "largest", kind = "mean", from_s = 5.0, to_s = 10.0 }
[case.own]
[case.noisy]
axis.angle.noise.std_rad = 0.01
)";

constexpr const char* kCart = R"(
scenario = "plant"
default_case = "own"
[model]
mjcf = "models/cart.xml"
[physics]
timestep_s = 1e-3
integrator = "rk4"
[control]
period_s = 1e-3
[run]
duration_s = 10.0
seed = 1
[axis.cart]
joint = "rail"
plant.coulomb_friction_N = 0.3
drive.limit_N = 10.0
drive.resolution_N = 0.0390625
encoder.resolution_m = 2e-5
reference.kind = "step"
reference.value_m = 0.1
controller.name = "pd"
controller.kp = 10.0
controller.kd = 7.0710678118654755
observer.name = "fakfd"
observer.disturbance_order = 0
observer.process_noise_on = "input"
observer.process_noise = 1e-2
observer.observation_noise = 1e-4
observer.initial_covariance = [1e-2, 1e-4, 1e-2]
observer.gamma_d = 1.05
metric.steady_state_error = { of = "cart_reference_m", minus = "cart_position_true_m", kind = "mean", from_s = 5.0, to_s = 10.0 }
metric.settling_time = { of = "cart_reference_m", minus = "cart_position_true_m", kind = "settling", level = 0.005, to_s = 10.0 }
metric.estimate_rise_time = { of = "cart_d_hat_N", kind = "reach", level = 0.18963616764856731 }
metric.rms_input_step = { of = "cart_applied_N", kind = "rms_change", from_s = 5.0, to_s = 10.0 }
metric.max_position = { of = "cart_position_true_m", kind = "max" }
metric.rms_highpass_disturbance = { of = "cart_d_hat_N", take = "high_pass", cutoff_Hz = 150.0, kind = "rms" }
[case.own]
)";

// The tables of `text` are keys with dots after the tables of TOML, so they stand at the root.
std::string as_file(std::string text) {
  std::string metrics, rest;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    (line.starts_with("metric.") ? metrics : rest) += line + "\n";
  }
  return metrics + rest;
}

PreparedRun prepare_text(const std::string& text, const std::string& case_name,
                         const std::vector<std::string>& sets = {}) {
  const testing::TemporaryPath file("plant.toml", as_file(text));
  return prepare_run(testing::catalogue(), "plant", ScenarioFile(file, "plant"), case_name, sets);
}

std::map<std::string, double> metrics_of(const PreparedRun& run) {
  std::map<std::string, double> all;
  for (const Metric& metric : run.scenario->run({}).metrics) all[metric.name] = metric.value;
  return all;
}

void expect_same(const std::map<std::string, double>& own,
                 const std::map<std::string, double>& shipped) {
  for (const auto& [name, value] : own) {
    ASSERT_TRUE(shipped.contains(name)) << name;
    EXPECT_NEAR(value, shipped.at(name), 1e-9 * std::max(1.0, std::abs(value))) << name;
  }
}

// The axis has the name of the motor's sensor channel, and so its noise.
TEST(PlantTest, MotorEstimationAsAPlant) {
  const auto own = metrics_of(prepare_text(kMotor, "own"));
  EXPECT_EQ(own.size(), 12U);
  expect_same(own, metrics_of(testing::prepare("motor_estimation", "vfakfd")));
  expect_same(metrics_of(prepare_text(kMotor, "noisy")),
              metrics_of(testing::prepare("motor_estimation", "vfakfd", {"noise.std_rad=0.01"})));
}

TEST(PlantTest, CartPositionAsAPlant) {
  const auto own = metrics_of(prepare_text(kCart, "own"));
  EXPECT_EQ(own.size(), 6U);
  expect_same(own, metrics_of(testing::prepare("cart_position", "gamma-1.05")));
}

LoopAnalysis analysed(const PreparedRun& run) {
  const auto& scenario = dynamic_cast<const LoopScenario&>(*run.scenario);
  return analyse({{{"it"}, scenario.loops().front()}},
                 {.from_rad_s = 0.5, .points = 3, .settle_s = 1.0})
      .front();
}

TEST(PlantTest, MotorEstimationAsAPlantHasTheSameLoop) {
  const std::vector<std::string> idob = {"observer.poles_rad_s=[-10,-20,-30]"};
  const LoopAnalysis one = analysed(prepare_text(
      kMotor, "own", {"axis.angle.observer.name=\"idob\"", "axis.angle." + idob.front()}));
  const LoopAnalysis other = analysed(testing::prepare("motor_estimation", "idob", idob));
  const LoopCurve &own = one.designed, &shipped = other.designed;
  ASSERT_FALSE(shipped.points.empty()) << shipped.reason;
  const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 1e-9 * std::abs(b)); };
  near(own.margins.crossover_rad_s, shipped.margins.crossover_rad_s);
  near(own.margins.phase_margin_rad, shipped.margins.phase_margin_rad);
  near(own.margins.gain_reduction_margin, shipped.margins.gain_reduction_margin);
  near(own.margins.delay_margin_s, shipped.margins.delay_margin_s);
  near(own.margins.sensitivity_peak, shipped.margins.sensitivity_peak);
  near(own.bandwidth_rad_s, shipped.bandwidth_rad_s);
  ASSERT_EQ(one.measured.points.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    near(std::abs(one.measured.points[i].loop_gain), std::abs(other.measured.points[i].loop_gain));
  }
}

// The effective configuration of a run is a scenario file that gives the same run.
TEST(PlantTest, ItsConfigurationRunsAgain) {
  const PreparedRun run = prepare_text(kCart, "own");
  const PreparedRun again = prepare_text(run.config_text, "own");
  EXPECT_EQ(again.config_text, run.config_text);
  EXPECT_EQ(again.scenario->run({}).state_hash, run.scenario->run({}).state_hash);
}

// Another case may have an estimator that publishes it.
TEST(PlantTest, WarnsOfASignalThatIsNotThere) {
  const PreparedRun run =
      prepare_text(kCart, "own", {"metric.max_position.of=\"cart_position_tru_m\""});
  EXPECT_EQ(run.scenario->warnings(),
            std::vector<std::string>{"metric.max_position.of: the log has no signal "
                                     "\"cart_position_tru_m\" (did you mean "
                                     "cart_position_true_m?): the metric is absent"});
  EXPECT_FALSE(metrics_of(run).contains("max_position_m"));
}

TEST(PlantTest, TellsWhyAMetricIsAbsent) {
  const PreparedRun run =
      prepare_text(kCart, "own",
                   {"metric.settling_time.level=1e-9", "metric.rms_input_step.to_s=11.0",
                    "metric.estimate_rise_time.level=100.0", "metric.max_position.of=\"no_m\""});
  std::map<std::string, std::string> absent;
  for (const AbsentMetric& metric : run.scenario->run({}).absent) {
    absent[metric.name] = metric.reason;
  }
  const std::map<std::string, std::string> expected = {
      {"settling_time_s", "the magnitude ends beyond the level"},
      {"rms_input_step_N", "the run does not cover its window"},
      {"estimate_rise_time_s", "the magnitude never reaches the level"},
      {"max_position_m", "metric.max_position.of: the log has no signal \"no_m\""}};
  EXPECT_EQ(absent, expected);
  const RunSummary summary{.case_name = "own", .absent = {{"settling_time_s", "s", "why"}}};
  EXPECT_EQ(metrics_table("plant", summary, testing::catalogue()),
            "metric           value  unit\nsettling_time_s      –     s\n\nsettling_time_s: why\n");
}

// The file of docs/how-to/own-plant.md.
PreparedRun elastic_drive(const std::string& case_name, const std::vector<std::string>& sets = {}) {
  const ScenarioFile file(testing::source_file("tests/regression/elastic_drive.toml"), "plant");
  return prepare_run(testing::catalogue(), "plant", file, case_name, sets);
}

TEST(ElasticDriveTest, ItsModelWithTheSpringHoldsTheLoad) {
  const auto spring = metrics_of(elastic_drive("spring"));
  EXPECT_LT(spring.at("overshoot_percent"), 2.0);
  EXPECT_LT(spring.at("disturbed_rad"), 1e-3);
  // At rest PD control with K_p at the motor leaves d/(N² K_p) + d/K.
  const auto pd = metrics_of(elastic_drive("pd"));
  EXPECT_NEAR(pd.at("disturbed_rad"), 1.0 / (100.0 * 0.25) + 1.0 / 50.0, 1e-3);
}

// The numbers that nominal.from = "model" takes, as keys.
TEST(ElasticDriveTest, NominalNumbersOfTheModelAreThoseOfTheKeys) {
  for (const char* ratio : {"10.0", "7.0"}) {
    const std::string geared = std::string("axis.arm.transmission.ratio=") + ratio;
    for (const char* name : {"spring", "pd"}) {
      EXPECT_EQ(elastic_drive(name, {geared}).scenario->run({}).state_hash,
                elastic_drive(name, {geared, "axis.arm.nominal.from=keys",
                                     "axis.arm.nominal.inertia_kgm2=0.02",
                                     "axis.arm.nominal.viscous_friction_Nms_rad=0.005",
                                     "axis.arm.nominal.motor_inertia_kgm2=2e-4",
                                     "axis.arm.nominal.stiffness_Nm_rad=50",
                                     "axis.arm.nominal.damping_Nms_rad=0.02"})
                    .scenario->run({})
                    .state_hash)
          << name << " " << ratio;
    }
  }
}

// Friction of the motor is that of its joint in the file and that of the keys.
TEST(ElasticDriveTest, MotorKeepsTheFrictionOfItsJointInTheFile) {
  std::string text = read_text(testing::source_file("tests/regression/elastic_drive.xml"));
  const std::string joint = "name=\"motor\" type=\"hinge\"";
  text.insert(text.find(joint) + joint.size(), " damping=\"0.002\" frictionloss=\"0.01\"");
  const testing::TemporaryPath file("rubbing.xml", text);
  const std::string stem = "axis.arm.transmission.motor_";
  const auto hash = [](const std::vector<std::string>& sets) {
    return elastic_drive("pd", sets).scenario->run({}).state_hash;
  };
  const std::uint64_t of_file = hash({"model.mjcf=" + file.string()});
  EXPECT_EQ(of_file,
            hash({stem + "viscous_friction_Nms_rad=0.002", stem + "coulomb_friction_Nm=0.01"}));
  EXPECT_NE(of_file, hash({}));
}

// A rigid gear is part of the model's inertia: the keys of the motor do not count again.
TEST(ElasticDriveTest, RigidGearCountsOnce) {
  const std::vector<std::string> geared = {"axis.angle.transmission.ratio=2",
                                           "axis.angle.transmission.motor_inertia_kgm2=0.25"};
  std::vector<std::string> twice = geared;
  twice.emplace_back("axis.angle.nominal.motor_inertia_kgm2=0.25");
  const PreparedRun own = prepare_text(kMotor, "own", twice);
  EXPECT_EQ(own.scenario->run({}).state_hash,
            prepare_text(kMotor, "own", geared).scenario->run({}).state_hash);
  ASSERT_EQ(own.ineffective.size(), 1U);
  EXPECT_EQ(own.ineffective.front().key, "axis.angle.nominal.motor_inertia_kgm2");
}

TEST(ElasticDriveTest, WarnsOfANominalModelWithoutTheMotor) {
  const std::vector<std::string> keys = {"axis.arm.nominal.from=keys",
                                         "axis.arm.nominal.inertia_kgm2=0.02",
                                         "axis.arm.nominal.viscous_friction_Nms_rad=0.005"};
  EXPECT_EQ(elastic_drive("pd").scenario->warnings(), std::vector<std::string>());
  EXPECT_EQ(elastic_drive("pd", keys).scenario->warnings(),
            std::vector<std::string>{"axis.arm.nominal.motor_inertia_kgm2: is 0, so "
                                     "nominal.inertia_kgm2 must be that of load and motor"});
}

TEST(ElasticDriveTest, AxisWithoutANameHasThisWarningToo) {
  const PreparedRun run =
      testing::prepare("motor_estimation", "vfakfd", {"transmission.motor_inertia_kgm2=0.25"});
  EXPECT_EQ(run.scenario->warnings(),
            std::vector<std::string>{"nominal.motor_inertia_kgm2: is 0, so nominal.inertia_kgm2 "
                                     "must be that of load and motor"});
}

TEST(ElasticDriveTest, SaysWhetherALoopThatMissesItsReferenceIsStable) {
  const auto warning = [](const std::vector<std::string>& sets) {
    const std::vector<std::string> all = elastic_drive("pd", sets).scenario->run({}).warnings;
    return all.empty() ? "" : all.front();
  };
  EXPECT_EQ(warning({}), "");
  EXPECT_TRUE(has(warning({"axis.arm.controller.kp=0.0"}), "; the loop is stable without"));
  EXPECT_TRUE(has(warning({"axis.arm.encoder.side=load", "axis.arm.controller.kp=2.5",
                           "axis.arm.controller.cancelled_share=1.0"}),
                  "; the loop is not stable, even without"));
}

TEST(PlantTest, SaysThatAStableLoopHasTheOtherJointsHeld) {
  const Recording arm =
      testing::prepare("plant", "pd", {"axis.elbow.controller.kp=0"}).scenario->run({});
  ASSERT_EQ(arm.warnings.size(), 1U);
  EXPECT_TRUE(has(arm.warnings.front(), "the loop is stable without",
                  "and backlash, with the other joints held: see breakwater analyze"));
}

// A regulator of the whole plant, with a filter.
std::vector<std::string> regulator() {
  return {"controller.name=lqr",
          "controller.q_position=[0, 400]",
          "controller.q_velocity=[0, 1]",
          "controller.r=[10]",
          "observer.name=kfd",
          "observer.disturbance_order=0",
          "observer.process_noise_on=disturbance",
          "observer.process_noise=1e-6",
          "observer.observation_noise=1e-9",
          "observer.initial_covariance=[1e-9, 1e-9, 1e-6, 1e-6, 1e-4]"};
}

// Both sides of the encoder, and a gear: the regulator of the whole plant moves the load to its
// reference and holds it there.
TEST(ElasticDriveTest, RegulatorOfTheWholePlantKnowsTheSpring) {
  for (const char* side : {"load", "motor"}) {
    for (const char* ratio : {"1.0", "10.0"}) {
      std::vector<std::string> sets = regulator();
      sets.insert(sets.end(), {std::string("axis.arm.encoder.side=") + side,
                               std::string("axis.arm.transmission.ratio=") + ratio,
                               "axis.arm.encoder.bits=0", "axis.arm.disturbance.kind=none"});
      const auto metrics = metrics_of(elastic_drive("spring", sets));
      EXPECT_LT(metrics.at("overshoot_percent"), 2.0) << side << ratio;
      EXPECT_LT(metrics.at("disturbed_rad"), 1e-6) << side << ratio;
    }
  }
}

// The engine never integrates the nominal spring, which is beyond its stability limit here.
TEST(ElasticDriveTest, RegulatorOfTheWholePlantTakesAStiffNominalSpring) {
  std::vector<std::string> sets = regulator();
  sets.insert(sets.end(),
              {"axis.arm.nominal.from=keys", "axis.arm.nominal.inertia_kgm2=0.02",
               "axis.arm.nominal.viscous_friction_Nms_rad=0.005",
               "axis.arm.nominal.motor_inertia_kgm2=2e-4",
               "axis.arm.nominal.stiffness_Nm_rad=3.5e5", "axis.arm.nominal.model=rigid"});
  const PreparedRun run = elastic_drive("spring", sets);
  for (const IneffectiveKey& one : run.ineffective) {
    EXPECT_NE(one.key, "axis.arm.nominal.stiffness_Nm_rad");
  }
  EXPECT_THROW(elastic_drive("spring", {"axis.arm.transmission.stiffness_Nm_rad=3.5e5"}),
               std::invalid_argument);
}

// An axis' own controller has no effect then.
TEST(ElasticDriveTest, RegulatorOfTheWholePlantIgnoresTheAxesControllers) {
  std::vector<std::string> sets = regulator();
  sets.emplace_back("axis.arm.controller.poles_rad_s=[-50]");
  EXPECT_NO_THROW(elastic_drive("spring", sets));
  EXPECT_THROW(elastic_drive("spring", {sets.back()}), std::invalid_argument);
}

// A mass on three slides, so that the engine's contact has the inertia of a free body.
constexpr const char* kBall = R"(
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 -10"/>
  <default><geom condim="1" solref="-1e4 0" solimp="0.9 0.9 0.001 0.5 2"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 0.3">
      <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="y" type="slide" axis="0 1 0"/>
      <joint name="z" type="slide" axis="0 0 1"/>
      <geom name="ball" size="0.1" mass="0"/>
    </body>
  </worldbody>
</mujoco>
)";

constexpr const char* kFall = R"(
scenario = "plant"
default_case = "own"
[physics]
timestep_s = 1e-5
integrator = "euler"
[control]
period_s = 1e-3
[run]
duration_s = 1.0
seed = 1
[axis.x]
joint = "x"
[axis.y]
joint = "y"
[axis.height]
joint = "z"
[contact.floor]
geom_1 = "floor"
geom_2 = "ball"
metric.peak_force = { of = "contact_floor_N", kind = "peak" }
metric.contact_time = { of = "contact_floor_N", kind = "time" }
metric.bounces = { of = "contact_floor_N", kind = "bounces" }
metric.x = { of = "x_position_true_m", kind = "max" }
metric.y = { of = "y_position_true_m", kind = "max" }
metric.fall = { of = "height_position_true_m", kind = "min" }
[case.own]
)";

// The contact has no damping, the impedance d = 0.9 and the stiffness ω² = 1e4. At a penetration p
// it accelerates the mass by d g + ω² p. So p = c (1 − cos ωt) + v/ω sin ωt with c = (1 − d) g/ω².
// The mass falls by 0.2 m to v = 2 m/s, and bounces for ever.
TEST(PlantTest, FallingMassHasTheContactOfTheClosedForm) {
  const testing::TemporaryPath model("ball.xml", kBall);
  const auto metrics =
      metrics_of(prepare_text(kFall, "own", {"model.mjcf=\"" + model.string() + "\""}));
  constexpr double kMass = 2.0, g = 10.0, v = 2.0, omega = 100.0, kRest = 0.1 * g;
  const double peak = kMass * (g + std::sqrt(kRest * kRest + omega * omega * v * v));
  const double contact_s = 2.0 / omega * (M_PI - std::atan(omega * v / kRest));
  EXPECT_NEAR(metrics.at("peak_force_N"), peak, 1e-3 * peak);
  // The contacts begin at 0.2 s, and again after each flight of 2 v/g = 0.4 s.
  EXPECT_EQ(metrics.at("bounces_1"), 1.0);
  EXPECT_NEAR(metrics.at("contact_time_s"), 2.0 * contact_s, 1e-4);
}

TEST(PlantTest, SaysWhyAContactHasNoSuchGeom) {
  const auto complaint = [](const std::string& compiler) {
    std::string text = testing::replaced(kBall, "<compiler angle=\"radian\"/>", compiler);
    text.insert(
        text.find("<geom name=\"ball\""),
        "<geom name=\"fingertip\" size=\"0.01\" contype=\"0\" conaffinity=\"0\" mass=\"0\"/>");
    const testing::TemporaryPath model("ball.xml", text);
    return complaint_of([&] {
      prepare_text(kFall, "own",
                   {"model.mjcf=\"" + model.string() + "\"", "contact.floor.geom_2=\"fingertip\""});
    });
  };
  EXPECT_TRUE(has(complaint("<compiler angle=\"radian\"/>"),
                  "contact.floor.geom_2: ", "the geom \"fingertip\" can touch nothing"));
  EXPECT_TRUE(has(complaint("<compiler discardvisual=\"true\"/>"),
                  "has no geom named \"fingertip\" (it has floor, ball. With discardvisual, as in "
                  "a URDF, the compiler drops geoms that cannot collide)"));
}

// A shelf of 2 kg, which no axis moves, on a slide whose friction is twice its weight. By the
// formula of friction.h it creeps 1e-8 m in a second.
TEST(PlantTest, FrictionHoldsAJointThatIsNoAxis) {
  std::string text = kBall;
  text.replace(text.find("<worldbody>"), 11, R"(<worldbody>
    <body name="shelf" pos="0.5 0 0">
      <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
      <joint name="lift" type="slide" axis="0 0 1" frictionloss="40"/>
    </body>)");
  const testing::TemporaryPath model("shelf.xml", text);
  const auto metrics = metrics_of(
      prepare_text(kFall + std::string("metric.sunk = { of = \"qpos[1]\", kind = \"min\" }\n"),
                   "own", {"model.mjcf=\"" + model.string() + "\""}));
  EXPECT_NEAR(metrics.at("sunk_1"), -1e-8, 1e-10);
}

// Such an axis has values at the samples alone. So it refuses a cut-off above half the control
// rate, which suits the physics steps.
TEST(PlantTest, AxisWithTheNameOfAContactIsSampled) {
  const testing::TemporaryPath model("ball.xml", kBall);
  std::string text = kFall;
  text.replace(text.find("[axis.x]"), 8, "[axis.contact]");
  const auto prepare = [&](const std::string& of) {
    prepare_text(text, "own",
                 {"model.mjcf=\"" + model.string() + "\"", "metric.x.of=\"" + of + "\"",
                  "metric.x.take=\"high_pass\"", "metric.x.cutoff_Hz=600.0"});
  };
  EXPECT_NO_THROW(prepare("contact_floor_N"));
  EXPECT_THROW(prepare("contact_position_true_m"), std::invalid_argument);
}

// F t²/(2 m) along a direction of any length.
TEST(PlantTest, PushMovesAMassByForceOverMass) {
  const testing::TemporaryPath model("ball.xml", kBall);
  const auto metrics = metrics_of(prepare_text(
      kFall, "own",
      {"model.mjcf=\"" + model.string() + "\"", "physics.integrator=rk4", "physics.timestep_s=1e-3",
       "run.duration_s=0.15", "push.hand.body=\"ball\"", "push.hand.along=[30, 40, 0]",
       "push.hand.disturbance.kind=\"step\"", "push.hand.disturbance.amplitude_N=5.0",
       "push.hand.disturbance.start_s=0.05"}));
  EXPECT_NEAR(metrics.at("x_m"), 0.6 * 5.0 / 2.0 * 0.01 / 2.0, 1e-12);
  EXPECT_NEAR(metrics.at("y_m"), 0.8 * 5.0 / 2.0 * 0.01 / 2.0, 1e-12);
  EXPECT_NEAR(metrics.at("fall_m"), -10.0 * 0.15 * 0.15 / 2.0, 1e-12);
}

struct Refused {
  const char* set;
  const char* message;  // its end
  const char* also = nullptr;
};

TEST(PlantTest, Refuses) {
  const Refused rows[] = {
      {"axis.cart.joint=\"rial\"", "has no joint named \"rial\" (it has rail"},
      {"axis.other.encoder.bits=12", "axis.other.joint: must name a hinge or a slide of the model"},
      {"axis.cart.actuator=\"engine\"",
       "cart.xml: has no actuator named \"engine\" (it has drive)"},
      {"axis.cart.position_sensor=\"eye\"", "axis.cart.position_sensor: "},
      {"axis.other.joint=\"rail\"", "axis.other.joint: has another axis: each joint may have one"},
      {"axis.cart.controller.name=\"pid\"", "axis.cart.controller.name: must be one of "},
      {"axis.cart.observer.initial_covariance=[1.0]",
       "axis.cart.observer.initial_covariance: needs one initial covariance for each of the 3 "
       "extended states"},
      {"axis.cart.observer.lambda=0.9",
       "axis.cart.observer.lambda: must be 1 if observer.gamma is not 1",
       "axis.cart.observer.gamma=1.1"},
      {"axis.cart.reference.kind=\"csv\"", "axis.cart.reference.file: is missing"},
      {"metric.max_position.of=\"qpos[2]\"", "metric.max_position.of: qpos[2]: the signal has 1"},
      {"metric.steady_state_error.to_s=4.0",
       "metric.steady_state_error.to_s: must be later than from_s"},
      {"metric.max_position.kind=\"most\"", "metric.max_position.kind: must be one of "},
      {"start.keyframe=\"away\"", "start.keyframe: "},
      {"axis.cart.encoder.side=\"motor\"", "axis.cart.encoder.side: motor needs a transmission",
       "axis.cart.transmission.ratio=3.0"},
      {"axis.cart.transmission.stiffness_N_m=1e3",
       "axis.cart.transmission.motor_joint: must be another joint than that of the axis",
       "axis.cart.transmission.motor_joint=\"rail\""},
      {"axis.cart.transmission.stiffness_N_m=1e3",
       "axis.cart.transmission.motor_inertia_kg: must be above 0 where the transmission has"},
      {"axis.cart.controller.name=\"rrc\"",
       "axis.cart.transmission.stiffness_N_m: must be positive for resonance ratio control",
       "axis.cart.encoder.side=\"motor\""},
      {"metric.max_position.take=\"high_pass\"", "metric.max_position.cutoff_Hz: is missing"},
      {"metric.rms_highpass_disturbance.cutoff_Hz=500.0",
       "metric.rms_highpass_disturbance.cutoff_Hz: "},
      {"axis.cart.nominal.model=\"motor\"",
       "axis.cart.encoder.side: must be motor for nominal.model"},
      {"axis.cart.nominal.model=\"spring\"",
       "axis.cart.transmission.stiffness_N_m: must be positive for nominal.model = \"spring\""},
      {"axis.cart.transmission.stiffness_N_m=1e9", "beyond the stability limit",
       "axis.cart.transmission.motor_inertia_kg=1.0"},
      {"push.hand.body=\"hand\"", "push.hand."},
      {"axis.a-b.joint=\"rail\"", "axis.a-b: a name here is made of A-Z, a-z, 0-9 and '_'"},
      {"controller.name=\"lqr\"", "controller.q_position: is missing"}};
  for (const Refused& row : rows) {
    std::vector<std::string> sets = {row.set};
    if (row.also != nullptr) sets.emplace_back(row.also);
    try {
      prepare_text(kCart, "own", sets);
      ADD_FAILURE() << row.set << " was not refused";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(row.message), std::string::npos)
          << row.set << ": " << error.what();
    }
  }
}

TEST(ElasticDriveTest, Refuses) {
  const std::vector<std::string> keys = {"axis.arm.nominal.from=keys",
                                         "axis.arm.nominal.inertia_kgm2=0.02",
                                         "axis.arm.nominal.viscous_friction_Nms_rad=0.005"};
  const auto expect_refused = [](std::vector<std::string> sets, const std::string& set,
                                 const std::string& words) {
    sets.push_back(set);
    EXPECT_TRUE(has(complaint_of([&] { elastic_drive("spring", sets); }), words)) << set;
  };
  expect_refused(keys, "run.seed=2",
                 "axis.arm.nominal.stiffness_Nm_rad: must be positive for nominal");
  expect_refused(keys, "axis.arm.nominal.stiffness_Nm_rad=50",
                 "axis.arm.nominal.motor_inertia_kgm2: must be positive for nominal.model");
  expect_refused(keys, "axis.arm.nominal.model=motor",
                 "axis.arm.nominal.motor_inertia_kgm2: must be positive for nominal.model");
  expect_refused({"axis.arm.encoder.side=load"}, "axis.arm.nominal.model=motor",
                 "axis.arm.encoder.side: must be motor for nominal.model = \"motor\"");
  expect_refused({"axis.arm.controller.period_s=1e-3", "axis.arm.controller.q_position=1",
                  "axis.arm.controller.q_velocity=1", "axis.arm.controller.r=1",
                  "axis.arm.reference.kind=hold"},
                 "axis.arm.controller.name=lqr_observer",
                 "axis.arm.nominal.model: must be rigid or motor for a regulator: it cancels");
  std::vector<std::string> rigid = regulator();
  rigid.insert(rigid.end(), keys.begin(), keys.end());
  expect_refused(rigid, "axis.arm.nominal.model=rigid",
                 "controller.name: axis.arm.nominal.motor_inertia_kgm2 and "
                 "axis.arm.nominal.stiffness_Nm_rad must be positive");
  expect_refused(regulator(), "controller.r=[1, 1]", "controller.r: must have 1 number, has 2");
  std::vector<std::string> idle = regulator();
  idle.emplace_back("observer.name=none");
  expect_refused(idle, "axis.arm.actuator=none",
                 "controller.name: lqr needs an axis with a <motor> in the model");
  expect_refused({}, "axis.arm.transmission.stiffness_Nm_rad=0",
                 "axis.arm.transmission.motor_joint: needs a transmission with a stiffness");
  expect_refused({}, "axis.rotor.joint=motor", ".actuator: drives another axis: set \"none\"");
  expect_refused({"axis.rotor.joint=motor", "axis.rotor.transmission.stiffness_Nm_rad=1"},
                 "axis.rotor.transmission.motor_joint=motor",
                 ".transmission.motor_joint: has another axis: each motor may have one load");
}

}  // namespace
}  // namespace breakwater
