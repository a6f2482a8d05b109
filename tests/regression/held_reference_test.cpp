#include <tuple>

#include "catalogue.h"
#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::run_case;

std::vector<std::string> warnings(const std::string& scenario, const std::string& case_name,
                                  const std::vector<std::string>& sets = {}) {
  return run_case(scenario, case_name, sets).warnings;
}

TEST(ReferenceOfARun, IsReportedIfNotHeld) {
  const std::vector<std::tuple<std::string, std::string, std::vector<std::string>>> runs = {
      // An IDOB with a hundredth of the mass, and a loop with a small gain.
      {"cart_position", "idob", {"nominal.mass_kg=0.005"}},
      {"cart_position", "idob", {"controller.kp=1e-3"}}};
  for (const auto& [scenario, case_name, sets] : runs) {
    const auto lines = warnings(scenario, case_name, sets);
    ASSERT_EQ(lines.size(), 1U) << scenario << " " << case_name;
    EXPECT_TRUE(has(lines.front(), "does not hold its reference"));
  }
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

// The long cases at the wall are left out.
TEST(ReferenceOfARun, IsHeldInTheShippedCasesExceptTheKnownOnes) {
  for (const std::string& scenario : testing::scenario_names()) {
    if (scenario == "arm_wall_contact") continue;
    const ScenarioFile file = testing::scenario_file(scenario);
    for (const std::string& name : file.cases()) {
      const auto lines = warnings(scenario, name);
      EXPECT_EQ(lines.empty(), !loses_its_reference(scenario, name)) << scenario << " " << name;
    }
  }
}

}  // namespace
}  // namespace breakwater
