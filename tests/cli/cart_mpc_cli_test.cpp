// The cart's predictive-control scenarios: invalid input, and their tables.
#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace breakwater {
namespace {
const std::string kCartFile = "scenarios/cart_offset_free/cart_offset_free.toml";
namespace fs = std::filesystem;

using testing::ProgramResult;

class CartMpcCommandLine : public testing::ProgramTest {};

TEST_F(CartMpcCommandLine, NonsenseIsOneLineAndStatus2) {
  expect_refusals(
      "cart_offset_free --set ",
      {{"controller.r=0", "--set: controller.r: must be positive, is 0"},
       {"controller.r=-1", "--set: controller.r: must be positive, is -1"},
       {"controller.r=nan", "--set: controller.r: must be finite, is nan"},
       {"controller.q_position=-1", "--set: controller.q_position: must be 0 or more, is -1"},
       {"controller.prediction_steps=0",
        "--set: controller.prediction_steps: must be from 1 to 1000, is 0"},
       {"controller.control_steps=0",
        "--set: controller.control_steps: must be from 1 to 1000, is 0"},
       {"controller.prediction_steps=4",
        "PROJECT/" + kCartFile + ":" +
            testing::line_of(testing::text_of(testing::source_file(kCartFile)), "control_steps") +
            ": controller.control_steps: "
            "must not be more than controller.prediction_steps"},
       {"controller.period_s=0.015",
        "--set: controller.period_s: must be a whole multiple of control.period_s"},
       {"constraint.input_lower_N=3",
        "--set: constraint.input_lower_N: must not be above constraint.input_upper_N"},
       {"constraint.position_lower_m=2",
        "--set: constraint.position_lower_m: must not be above constraint.position_m"},
       {"constraint.position_steps=21",
        "--set: constraint.position_steps: must not be more than 20"},
       {"constraint.input_steps=6", "--set: constraint.input_steps: must not be more than 5"},
       {"constraint.input_lower_N=1 constraint.input_change_N=0.1",
        "--set: constraint.input_change_N: no input satisfies the input constraints from rest on"},
       {"solver.name=quadprog",
        "--set: solver.name: must be one of active_set, hildreth, is \"quadprog\""},
       {"solver.max_iterations=0", "--set: solver.max_iterations: must be from 1 to 1000000, is 0"},
       {"solver.softness=0", "--set: solver.softness: must be positive, is 0"},
       {"observer.poles_rad_s=[-1]",
        "--set: observer.poles_rad_s: pole placement: needs one group of poles per output, 3 poles "
        "in all"},
       {"noise.enabled=1", "--set: noise.enabled: must be true or false, is 1"},
       {"controller.q_disturbanc=1",
        "--set: controller.q_disturbanc: unknown key (did you mean controller.q_disturbance?)"}});
  expect_refusals(
      "cart_constrained --set condition=",
      {{"F", "--set: condition: must be one of A, B, C, D, E, is \"F\" (did you mean A?)"},
       {"1", "--set: condition: must be one of A, B, C, D, E, is 1"}});
}

TEST_F(CartMpcCommandLine, InfeasibleInFlightEndsTheRunIfAsked) {
  const ProgramResult result =
      run("cart_constrained --set constraint.velocity_m_s=0.05 solver.on_infeasible=stop");
  EXPECT_EQ(result.status, 3);
  EXPECT_TRUE(has(result.err, "no input satisfies the constraints"));
}

TEST_F(CartMpcCommandLine, ConfigOfARunGivesItAgain) {
  ran("cart_constrained --set condition=B run.duration_s=5");
  EXPECT_TRUE(has(ran("cart_constrained --print-config --config "
                      "runs/cart_constrained/proposed-idob-seed1/config.toml")
                      .out,
                  "condition = \"B\""));
}

// Measured times differ from run to run: they are in the manifest and not among the metrics.
TEST_F(CartMpcCommandLine, CostsAreInTheManifestAndNotAmongTheMetrics) {
  const ProgramResult result =
      ran("cart_constrained --case proposed-idob --duration 0.1 --out run");
  EXPECT_TRUE(lacks(result.out, "_us"));
  const auto costs = json("run/manifest.json")["costs"];
  EXPECT_EQ(costs.size(), 2U);
  EXPECT_GT(costs["qp_time_mean_us"].get<double>(), 0.0);
  EXPECT_GE(costs["qp_time_max_us"].get<double>(), costs["qp_time_mean_us"].get<double>());
  const auto metrics = json("run/metrics.json");
  EXPECT_TRUE(metrics.contains("qp_iterations_mean"));
  for (const auto& [name, value] : metrics.items()) EXPECT_FALSE(name.ends_with("_us")) << name;
}

TEST_F(CartMpcCommandLine, MatrixRunsEveryCaseUnderEveryCondition) {
  const std::string matrix = "breakwater run cart_constrained --matrix --duration 0.1";
  EXPECT_TRUE(has(ran(matrix).out, "max_input_N by condition"));
  for (const char* run : {"A/lqr-idob", "C/proposed-idob", "E/proposed-time_varying-kfd"}) {
    EXPECT_TRUE(fs::exists(folder_ / "runs/cart_constrained/matrix-seed1" / run / "metrics.json"));
  }
  ran(matrix);  // replaces an earlier matrix
  expect_refusals("", {{"cart_constrained --matrix --case lqr-idob",
                        "cart_constrained: --matrix: runs all cases, so leave --case out"},
                       {"cart_offset_free --matrix",
                        "cart_offset_free: --matrix: this scenario has no conditions"}});
}

}  // namespace
}  // namespace breakwater
