// The quadrotor under waves: equal runs, older files, and readings. Its bounds are in cases.txt.

#include "regression/run_case.h"

namespace breakwater::quadrotor_waves_test {
namespace {

using testing::run_case;

TEST(QuadrotorWaves, IsReproducible) {
  const std::vector<std::string> sets = {"run.duration_s=5", "metrics.window_s=2"};
  const Recording one = run_case("quadrotor_waves", "resonator", sets);
  EXPECT_EQ(one.state_hash, run_case("quadrotor_waves", "resonator", sets).state_hash);
  EXPECT_NE(one.state_hash,
            run_case("quadrotor_waves", "resonator", {sets[0], sets[1], "run.seed=2"}).state_hash);
}

// A run of an earlier version: C_m alone, and the state hash that it had.
TEST(QuadrotorWaves, OldFilesKeepAVehicleWithoutAddedMass) {
  const ScenarioFile shipped = testing::scenario_file("quadrotor_waves");
  const testing::TemporaryPath path("older.toml");
  const std::string key = "added_mass_coefficient = 0.5 ";
  std::ofstream(path) << testing::replaced(shipped.text(), key, "#");
  const auto older = [&](const std::string& file) {
    return prepare_run(testing::catalogue(), "quadrotor_waves",
                       ScenarioFile(file, "quadrotor_waves"), "resonator",
                       {"run.duration_s=5", "metrics.window_s=2", "wave.inertia_coefficient=1.5"});
  };
  const PreparedRun run = older(path.string());
  EXPECT_EQ(run.scenario->run({}).state_hash, 0x80480e5c71fc68f2U);
  EXPECT_TRUE(lacks(run.config_text, "added_mass_coefficient ="));
  const testing::TemporaryPath again("again.toml");
  std::ofstream(again) << run.config_text;
  EXPECT_EQ(older(again.string()).config_text, run.config_text);
}

TEST(QuadrotorWaves, SetsHavePriorityOverTheReading) {
  const PreparedRun run = testing::prepare("quadrotor_waves", "ukf-zero",
                                           {"controller.gains=printed", "reading=literal"});
  EXPECT_TRUE(has(run.config_text, "gains = \"printed\"", "interpretation = \"variance\"",
                  "disturbance = \"zero\""));
}

TEST(QuadrotorWaves, WarnsOfUnstableGains) {
  const auto warnings = [&](const char* gains) {
    return testing::prepare("quadrotor_waves", "resonator", {gains}).scenario->warnings().size();
  };
  EXPECT_EQ(warnings("controller.gains=printed"), 1U);
  EXPECT_EQ(warnings("controller.gains=retuned"), 0U);
}

}  // namespace
}  // namespace breakwater::quadrotor_waves_test
