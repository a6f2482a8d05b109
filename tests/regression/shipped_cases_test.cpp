// What every shipped case's run says: its metrics, and whether its reference is held.
#include <map>
#include <tuple>

#include "catalogue.h"
#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::run_case;

TEST(ReferenceOfARun, IsSaidWhereItIsNotHeld) {
  const std::vector<std::tuple<std::string, std::string, std::vector<std::string>>> runs = {
      // An IDOB that is told a hundredth of the mass, and a loop that hardly pulls.
      {"cart_position", "idob", {"nominal.mass_kg=0.005"}},
      {"cart_position", "idob", {"controller.kp=1e-3"}}};
  for (const auto& [scenario, case_name, sets] : runs) {
    const auto lines = run_case(scenario, case_name, sets).warnings;
    ASSERT_EQ(lines.size(), 1U) << scenario << " " << case_name;
    EXPECT_TRUE(has(lines.front(), "does not hold its reference"));
  }
}

// The rivals stay in another posture once a hand has turned the arm; filters that forget nothing
// see a step of force too late; one filter diverges.
bool loses_its_reference(const std::string& scenario, const std::string& name) {
  if (scenario == "arm_push") return name.starts_with("hpfc") || name.starts_with("drac");
  if (scenario == "cart_estimation") {
    return name == "order0" || name == "order1" || name == "order2";
  }
  return scenario == "quadrotor_waves" && name == "ekf-second";
}

class ShippedCases : public ::testing::TestWithParam<std::string> {};

// Each runs once for both; those at the wall, which are long, end where their impact is over.
TEST_P(ShippedCases, ReportTheDefinedMetricsAndHoldTheirReferences) {
  const std::string scenario = GetParam();
  std::map<std::string, std::string> defined, reported;  // name and unit
  for (const MetricDefinition& metric :
       make_scenario(testing::catalogue(), scenario)->metric_definitions()) {
    EXPECT_TRUE(defined.emplace(metric.name, metric.unit).second) << metric.name;
  }
  const auto run = [&](const std::string& name, const std::vector<std::string>& sets = {}) {
    const Recording recording = testing::completed_run(scenario, name, sets);
    for (const auto* list : {&recording.metrics, &recording.costs}) {
      for (const Metric& metric : *list) reported[metric.name] = metric.unit;
    }
    return recording.warnings.empty();
  };
  const ScenarioFile file = testing::scenario_file(scenario);
  for (const std::string& name : file.cases()) {
    if (scenario == "arm_wall_contact") {
      run(name, {"run.duration_s=33", "metrics.from_s=32", "metrics.to_s=33"});
    } else {
      EXPECT_EQ(run(name), !loses_its_reference(scenario, name)) << name;
    }
  }
  // No case of its own has a disturbance with a lag.
  if (scenario == "cart_estimation") run(file.default_case(), {"disturbance.kind=ramp"});
  EXPECT_EQ(defined, reported);
}

INSTANTIATE_TEST_SUITE_P(Regression, ShippedCases, ::testing::ValuesIn(testing::scenario_names()),
                         [](const auto& scenario) { return scenario.param; });

}  // namespace
}  // namespace breakwater
