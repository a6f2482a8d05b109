// What the cart's predictive-control scenarios say to nonsense, and their tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

using testing::ProgramResult;

class CartMpcCommandLine : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }

  ProgramResult run(const std::vector<std::string>& arguments) const {
    return testing::run_program(arguments, folder_);
  }

  fs::path folder_ = testing::temporary_path("cart_mpc_cli");
  testing::Removed removed_{folder_};
};

TEST_F(CartMpcCommandLine, NonsenseIsOneLineAndStatus2) {
  const std::vector<std::vector<std::string>> nonsense = {
      {"controller.r=0"},
      {"controller.r=-1"},
      {"controller.r=nan"},
      {"controller.q_position=-1"},
      {"controller.prediction_steps=0"},
      {"controller.control_steps=0"},
      {"controller.prediction_steps=4"},  // below N_u = 5
      {"controller.period_s=0.015"},
      {"constraint.input_lower_N=3"},  // above the upper bound
      {"constraint.position_lower_m=2"},
      {"constraint.position_steps=21"},
      {"constraint.input_steps=6"},
      {"constraint.input_lower_N=1", "constraint.input_change_N=0.1"},  // empty at the start
      {"solver.name=quadprog"},
      {"solver.max_iterations=0"},
      {"solver.softness=0"},
      {"observer.poles_rad_s=[-1]"},
      {"noise.enabled=1"},
      {"controller.q_disturbanc=1"}};
  for (const auto& sets : nonsense) {
    std::vector<std::string> arguments = {"cart_offset_free", "--set"};
    arguments.insert(arguments.end(), sets.begin(), sets.end());
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.status, 2) << sets.front() << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(result.out.empty()) << result.out;
  }
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(run({"cart_constrained", "--set", "condition=F"}).status, 2);
  EXPECT_EQ(run({"cart_constrained", "--set", "condition=1"}).status, 2);
}

TEST_F(CartMpcCommandLine, InfeasibleInFlightEndsTheRunIfAsked) {
  const ProgramResult result = run(
      {"cart_constrained", "--set", "constraint.velocity_m_s=0.05", "solver.on_infeasible=stop"});
  EXPECT_EQ(result.status, 3);
  EXPECT_NE(result.err.find("no input satisfies the constraints"), std::string::npos);
}

TEST_F(CartMpcCommandLine, ConfigOfARunGivesItAgain) {
  const auto first = run({"cart_constrained", "--set", "condition=B", "run.duration_s=5"});
  ASSERT_EQ(first.status, 0) << first.err;
  const ProgramResult again =
      run({"cart_constrained", "--config", "runs/cart_constrained/proposed-idob-seed1/config.toml",
           "--print-config"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.out.find("condition = \"B\""), std::string::npos);
}

// What a clock measured differs from run to run: it is told in the manifest, and is no metric.
TEST_F(CartMpcCommandLine, CostsAreInTheManifestAndNotAmongTheMetrics) {
  const ProgramResult result =
      run({"cart_constrained", "--case", "proposed-idob", "--duration", "0.1", "--out", "run"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out.find("_us"), std::string::npos) << result.out;
  const auto json = [&](const char* file) {
    std::ifstream stream(folder_ / "run" / file);
    return nlohmann::json::parse(stream);
  };
  const auto costs = json("manifest.json")["costs"];
  EXPECT_EQ(costs.size(), 2U);
  EXPECT_GT(costs["qp_time_mean_us"].get<double>(), 0.0);
  EXPECT_GE(costs["qp_time_max_us"].get<double>(), costs["qp_time_mean_us"].get<double>());
  const auto metrics = json("metrics.json");
  EXPECT_TRUE(metrics.contains("qp_iterations_mean"));
  for (const auto& [name, value] : metrics.items()) EXPECT_FALSE(name.ends_with("_us")) << name;
}

TEST_F(CartMpcCommandLine, MatrixRunsEveryCaseUnderEveryCondition) {
  const ProgramResult matrix =
      run({"breakwater", "run", "cart_constrained", "--matrix", "--duration", "0.1"});
  ASSERT_EQ(matrix.status, 0) << matrix.err;
  EXPECT_NE(matrix.out.find("max_input_N by condition"), std::string::npos);
  for (const char* run : {"A/lqr-idob", "C/proposed-idob", "E/proposed-time_varying-kfd"}) {
    EXPECT_TRUE(fs::exists(folder_ / "runs/cart_constrained/matrix-seed1" / run / "metrics.json"));
  }
  EXPECT_EQ(run({"breakwater", "run", "cart_constrained", "--matrix", "--duration", "0.1"}).status,
            0)
      << "an earlier matrix is replaced";
  EXPECT_EQ(run({"cart_constrained", "--matrix", "--case", "lqr-idob"}).status, 2);
  EXPECT_EQ(run({"cart_offset_free", "--matrix"}).status, 2);
}

}  // namespace
}  // namespace breakwater
