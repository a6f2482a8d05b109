// The shipped cases: their metrics, whether they hold their references, brief, equal and whole
// runs.
#include <xmmintrin.h>
#include <cfenv>
#include <nlohmann/json.hpp>

#include <breakwater/sim/physics_part.h>
#include <breakwater/thesis/printed_results.h>
#include "catalogue.h"
#include "regression/run_case.h"

namespace breakwater::shipped_cases_test {

using testing::run_case;
using testing::Sets;
using testing::operator+;

// The conventional controllers stay in another posture after a hand has turned the arm. Filters
// without forgetting follow a step of force too slowly. One filter diverges.
bool loses_its_reference(const std::string& scenario, const std::string& name) {
  if (scenario == "arm_push") return name.starts_with("hpfc") || name.starts_with("drac");
  if (scenario == "cart_estimation") {
    return name == "order0" || name == "order1" || name == "order2";
  }
  return scenario == "quadrotor_waves" && name == "ekf-second";
}

class ShippedCases : public ::testing::TestWithParam<std::string> {};

// The long runs end sooner: at the wall after their impact.
Sets sooner(const std::string& scenario) {
  if (scenario == "quadrotor_waves") return {"run.duration_s=50", "metrics.window_s=20"};
  if (scenario == "impact_test") return {"run.duration_s=0.5"};
  if (scenario != "arm_wall_contact") return {};
  return {"run.duration_s=9", "wall.solid_from_s=2", "force.from_s=3", "metrics.from_s=8",
          "metrics.to_s=9"};
}

// One run of each case serves both.
TEST_P(ShippedCases, ReportTheDefinedMetricsAndHoldTheirReferences) {
  const std::string scenario = GetParam();
  std::map<std::string, std::string> defined, reported;  // name and unit
  const ScenarioFile file = testing::scenario_file(scenario);
  const PreparedRun first = testing::prepare(scenario, file.default_case());
  for (const MetricDefinition& metric : first.scenario->metric_definitions()) {
    // Several rows may have one name, each for another choice of a key.
    EXPECT_EQ(defined.emplace(metric.name, metric.unit).first->second, metric.unit) << metric.name;
  }
  const auto run = [&](const std::string& name, const Sets& sets = {}) {
    const Recording recording = testing::completed_run(scenario, name, sets + sooner(scenario));
    for (const auto* list : {&recording.metrics, &recording.costs}) {
      for (const Metric& metric : *list) reported[metric.name] = metric.unit;
    }
    for (const Metric& cost : recording.costs) {  // measured times are not metrics
      EXPECT_TRUE(cost.name.ends_with("_us") && cost.value > 0.0) << cost.name;
    }
    return recording.warnings.empty();
  };
  for (const std::string& name : file.cases()) {
    const bool holds = run(name);
    if (scenario != "arm_wall_contact") {
      EXPECT_EQ(holds, !loses_its_reference(scenario, name)) << name;
    }
  }
  // No shipped case has a disturbance with a lag.
  if (scenario == "cart_estimation") run(file.default_case(), {"disturbance.kind=ramp"});
  if (scenario == "two_inertia") run(file.default_case(), {"task.kind=torque_step"});
  EXPECT_EQ(defined, reported);
}

INSTANTIATE_TEST_SUITE_P(Regression, ShippedCases, ::testing::ValuesIn(testing::scenario_names()),
                         [](const auto& scenario) { return scenario.param; });

// Equal runs.

using testing::completed_run;

// Rounding, subnormal numbers, the precision of the x87 and traps of the caller. They change no
// run, and the caller has them again afterwards.
TEST(EqualRuns, HaveTheirOwnFloatingPointEnvironment) {
  const auto set_x87 = [](unsigned short control) { __asm__("fldcw %0" : : "m"(control)); };
  const auto x87 = [] {
    unsigned short control = 0;
    __asm__("fnstcw %0" : "=m"(control));
    return control;
  };
  constexpr unsigned kFlushes = 0x8040, kFlags = 0x3F;
  const std::vector<std::function<void()>> environments = {
      [] { std::fesetround(FE_UPWARD); }, [] { std::fesetround(FE_DOWNWARD); },
      [] { std::fesetround(FE_TOWARDZERO); }, [] { _mm_setcsr(_mm_getcsr() | kFlushes); },
      [&] { set_x87(0x027F); },  // 53 bits
      // The standard library's own paths raise FE_INEXACT before the run begins.
      [] { feenableexcept(FE_UNDERFLOW | FE_DIVBYZERO | FE_OVERFLOW | FE_INVALID); }};
  for (const auto& [scenario, name, duration] :
       {std::tuple("motor_estimation", "stf", "run.duration_s=0.3"),
        {"cart_constrained", "lqr-idob", "run.duration_s=0.3"},
        {"quadrotor_waves", "ekf-second", "run.duration_s=0.3"}}) {
    const Recording usual = run_case(scenario, name, {duration});
    for (std::size_t i = 0; i < environments.size(); ++i) {
      std::fenv_t before;
      std::fegetenv(&before);
      environments[i]();
      const unsigned csr = _mm_getcsr() & ~kFlags, control = x87();
      const Recording run = run_case(scenario, name, {duration});
      const unsigned csr_then = _mm_getcsr() & ~kFlags, control_then = x87();
      std::fesetenv(&before);
      EXPECT_EQ(run.state_hash, usual.state_hash) << scenario << ", environment " << i;
      EXPECT_EQ(csr_then, csr);
      EXPECT_EQ(control_then, control);
      ASSERT_EQ(run.metrics.size(), usual.metrics.size());
      for (std::size_t m = 0; m < run.metrics.size(); ++m) {
        EXPECT_EQ(run.metrics[m].value, usual.metrics[m].value) << run.metrics[m].name;
      }
    }
  }
}

// Runs leave out parts that do not affect the motion. The results stay the same.

// Short runs with all their events.
Sets shortened(const std::string& scenario) {
  if (scenario == "arm_wall_contact") {
    return {"run.duration_s=6", "wall.solid_from_s=1.5", "force.from_s=2",      "metrics.from_s=5",
            "metrics.to_s=6",   "record.fine_from_s=2",  "record.fine_to_s=2.1"};
  }
  if (scenario == "quadrotor_waves") return {"run.duration_s=3", "metrics.window_s=2"};
  return {"run.duration_s=3"};
}

void expect_same(const Recording& a, const Recording& b, const std::string& which) {
  EXPECT_EQ(a.state_hash, b.state_hash) << which;
  ASSERT_EQ(a.metrics.size(), b.metrics.size()) << which;
  for (std::size_t i = 0; i < a.metrics.size(); ++i) {
    EXPECT_EQ(a.metrics[i].name, b.metrics[i].name) << which;
    EXPECT_EQ(a.metrics[i].value, b.metrics[i].value) << which << " " << a.metrics[i].name;
  }
}

TEST(WholeModels, GiveEveryScenarioTheSameStatesAndMetrics) {
  for (const std::string& scenario : testing::scenario_names()) {
    const Sets sets = shortened(scenario);
    const std::string name = testing::scenario_file(scenario).default_case();
    const Recording run = completed_run(scenario, name, sets);
    models_stay_whole = true;
    const Recording whole = run_case(scenario, name, sets);
    models_stay_whole = false;
    expect_same(run, whole, scenario);
    const bool touches = scenario != "arm_wall_contact" || run.metric("peak_force_raw_N") > 0.0;
    EXPECT_TRUE(touches) << "the arm does not reach the wall";
  }
}

// Without a log the poles of an estimator are computed only for metrics.
TEST(UnwatchedRuns, HaveTheMetricsOfThoseWithALog) {
  RunControl unwatched;
  unwatched.logs = false;
  for (const char* scenario : {"motor_estimation", "cart_estimation", "cart_position"}) {
    const ScenarioFile file = testing::scenario_file(scenario);
    for (const std::string& name : file.cases()) {
      expect_same(run_case(scenario, name), run_case(scenario, name, {}, unwatched), name);
    }
  }
}

// The thesis' numbers, and properties of any correct simulation.

constexpr const char* kWallContact = "arm_wall_contact";

// Long enough for the impact, but not for the steady state.
const Sets kImpactOnly = testing::switched_at_7_s(9);

std::string without_dashes(const ::testing::TestParamInfo<std::string>& param) {
  std::string name = param.param;
  std::erase(name, '-');
  return name;
}

class EachWallCase : public ::testing::TestWithParam<std::string> {};

// The goldens of scripts/impact_goldens.py, in a run that ends after the impact.
TEST_P(EachWallCase, StrikesAsBefore) {
  const Recording run =
      completed_run(kWallContact, GetParam(), {"run.duration_s=37"}, testing::kWithoutLog);
  const auto goldens = nlohmann::json::parse(
      testing::text_of(testing::source_file("tests/regression/impact_goldens.json")));
  EXPECT_EQ(goldens.size(), testing::scenario_file(kWallContact).cases().size());
  EXPECT_EQ(goldens.at(GetParam()).size(), 3U);
  for (const auto& golden : goldens.at(GetParam()).items()) {
    const auto expected = golden.value().get<double>();
    EXPECT_NEAR(run.metric(golden.key()).value_or(NAN), expected, 1e-3 * expected) << golden.key();
  }
}

INSTANTIATE_TEST_SUITE_P(Regression, EachWallCase,
                         ::testing::ValuesIn(testing::scenario_file(kWallContact).cases()),
                         without_dashes);

class EachWallContact : public ::testing::TestWithParam<std::string> {};

TEST_P(EachWallContact, IsWithinTheClassesOfItsPrintedNumbers) {
  const Recording run = completed_run(kWallContact, GetParam(), {}, testing::kWithoutLog);
  const auto values = printed_references().of_case(kWallContact, GetParam());
  ASSERT_GE(values.size(), 2U);
  for (const PublishedValue& value : values) {
    const auto measured = run.metric(value.metric);
    ASSERT_TRUE(measured) << value.metric;
    // The thesis explains 0.08 and 0.18 N by a lasting saturation, which does not occur here.
    const bool is_missing = value.metric == "mean_force_error_N" && value.number > 0.01;
    EXPECT_EQ(value.agrees(*measured).text == "not reproduced", is_missing)
        << value.metric << ": " << *measured << ", printed " << value.text;
  }
  for (const char* metric :
       {"free_motion_time_s", "peak_force_raw_N", "peak_force_filtered_N", "mean_force_error_N",
        "std_force_error_N", "impact_velocity_m_s", "contact_impulse_Ns", "bounce_count",
        "saturated_time_s", "max_posture_error_rad", "max_y_error_m", "late_bounce_count",
        "force_decay_ratio", "force_frequency_Hz", "impact_mass_kg"}) {
    ASSERT_TRUE(run.metric(metric)) << metric;
  }
  // An impulse of 200 ms cannot exceed the raw peak times its length.
  EXPECT_LT(*run.metric("contact_impulse_Ns"), 0.2 * *run.metric("peak_force_raw_N"));
  EXPECT_GE(*run.metric("peak_force_raw_N"), *run.metric("peak_force_filtered_N"));
}

INSTANTIATE_TEST_SUITE_P(Regression, EachWallContact,
                         ::testing::Values("proposed-2N", "hpfc-2N", "drac-2N", "proposed-5N",
                                           "hpfc-5N", "drac-5N", "tuned-2N", "tuned-5N"),
                         without_dashes);

// The arm with its force sensor as a second body on a slide, and a stiff wall. The slide has a
// spring of 1 kN/m and a damper of 10 N s/m, so the compliance is not in the contact.
TEST(WallContact, AnElasticLoadCellGivesTheSamePeaks) {
  using testing::replaced;
  std::string mjcf = replaced(
      testing::text_of(testing::source_file("models/arm.xml")),
      "<body name=\"tip\" pos=\"0.19 0 0\">",
      "<body name=\"tip\" pos=\"0.19 0 0\"><joint name=\"load_cell\" type=\"slide\" "
      "axis=\"1 0 0\" armature=\"0\" frictionloss=\"0\" stiffness=\"1000\" damping=\"10\"/>");
  mjcf = replaced(mjcf, "mass=\"0.02\" diaginertia", "mass=\"0.05\" diaginertia");
  mjcf = replaced(mjcf, "qpos=\"0 0 0\"", "qpos=\"0 0 0 0\"");
  const testing::TemporaryPath file{"load_cell.xml", mjcf};

  for (const char* name : {"proposed-2N", "proposed-5N"}) {
    const Recording chain = run_case(kWallContact, name, kImpactOnly);
    const Recording cell =
        completed_run(kWallContact, name,
                      Sets{"model.mjcf=" + file.string(), "contact.stiffness_N_m=1e6",
                           "contact.damping_Ns_m=200"} +
                          kImpactOnly);
    const auto peak = [](const Recording& run, const char* signal) {
      const auto values = run.track("physics").values(signal);
      return *std::max_element(values.begin(), values.end());
    };
    for (const char* signal : {"force_sensor_N", "force_filtered_N"}) {
      EXPECT_NEAR(peak(cell, signal), peak(chain, signal), 0.01 * peak(chain, signal))
          << name << " " << signal;
    }
  }
}

}  // namespace breakwater::shipped_cases_test
