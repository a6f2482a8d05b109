// The scenario plant: shipped scenarios written as a plant's file, its metrics, and the template of
// a plant.
#include <Eigen/LU>

#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/experiment/run_tables.h>
#include <breakwater/plants/xml_file.h>
#include <breakwater/record/recording.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/plant_parts.h>
#include "catalogue.h"

namespace breakwater::plant_test {
namespace {

namespace fs = std::filesystem;

std::string file_text(const std::string& name) {
  return testing::text_of(testing::source_file("tests/regression/" + name));
}

const std::string kMotor = file_text("motor_as_plant.toml"),
                  kCart = file_text("cart_as_plant.toml"), kFall = file_text("falling_ball.toml"),
                  kBall = file_text("falling_ball.xml");

using Sets = std::vector<std::string>;

PreparedRun prepare_text(const std::string& text, const std::string& case_name,
                         const std::vector<std::string>& sets = {}) {
  const testing::TemporaryPath file("plant.toml", text);
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
  const auto& scenario = dynamic_cast<const AxisScenario&>(*run.scenario);
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

// The shipped plant has two axes, shoulder and elbow, whose encoders have a value in its file.
TEST(PlantTest, AKeyWithoutAnAxisCountsForEachThatLacksIt) {
  const std::string own = testing::text_of(testing::source_file("scenarios/plant/plant.toml"));
  std::string without = own;
  for (const std::string key :
       {"controller.name = \"pd\"              # none: no control\n", "controller.name = \"pd\"\n",
        "observer.poles_rad_s = [-80, -90, -100]\n", "observer.poles_rad_s = [-80, -90, -100]\n",
        "encoder.bits = 16\n"}) {
    ASSERT_NE(without.find(key), std::string::npos) << key;
    without.erase(without.find(key), key.size());
  }
  using Keys = std::vector<std::string>;
  const auto config = [](const std::string& text, const Keys& sets) {
    return prepare_text(text, "idob", sets).config_text;
  };
  const std::string poles = "observer.poles_rad_s=", rows = "[-8, -9, -10], [-7, -8, -9]";
  // The root's controller.name is that of the whole plant, so an axis' needs its axis.
  const Keys names = {"axis.shoulder.controller.name=pd", "axis.elbow.controller.name=pd"};
  const auto with_names = [&](Keys sets) {
    sets.insert(sets.end(), names.begin(), names.end());
    return sets;
  };
  EXPECT_EQ(
      config(without, with_names({poles + "[-8, -9, -10]", "encoder.bits=12"})),
      config(own, {"axis.shoulder." + poles + "[-8, -9, -10]",
                   "axis.elbow." + poles + "[-8, -9, -10]", "axis.shoulder.encoder.bits=12"}));
  EXPECT_EQ(config(without, with_names({poles + "[" + rows + "]", "encoder.bits=16",
                                        "encoder.gear_ratio=[2, 3]"})),
            config(own, {"axis.shoulder." + poles + "[-8, -9, -10]",
                         "axis.elbow." + poles + "[-7, -8, -9]",
                         "axis.shoulder.encoder.gear_ratio=2", "axis.elbow.encoder.gear_ratio=3"}));
  // One axis uses it, so it has an effect.
  const Keys one_uses = {"axis.elbow.observer.name=none", "observer.poles_rad_s=[-8, -9, -10]"};
  EXPECT_TRUE(prepare_text(without, "idob", with_names(one_uses)).ineffective.empty());
  const Keys none_uses = {"axis.elbow.observer.name=none", "axis.shoulder.observer.name=none",
                          "observer.alpha=3"};
  const auto ineffective = prepare_text(without, "idob", with_names(none_uses)).ineffective;
  ASSERT_EQ(ineffective.size(), 1U);
  EXPECT_EQ(ineffective[0].key, "observer.alpha");
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
      {"rms_input_step_N", "the run does not cover its window, from 5.0 to 11.0"},
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
  EXPECT_REFUSED(elastic_drive("spring", {"axis.arm.transmission.stiffness_Nm_rad=3.5e5"}));
}

// An axis' own controller has no effect then.
TEST(ElasticDriveTest, RegulatorOfTheWholePlantIgnoresTheAxesControllers) {
  std::vector<std::string> sets = regulator();
  sets.emplace_back("axis.arm.controller.poles_rad_s=[-50]");
  EXPECT_NO_THROW(elastic_drive("spring", sets));
  EXPECT_REFUSED(elastic_drive("spring", {sets.back()}));
}

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
                  "contact.floor.geom_2: ", "let \"floor\" and \"fingertip\" not touch"));
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
  const auto metrics =
      metrics_of(prepare_text("metric.sunk = { of = \"qpos[1]\", kind = \"min\" }\n" + kFall, "own",
                              {"model.mjcf=\"" + model.string() + "\""}));
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
  EXPECT_REFUSED(prepare("contact_position_true_m"));
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

std::map<std::string, double> metrics_of_ball(const std::string& model_text,
                                              const std::string& rows,
                                              std::vector<std::string> sets) {
  const testing::TemporaryPath model("ball.xml", model_text);
  sets.push_back("model.mjcf=\"" + model.string() + "\"");
  return metrics_of(prepare_text(rows + kFall, "own", sets));
}

std::string metric_row(const std::string& name, const std::string& of, const std::string& kind,
                       const std::string& more = "") {
  return "metric." + name + " = { of = \"" + of + "\", kind = \"" + kind + "\"" + more + " }\n";
}

const std::string kAtRest = metric_row("rest", "contact_floor_N", "last") +
                            metric_row("speed", "height_velocity_true_m_s", "last");
const std::string kDepth = metric_row("depth", "contact_floor_penetration_m", "last");
const std::vector<std::string> kClipped = {"contact.law=kelvin_voigt_clipped",
                                           "contact.stiffness_N_m=1e4", "contact.damping_Ns_m=200",
                                           "physics.timestep_s=1e-4"};

// The weight of 20 N presses the ball K⁻¹ F into the floor.
TEST(PlantContactTest, RestingForceIsStiffnessTimesPenetration) {
  const auto metrics = metrics_of_ball(kBall, kAtRest + kDepth, kClipped);
  EXPECT_NEAR(metrics.at("rest_N"), 20.0, 1e-6);
  EXPECT_NEAR(metrics.at("depth_m"), 20.0 / 1e4, 1e-9);
}

// m v over the fall and the impact is the impulse of the contact less that of the weight. The
// engine's Euler takes each step's force at its beginning.
TEST(PlantContactTest, ImpulseIsTheChangeOfMomentum) {
  const std::string rows = metric_row("impulse", "contact_floor_N", "integral", ", to_s = 0.3") +
                           metric_row("v", "height_velocity_true_m_s", "last", ", to_s = 0.3");
  for (const Sets& law : {Sets{"contact.law=hertz", "contact.stiffness_N_m=1e6"},
                          Sets{"contact.law=hunt_crossley", "contact.stiffness_N_m=1e6",
                               "contact.dissipation_s_m=0.3"}}) {
    const auto metrics = metrics_of_ball(kBall, rows, law);
    const double v_m_s = metrics.at("v_m_s");
    EXPECT_GT(v_m_s, 0.2) << law.front();  // it has bounced
    EXPECT_NEAR(metrics.at("impulse_Ns"), 2.0 * (v_m_s + 10.0 * 0.3), 1e-9) << law.front();
  }
}

// The floor rises by 0.05 m/s: the ball rests on it and rises with it. Keys at the root count for
// each contact.
TEST(PlantContactTest, BallRisesWithAFloorThatMoves) {
  Sets sets = kClipped;
  sets.insert(sets.end(), {"wall.motion=ramp", "wall.speed_m_s=-0.05"});
  const auto metrics =
      metrics_of_ball(kBall, kAtRest + metric_row("wall", "contact_floor_wall_m", "last"), sets);
  EXPECT_NEAR(metrics.at("rest_N"), 20.0, 1e-6);
  EXPECT_NEAR(metrics.at("speed_m_s"), 0.05, 1e-9);
  EXPECT_NEAR(metrics.at("wall_m"), -0.05, 1e-9);
}

// MuJoCo's solver adds 0.1 % of mass to its own contact, and no force to one at rest.
TEST(PlantContactTest, EngineTakesStiffnessAndDampingOfAnyGeoms) {
  const std::string box = testing::replaced(kBall, "<geom name=\"ball\" size=\"0.1\"",
                                            "<geom name=\"ball\" type=\"box\" size=\"1 1 1\"");
  Sets sets = kClipped;
  sets[0] = "contact.law=kelvin_voigt";
  const std::string height = metric_row("height", "height_position_true_m", "last");
  const auto ball = metrics_of_ball(kBall, kAtRest + height, sets);
  EXPECT_NEAR(ball.at("rest_N"), 20.0, 1e-3);
  EXPECT_NEAR(ball.at("height_m"), -0.2 - 20.0 / 1e4, 1e-5);
  // The box begins 0.7 m deep: four corners share its weight.
  sets.push_back("axis.height.start.position_m=0.71");
  const auto with_corners = metrics_of_ball(box, kAtRest + height, sets);
  EXPECT_NEAR(with_corners.at("rest_N"), 20.0, 1e-3);
  EXPECT_NEAR(with_corners.at("height_m"), 0.7 - 5.0 / 1e4, 1e-5);
}

// The normal of a wall that is turned by an angle from −x is −(cos, sin) of it. Only the wall of
// the contact turns.
TEST(PlantContactTest, WallTurnsByItsAngle) {
  const std::string walls = testing::replaced(kBall, "</worldbody>", R"(
    <geom name="wall" type="plane" pos="0.5 0 0" zaxis="-1 0 0" size="1 1 1"/>
    <geom name="wall2" type="plane" pos="0.5 0 0" zaxis="-1 0 0" size="1 1 1"/></worldbody>)");
  const std::string rows = metric_row("turned", "contact_turned_penetration_m", "last") +
                           metric_row("still", "contact_still_penetration_m", "last");
  Sets sets = kClipped;
  for (const std::string name : {"turned", "still"}) {
    sets.push_back("contact." + name + ".geom_1=ball");
    sets.push_back("contact." + name + ".geom_2=" + (name == "turned" ? "wall" : "wall2"));
  }
  sets.push_back("contact.turned.wall.angle_rad=0.3");
  const auto metrics = metrics_of_ball(walls, rows, sets);
  EXPECT_NEAR(metrics.at("turned_m"), 0.1 - 0.5 * std::cos(0.3), 1e-12);
  EXPECT_NEAR(metrics.at("still_m"), 0.1 - 0.5, 1e-12);
}

// A second ball rests on the floor by the engine.
TEST(PlantContactTest, OtherGeomsStillTouchThePlane) {
  const std::string two =
      testing::replaced(kBall, "</worldbody>", R"(<body name="block" pos="5 0 0.1">
      <joint name="lift" type="slide" axis="0 0 1"/>
      <geom name="block" size="0.1" mass="3" solref="-1e4 -200"/>
    </body></worldbody>)");
  Sets sets = kClipped;
  sets[0] = "contact.floor.law=kelvin_voigt_clipped";
  sets.insert(sets.end(), {"contact.block.geom_1=floor", "contact.block.geom_2=block"});
  const auto metrics =
      metrics_of_ball(two, metric_row("block", "contact_block_N", "last") + kAtRest, sets);
  EXPECT_NEAR(metrics.at("rest_N"), 20.0, 1e-6);
  EXPECT_NEAR(metrics.at("block_N"), 30.0, 0.01);
}

// A hand with the ball carries 2 kg, whose weight its sensor has, whatever is before it. The hand
// presses down, against the axis.
TEST(PlantTipTest, SensorOfTheModelHasWhatIsBehindIt) {
  const std::string carried = testing::replaced(
      testing::replaced(kBall, "<geom name=\"ball\" size=\"0.1\" mass=\"0\"/>",
                        R"(<body name="hand"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
                        <site name="wrist"/><geom name="ball" size="0.1" mass="0"/></body>)"),
      "</mujoco>", "<sensor><force name=\"wrist\" site=\"wrist\"/></sensor></mujoco>");
  const std::string rows = kAtRest + metric_row("true", "force_true_N", "last") +
                           metric_row("measured", "force_measured_N", "last") +
                           metric_row("filtered", "force_filtered_N", "last");
  Sets sets = kClipped;
  sets.insert(sets.end(), {"tip.contact=floor", "tip.sensor=wrist", "tip.component=2",
                           "sensor.force_bias_N=0.25", "force.filter_time_constant_s=0.01"});
  for (const double tool_kg : {0.0, 0.5}) {
    Sets with_tool = sets;
    with_tool.push_back("sensor.force_tool_mass_kg=" + std::to_string(tool_kg));
    const auto metrics = metrics_of_ball(carried, rows, with_tool);
    EXPECT_NEAR(metrics.at("rest_N"), 30.0 + 10.0 * tool_kg, 1e-5);
    EXPECT_EQ(metrics.at("true_N"), metrics.at("rest_N"));
    EXPECT_NEAR(metrics.at("filtered_N"), -20.0, 1e-5);
    EXPECT_NEAR(metrics.at("measured_N"), -19.75, 1e-5);
    with_tool.push_back("sensor.force_weighed_kg=-1");
    const auto weighed = metrics_of_ball(carried, rows, with_tool);
    EXPECT_NEAR(weighed.at("measured_N"), 0.25 - metrics.at("true_N"), 1e-5);
    EXPECT_EQ(weighed.at("filtered_N"), metrics.at("filtered_N"));
  }
}

// The peak of the true force is that at the physics rate. A fault is of one channel.
TEST(PlantTipTest, MeasuresTheContact) {
  const std::string rows = metric_row("peak", "force_true_N", "peak") +
                           metric_row("broken", "force_measured_N", "last") +
                           metric_row("raw", "force_raw_measured_N", "last") +
                           metric_row("aim", "force_reference_N", "last");
  Sets sets = kClipped;
  sets.insert(sets.end(),
              {"tip.contact=floor", "fault.sensor=force", "fault.at_s=0.5", "fault.samples=1000",
               "fault.kind=bias", "fault.size=3", "force.reference_N=7", "force.from_s=0.9"});
  const auto metrics = metrics_of_ball(kBall, rows, sets);
  EXPECT_EQ(metrics.at("peak_N"), metrics.at("peak_force_N"));
  EXPECT_NEAR(metrics.at("raw_N"), 20.0, 1e-6);
  EXPECT_NEAR(metrics.at("broken_N"), 23.0, 1e-6);
  EXPECT_EQ(metrics.at("aim_N"), 7.0);
}

// An inverted pendulum on a cart as a plant: the template of `breakwater new plant`.

PreparedRun prepare_pendulum(const std::string& case_name, const Sets& sets = {}) {
  static const ScenarioFile file(testing::source_file("templates/plant/my_plant.toml"), "plant");
  return prepare_run(testing::catalogue(), "plant", file, case_name, sets);
}

// The models that controllers get.
PlantTask task_of(const Sets& sets) {
  Sets all = {"controller.name=\"axes\"", "axis.cart.controller.name=\"pd\"",
              "axis.cart.controller.kp=1.0", "axis.cart.controller.kd=1.0"};
  all.insert(all.end(), sets.begin(), sets.end());
  const PreparedRun run = prepare_pendulum("lqr", all);
  return plant_task(dynamic_cast<const AxisScenario&>(*run.scenario).loops().front().plant);
}

TEST(PendulumTest, TheTruePlantChangesNoNominalModel) {
  const PlantTask nominal = task_of({});
  for (const char* set :
       {"plant.inertia_ratio=1.5", "axis.cart.plant.viscous_friction_Ns_m=3.0",
        "axis.pole.plant.viscous_friction_Nms_rad=0.1", "axis.cart.plant.coulomb_friction_N=1.0"}) {
    const PlantTask task = task_of({set});
    EXPECT_EQ(task.whole.plant.A, nominal.whole.plant.A) << set;
    EXPECT_EQ(task.whole.plant.B, nominal.whole.plant.B) << set;
    EXPECT_EQ(task.held_input, nominal.held_input) << set;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(task.axes[i].axis.plant.A, nominal.axes[i].axis.plant.A) << set;
      EXPECT_EQ(task.axes[i].axis.plant.B, nominal.axes[i].axis.plant.B) << set;
    }
    EXPECT_NE(prepare_pendulum("lqr", {set, "run.duration_s=2.0"}).scenario->run({}).state_hash,
              prepare_pendulum("lqr", {"run.duration_s=2.0"}).scenario->run({}).state_hash)
        << set;
  }
}

// M q̈ = [u - c ẋ; m g l θ - b θ̇] with M = [J_cart, m l; m l, J_pole] about the upright pose.
TEST(PendulumTest, TheKeysOfAnAxisSetItsPartOfTheLinearModel) {
  constexpr double kInertia = 3.0, kFriction = 2.0;
  constexpr double kMass = 0.2, kLength = 0.3, kPole = 6e-3 + kMass * kLength * kLength;
  const PlantTask task =
      task_of({"axis.cart.nominal.from=\"keys\"", "axis.cart.nominal.mass_kg=3.0",
               "axis.cart.nominal.viscous_friction_Ns_m=2.0"});
  Eigen::Matrix2d M;
  M << kInertia, kMass * kLength, kMass * kLength, kPole;
  const Eigen::Matrix2d inverse = M.inverse();
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topRightCorner<2, 2>().setIdentity();
  A.block<2, 1>(2, 1) = inverse.col(1) * kMass * 9.81 * kLength;
  A.block<2, 1>(2, 2) = -inverse.col(0) * kFriction;
  A.block<2, 1>(2, 3) = -inverse.col(1) * 1e-3;
  EXPECT_TRUE(task.whole.plant.A.isApprox(A, 1e-6)) << task.whole.plant.A << "\n\n" << A;
  EXPECT_TRUE(task.whole.plant.B.bottomRows(2).isApprox(inverse.col(0), 1e-6));
}

TEST(PendulumTest, NominalInertiasBelowTheCouplingHaveNoLinearModel) {
  EXPECT_TRUE(has(task_of({"axis.cart.nominal.from=\"keys\"", "axis.cart.nominal.mass_kg=0.01",
                           "axis.cart.nominal.viscous_friction_Ns_m=0.0"})
                      .why_not_linear,
                  "the nominal inertias are too small"));
}

// A two-link strikes a wall freely for 0.2 ms. The impulse is the effective mass times the change
// of velocity.
TEST(PlantTest, ImpactHasTheEffectiveMass) {
  const std::string press = testing::replaced(file_text("press.toml"), "\"press\"", "\"free\"");
  const testing::TemporaryPath folder("impact");
  fs::create_directories(folder);
  fs::copy_file(testing::source_file("tests/regression/two_link.xml"), folder / "two_link.xml");
  std::ofstream(folder / "free.toml") << press.substr(0, press.find("[metric]")) << R"(
[metric]
impulse = { of = "force_true_N", kind = "integral", at = "step" }
before = { of = "contact_wall_approach_m_s", kind = "first", at = "step", from_s = "first_contact" }
after = { of = "contact_wall_approach_m_s", kind = "min", at = "step", before_s = "first_contact + 3e-4" }
mass = { of = "contact_wall_mass_kg", kind = "first", at = "step", from_s = "first_contact" }
peak = { of = "force_true_N", kind = "peak", at = "step" }
transient = { of = "contact_wall_transient_N", kind = "first", at = "step", from_s = "first_contact" }
[case.free]
)";
  const PreparedRun run = prepare_run(
      testing::catalogue(), "plant", ScenarioFile(folder / "free.toml", "plant"), "free",
      {"physics.timestep_s=1e-6", "control.period_s=1e-3", "run.duration_s=0.06",
       "contact.wall.damping_Ns_m=0", "contact.wall.stiffness_N_m=1e8", "force.from_s=0",
       "axis.shoulder.start.velocity_rad_s=1.5", "axis.elbow.start.velocity_rad_s=-2.5",
       "axis.shoulder.plant.viscous_friction_Nms_rad=0",
       "axis.elbow.plant.viscous_friction_Nms_rad=0"});
  const auto all = metrics_of(run);
  const double change = all.at("before_m_s") - all.at("after_m_s");
  EXPECT_GT(change, 0.1);
  EXPECT_NEAR(all.at("impulse_Ns"), all.at("mass_kg") * change, 1e-3 * all.at("impulse_Ns"));
  // Half of a sine: its peak is v sqrt(k m).
  EXPECT_NEAR(all.at("peak_N"), all.at("transient_N"), 1e-3 * all.at("peak_N"));
}

}  // namespace
}  // namespace breakwater::plant_test
