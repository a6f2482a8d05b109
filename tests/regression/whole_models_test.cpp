// Runs leave out parts that do not affect the motion. The results stay the same.

#include <breakwater/sim/physics_part.h>
#include "catalogue.h"
#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::completed_run;
using testing::run_case;

// Short runs with all their events.
std::vector<std::string> shortened(const std::string& scenario) {
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
    const std::vector<std::string> sets = shortened(scenario);
    const std::string name = testing::scenario_file(scenario).default_case();
    const Recording run = completed_run(scenario, name, sets);
    const WholeModels whole;
    expect_same(run, run_case(scenario, name, sets), scenario);
  }
}

TEST(WholeModels, TheArmHitsTheWallInTheShortenedRun) {
  const Recording run =
      run_case("arm_wall_contact", testing::scenario_file("arm_wall_contact").default_case(),
               shortened("arm_wall_contact"));
  const bool touches = std::any_of(run.metrics.begin(), run.metrics.end(), [](const Metric& m) {
    return m.name == "peak_force_raw_N" && m.value > 0.0;
  });
  EXPECT_TRUE(touches);
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

}  // namespace
}  // namespace breakwater
