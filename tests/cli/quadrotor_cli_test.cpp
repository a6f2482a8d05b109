// What quadrotor_waves says to nonsense on the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "cli/program.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

using testing::ProgramResult;

class QuadrotorCommandLine : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }

  ProgramResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "quadrotor_waves");
    return testing::run_program(arguments, folder_);
  }

  void expect_one_line(const std::vector<std::string>& arguments, const std::string& says) const {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.status, 2) << says;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_TRUE(result.out.empty()) << result.out;
  }

  fs::path folder_ = testing::temporary_path("quadrotor_cli");
  testing::Removed removed_{folder_};
};

TEST_F(QuadrotorCommandLine, NonsenseIsOneLineAndStatus2) {
  expect_one_line({"--set", "wave.significant_height_m=-1"},
                  "wave.significant_height_m: must be 0");
  expect_one_line({"--set", "wave.peak_period_s=0"}, "wave.peak_period_s: must be positive");
  expect_one_line({"--set", "task.start_m=[0,0,1]"}, "task.start_m: z must not be above");
  expect_one_line({"--set", "task.reference_m=[0,0,0.5]"}, "task.reference_m: z must not be above");
  expect_one_line({"--set", "wave.water_depth_m=8"}, "z must be above the water's bottom");
  expect_one_line({"--set", "reading=leteral"}, "did you mean");
  expect_one_line({"--set", "estimator.measurement_covariance=true"}, "measurement_covariance");
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(QuadrotorCommandLine, AModelNeedsItsThrusterSites) {
  std::string mjcf = testing::text_of(testing::source_file("models/quadrotor.xml"));
  for (const std::string from : {"name=\"t3\"", "site=\"t3\""}) {
    mjcf.replace(mjcf.find(from), from.size(), from.substr(0, 6) + "tx\"");
  }
  const testing::Removed model(testing::temporary_path("no_site.xml"));
  const fs::path path = testing::temporary_path("no_site.xml");
  std::ofstream(path) << mjcf;
  expect_one_line({"--set", "model.mjcf=" + path.string()}, "has no site named \"t3\"");
}

TEST_F(QuadrotorCommandLine, NanEndsTheRunWithStatus3) {
  const std::vector<std::string> broken = {
      "--duration",     "2",           "--quiet", "--set", "metrics.window_s=1",
      "fault.sensor=z", "fault.at_s=1"};
  const ProgramResult stopped = run(broken);
  EXPECT_EQ(stopped.status, 3);
  EXPECT_NE(stopped.err.find("t = 1 s: sensor z is not finite"), std::string::npos) << stopped.err;
  std::vector<std::string> dropped = broken;
  dropped.emplace_back("sensor.nan_policy=drop");
  EXPECT_EQ(run(dropped).status, 0);
}

}  // namespace
}  // namespace breakwater
