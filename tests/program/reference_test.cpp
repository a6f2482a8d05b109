// `breakwater reference`: its pages agree with the program's output.
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include <breakwater/program/commands.h>

#include "catalogue.h"
#include "cli/program.h"
#include "support.h"

namespace breakwater::reference_test {
namespace fs = std::filesystem;

// The keys in a configuration printed by --print-config: "controller.name" and so on.
std::vector<std::string> keys_of(const std::string& config_text) {
  std::istringstream lines(config_text);
  std::vector<std::string> keys;
  std::string table;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[")) table = line.substr(1, line.size() - 2) + ".";
    const std::size_t equals = line.find(" = ");
    if (line.starts_with("#") || equals == std::string::npos) continue;
    keys.push_back(table + line.substr(0, equals));
  }
  // These keys belong to the file, not to the scenario.
  std::erase_if(keys,
                [](const std::string& key) { return key == "scenario" || key == "default_case"; });
  return keys;
}

// The page of a plant has NAME for the names that a file gives to its tables and axes.
std::string on_page(const std::string& name) {
  static const std::regex table("^(axis|push|contact|metric)\\.\\w+\\.");
  static const std::regex axis("^(shoulder|elbow)_");
  return std::regex_replace(std::regex_replace(name, table, "$1.NAME."), axis, "NAME_");
}

bool has_row(const std::string& text, const std::string& name) {
  return text.find("\n| `" + name + "` |") != std::string::npos;
}

class Reference : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::create_directories(folder_);
    const auto made = testing::run_program({"breakwater", "reference", "--out", "pages"}, folder_);
    ASSERT_EQ(made.status, 0) << made.err;
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string page(const std::string& name) {
    return testing::text_of(folder_ / "pages" / name);
  }

  inline static const fs::path folder_ = testing::temporary_path("reference");
};

TEST_F(Reference, HasEveryCommandWithItsHelp) {
  const std::string commands = page("commands.md");
  for (const CommandKind& command : all_commands(testing::catalogue())) {
    const auto help = testing::run_program({"breakwater", command.name, "--help"}, folder_);
    const std::string text = help.out.substr(0, help.out.find_last_not_of('\n') + 1);
    EXPECT_NE(commands.find("\n" + text + "\n"), std::string::npos) << command.name;
    EXPECT_NE(commands.find("\n| [`" + command.name + "`](#"), std::string::npos) << command.name;
  }
}

TEST_F(Reference, HasEveryKeyAndCaseOfEveryScenario) {
  for (const std::string& scenario : testing::scenario_names()) {
    const std::string text = page("scenarios/" + scenario + ".md");
    const ScenarioFile file = testing::scenario_file(scenario);
    std::set<std::string> seen;  // cases have most keys in common
    for (const std::string& name : file.cases()) {
      EXPECT_TRUE(has_row(text, name)) << scenario << " " << name;
      const std::vector<std::string> keys = keys_of(testing::prepare(scenario, name).config_text);
      EXPECT_GT(keys.size(), 10u);
      for (const std::string& key : keys) {
        if (!seen.insert(key).second) continue;
        // A key of all axes may be without their names.
        EXPECT_TRUE(has_row(text, key) || has_row(text, on_page(key)) ||
                    has_row(text, "axis.NAME." + key))
            << scenario << " " << key;
      }
    }
  }
}

TEST_F(Reference, HasEveryMetricAndColumnOfABriefRun) {
  for (const std::string& scenario : testing::scenario_names()) {
    const std::string text = page("scenarios/" + scenario + ".md");
    const std::string first = testing::scenario_file(scenario).default_case();
    const Recording run = testing::prepare(scenario, first, {"run.duration_s=1"}).scenario->run({});
    for (const Metric& metric : run.metrics) {
      const std::string row = "\n| `" + metric.name + "` | " + metric.unit + " | ";
      EXPECT_NE(text.find(row), std::string::npos) << scenario << row;
    }
    const Track& log = run.track("control");
    for (std::size_t i = 0; i < log.signals(); ++i) {
      const std::string name = log.signal(i).name, unit = log.signal(i).unit;
      EXPECT_TRUE(has(text, "\n| `" + name + "` | " + unit + " | ") ||
                  has(text, "\n| `" + on_page(name) + "` | " + unit + " | "))
          << scenario << " " << name;
    }
  }
}

TEST_F(Reference, HasEveryKeyMetricAndColumnOfEstimate) {
  const auto made = testing::run_program(
      {"breakwater", "estimate", "--csv", testing::source_file("data/estimate/motor.csv"), "--set",
       "plant.inertia=1e-3", "encoder.quantum=1.5e-3", "--out", "est"},
      folder_);
  ASSERT_EQ(made.status, 0) << made.err;
  std::vector<std::string> names = keys_of(testing::text_of(folder_ / "est/config.toml"));
  const auto metrics = nlohmann::json::parse(testing::text_of(folder_ / "est/metrics.json"));
  for (const auto& metric : metrics.items()) names.push_back(metric.key());
  std::istringstream header(testing::lines_of(testing::text_of(folder_ / "est/log.csv")).front());
  for (std::string column; std::getline(header, column, ',');) names.push_back(column);
  EXPECT_GT(names.size(), 40u);
  const std::string text = page("estimate.md");
  for (const std::string& name : names) {
    EXPECT_TRUE(has_row(text, name)) << name;
  }
}

}  // namespace breakwater::reference_test
