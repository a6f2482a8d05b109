// The command `analyze` as users call it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "cli/program.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;

class Analyze : public ::testing::Test {
 protected:
  Analyze() { fs::create_directories(folder_); }
  ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"breakwater", "analyze"});
    return testing::run_program(arguments, folder_);
  }

  fs::path folder_ = testing::temporary_path("analyze");
  testing::Removed removed_{folder_};
};

TEST_F(Analyze, LeavesATableAPageAndTheNumbers) {
  const ProgramResult result = run({"motor_estimation", "--case", "idob,vfakfd", "--points", "3",
                                    "--from", "5", "--to", "50", "--settle", "1"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* words : {"idob measured", "vfakfd measured", "phase margin [deg]"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words;
  }
  EXPECT_NE(result.err.find("vfakfd: measured alone"), std::string::npos) << result.err;
  const fs::path out = folder_ / "runs/analyze/motor_estimation";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(out)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"analysis.csv", "margins.csv", "report.html"}));
  const std::string page = testing::text_of(out / "report.html");
  EXPECT_NE(page.find("Loop gain"), std::string::npos);
  EXPECT_EQ(page.find("{{"), std::string::npos);
  const std::string csv = testing::text_of(out / "analysis.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 1200 + 3 + 3);
}

TEST_F(Analyze, NonsenseIsOneLineAndLeavesNothing) {
  const std::vector<std::vector<std::string>> nonsense = {
      {},
      {"arm_push"},
      {"motor_estimaton"},
      {"motor_estimation", "--case", "nobody"},
      {"motor_estimation", "--from", "10", "--to", "1"},
      {"motor_estimation", "--to", "1e6"},
      {"motor_estimation", "--points", "1"},
      {"motor_estimation", "--set", "observer.nam=idob"}};
  for (const auto& arguments : nonsense) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(fs::is_empty(folder_));
  }
}

TEST_F(Analyze, ALoopThatRunsAwayIsAFailedRun) {
  const ProgramResult result =
      run({"motor_estimation", "--case", "idob", "--set", "sensor.delay_samples=1000", "--points",
           "2", "--from", "1", "--to", "50", "--settle", "60"});
  EXPECT_EQ(result.status, 3) << result.out << result.err;
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace breakwater
