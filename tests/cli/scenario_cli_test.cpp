// The programs of carts and quadrotor: their tables and failures.
#include <nlohmann/json.hpp>

#include "cli/program.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

using testing::ProgramResult;
using testing::replaced;

class ScenarioCommandLine : public testing::ProgramTest {};

TEST_F(ScenarioCommandLine, InfeasibleInFlightEndsTheRunIfAsked) {
  const ProgramResult result =
      run("cart_constrained --set constraint.velocity_m_s=0.05 solver.on_infeasible=stop");
  EXPECT_EQ(result.status, 3);
  EXPECT_TRUE(has(result.err, "no input satisfies the constraints"));
}

TEST_F(ScenarioCommandLine, ConfigOfARunGivesItAgain) {
  ran("cart_constrained --set condition=B run.duration_s=5");
  EXPECT_TRUE(has(ran("cart_constrained --print-config --config "
                      "runs/cart_constrained/proposed-idob-seed1/config.toml")
                      .out,
                  "condition = \"B\""));
}

// Measured times differ from run to run: they are in the manifest and not among the metrics.
TEST_F(ScenarioCommandLine, CostsAreInTheManifestAndNotAmongTheMetrics) {
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

TEST_F(ScenarioCommandLine, MatrixRunsEveryCaseUnderEveryCondition) {
  const std::string matrix = "breakwater run cart_constrained --matrix --duration 0.1";
  EXPECT_TRUE(has(ran(matrix).out, "max_input_N by condition"));
  for (const char* run : {"A/lqr-idob", "C/proposed-idob", "E/proposed-time_varying-kfd"}) {
    EXPECT_TRUE(fs::exists(folder_ / "runs/cart_constrained/matrix-seed1" / run / "metrics.json"));
  }
  ran(matrix);  // replaces an earlier matrix
}

TEST_F(ScenarioCommandLine, AVehicleOfAnotherMassIsALine) {
  write("heavy.xml", replaced(testing::text_of(testing::source_file("models/quadrotor.xml")),
                              "mass=\"1.38\"", "mass=\"3\""));
  const std::string brief = "quadrotor_waves --duration 0.1 --set metrics.window_s=0.05";
  EXPECT_TRUE(has(ran(brief + " model.mjcf=heavy.xml").err,
                  "model.mjcf: the vehicle has 3 kg; estimator and controller assume 1.38 kg"));
  EXPECT_TRUE(lacks(ran(brief).err, "assume"));
}

// At -10 m a wave of 8 s keeps e^{-ω² z/g} = 0.5331 of its vertical speed. The JONSWAP sea,
// integrated with NumPy from 0.5 to 3 ω_p, keeps 0.3973.
TEST_F(ScenarioCommandLine, WavesDecayAsTheSeaDoesWhateverTheSeed) {
  for (const std::string seed : {"1", "2"}) {
    EXPECT_TRUE(has(ran("breakwater waves --height 2 --period 8 --seed " + seed).out,
                    "\n-10.0           0.5331          0.3973     0.3"));
  }
}

TEST_F(ScenarioCommandLine, NanEndsTheRunWithStatus3) {
  const std::string broken =
      "quadrotor_waves --duration 2 --quiet --set metrics.window_s=1 fault.sensor=z fault.at_s=1";
  const testing::ProgramResult stopped = run(broken);
  EXPECT_EQ(stopped.status, 3);
  EXPECT_TRUE(has(stopped.err, "t = 1 s: sensor z is not finite"));
  ran(broken + " sensor.nan_policy=drop");
}

}  // namespace
}  // namespace breakwater
