// The shipped cases: their metrics, and whether they hold their references.
#include <map>

#include "catalogue.h"
#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::run_case;

// The printed "pseudo-feedback" by a weight on the disturbance has no effect.
TEST(OffsetFree, DisturbanceWeightChangesNoInput) {
  const auto inputs = [](const std::string& weight) {
    return run_case("cart_offset_free", "proposed", {"controller.q_disturbance=" + weight})
        .track("control")
        .values("command_N");
  };
  const std::vector<double> without = inputs("0");
  const std::vector<double> with = inputs("1e6");
  ASSERT_EQ(without.size(), with.size());
  for (std::size_t k = 0; k < without.size(); ++k) ASSERT_NEAR(without[k], with[k], 1e-9) << k;
}

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

// One run of each case serves both. The long cases at the wall end after their impact.
TEST_P(ShippedCases, ReportTheDefinedMetricsAndHoldTheirReferences) {
  const std::string scenario = GetParam();
  std::map<std::string, std::string> defined, reported;  // name and unit
  const ScenarioFile file = testing::scenario_file(scenario);
  const PreparedRun first = testing::prepare(scenario, file.default_case());
  for (const MetricDefinition& metric : first.scenario->metric_definitions()) {
    // Several rows may have one name, each for another choice of a key.
    EXPECT_EQ(defined.emplace(metric.name, metric.unit).first->second, metric.unit) << metric.name;
  }
  const auto run = [&](const std::string& name, const std::vector<std::string>& sets = {}) {
    const Recording recording = testing::completed_run(scenario, name, sets);
    for (const auto* list : {&recording.metrics, &recording.costs}) {
      for (const Metric& metric : *list) reported[metric.name] = metric.unit;
    }
    return recording.warnings.empty();
  };
  for (const std::string& name : file.cases()) {
    if (scenario == "arm_wall_contact") {
      run(name, {"run.duration_s=14", "wall.solid_from_s=10", "force.from_s=11",
                 "metrics.from_s=12", "metrics.to_s=14"});
    } else {
      EXPECT_EQ(run(name), !loses_its_reference(scenario, name)) << name;
    }
  }
  // No shipped case has a disturbance with a lag.
  if (scenario == "cart_estimation") run(file.default_case(), {"disturbance.kind=ramp"});
  if (scenario == "two_inertia") run(file.default_case(), {"task.kind=torque_step"});
  EXPECT_EQ(defined, reported);
}

INSTANTIATE_TEST_SUITE_P(Regression, ShippedCases, ::testing::ValuesIn(testing::scenario_names()),
                         [](const auto& scenario) { return scenario.param; });

}  // namespace
}  // namespace breakwater
