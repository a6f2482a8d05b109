// The scenario plant: its loops, keys and models, and a contact law of a user. Its bounds are in
// cases.txt.
#include <Eigen/LU>

#include <breakwater/analysis/loop_analysis.h>
#include <breakwater/record/recording.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/contact_settings.h>
#include <breakwater/rigs/plant_parts.h>
#include <breakwater/sim/contact.h>
#include "catalogue.h"

namespace breakwater::plant_test {
namespace {

using Sets = std::vector<std::string>;

PreparedRun prepare_file(const std::string& file, const std::string& case_name,
                         const Sets& sets = {}) {
  return prepare_run(testing::catalogue(), "plant", ScenarioFile(file, "plant"), case_name, sets);
}

// A file of this folder.
PreparedRun prepare_own(const std::string& name, const std::string& case_name,
                        const Sets& sets = {}) {
  return prepare_file(testing::source_file("tests/regression/" + name), case_name, sets);
}

std::map<std::string, double> metrics_of(const PreparedRun& run) {
  std::map<std::string, double> all;
  for (const Metric& metric : run.scenario->run({}).metrics) all[metric.name] = metric.value;
  return all;
}

LoopAnalysis analysed(const PreparedRun& run) {
  const auto& scenario = dynamic_cast<const AxisScenario&>(*run.scenario);
  return analyse({{{"it"}, scenario.loops().front()}},
                 {.from_rad_s = 0.5, .points = 3, .settle_s = 1.0})
      .front();
}

TEST(PlantTest, MotorEstimationAsAPlantHasTheSameLoop) {
  const std::vector<std::string> idob = {"observer.poles_rad_s=[-10,-20,-30]"};
  const LoopAnalysis one =
      analysed(prepare_own("motor_as_plant.toml", "own",
                           {"axis.angle.observer.name=\"idob\"", "axis.angle." + idob.front()}));
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
  const auto prepare = [](const std::string& text, const Keys& sets) {
    return prepare_file(testing::TemporaryPath("plant.toml", text), "idob", sets);
  };
  const auto config = [&](const std::string& text, const Keys& sets) {
    return prepare(text, sets).config_text;
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
  EXPECT_TRUE(prepare(without, with_names(one_uses)).ineffective.empty());
  const Keys none_uses = {"axis.elbow.observer.name=none", "axis.shoulder.observer.name=none",
                          "observer.alpha=3"};
  const auto ineffective = prepare(without, with_names(none_uses)).ineffective;
  ASSERT_EQ(ineffective.size(), 1U);
  EXPECT_EQ(ineffective[0].key, "observer.alpha");
}

// m v over the fall and the impact is the impulse of the contact less that of the weight. The
// engine's Euler takes each step's force at its beginning.
TEST(PlantContactTest, ImpulseIsTheChangeOfMomentum) {
  for (const Sets& law : {Sets{"contact.law=hertz"},
                          Sets{"contact.law=hunt_crossley", "contact.dissipation_s_m=0.3"}}) {
    Sets sets = law;
    sets.insert(sets.end(), {"contact.stiffness_N_m=1e6", "metric.impulse.of=contact_floor_N",
                             "metric.impulse.kind=integral", "metric.impulse.to_s=0.3",
                             "metric.speed.to_s=0.3"});
    const auto metrics = metrics_of(prepare_own("falling_ball.toml", "own", sets));
    const double v_m_s = metrics.at("speed_m_s");
    EXPECT_GT(v_m_s, 0.2) << law.front();  // it has bounced
    EXPECT_NEAR(metrics.at("impulse_Ns"), 2.0 * (v_m_s + 10.0 * 0.3), 1e-9) << law.front();
  }
}

// An inverted pendulum on a cart as a plant: the template of `breakwater new plant`.

PreparedRun prepare_pendulum(const std::string& case_name, const Sets& sets = {}) {
  return prepare_file(testing::source_file("templates/plant/my_plant.toml"), case_name, sets);
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
  const auto all = metrics_of(prepare_own("free_impact.toml", "free"));
  const double change = all.at("before_m_s") - all.at("after_m_s");
  EXPECT_GT(change, 0.1);
  EXPECT_NEAR(all.at("impulse_Ns"), all.at("mass_kg") * change, 1e-3 * all.at("impulse_Ns"));
  // Half of a sine: its peak is v sqrt(k m).
  EXPECT_NEAR(all.at("peak_N"), all.at("transient_N"), 1e-3 * all.at("peak_N"));
}

// A law from outside, by a function.
struct Cubic final : ContactForceLaw {
  explicit Cubic(double k) : stiffness(k) {}
  double force(double penetration_m, double, ContactState&) const override {
    return stiffness * penetration_m * penetration_m * penetration_m;
  }
  double stiffness;
};

TEST(ContactLawKinds, AUserAddsOneWithAFunction) {
  Catalogue own = standard_catalogue();
  struct Settings {
    double stiffness = 0.0;
  };
  own.add(ContactLawKind(
      "cubic", "k x^3",
      +[](Fields& fields, Settings& settings) {
        fields.number("cubic_N_m3", settings.stiffness, positive(), "k [N/m^3]");
      },
      +[](const Settings& settings) -> std::unique_ptr<ContactForceLaw> {
        return std::make_unique<Cubic>(settings.stiffness);
      }));
  const PreparedRun run = prepare_run(
      own, "impact_test", testing::scenario_file("impact_test"), "kelvin_voigt",
      {"contact.law=cubic", "contact.cubic_N_m3=1e8", "run.duration_s=0.2", "impact.distance_m=0"});
  const Recording recording = run.scenario->run({});
  // k x⁴/4 = m v²/2
  EXPECT_NEAR(*recording.metric("penetration_m"), std::pow(2.0 * 0.04 / 1e8, 0.25), 1e-7);
  EXPECT_NEAR(*recording.metric("restitution"), 1.0, 1e-6);
}

}  // namespace
}  // namespace breakwater::plant_test
