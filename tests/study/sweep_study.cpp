// A study that is killed a hundred times.
#include <csignal>

#include "study/sweep_folder.h"

namespace breakwater {
namespace {

using SweepStudy = testing::SweepFolder;

TEST_F(SweepStudy, AHundredKillsChangeNoByte) {
  const std::vector<std::string> study = {
      "ishigami", "--vary", "x.first=lin(-3,3,20)", "--vary", "x.second=lin(-3,3,20)", "--seeds",
      "1..5",     "--set",  "trouble.takes_s=0.005"};
  const auto in = [&](const std::string& out, const std::string& jobs) {
    std::vector<std::string> arguments = study;
    arguments.insert(arguments.end(), {"--out", out, "--jobs", jobs});
    return arguments;
  };
  ASSERT_EQ(sweep(in("whole", "2")).status, 0);
  run_and_kill(in("killed", "2"), 100, 0.2, 1);
  EXPECT_EQ(read("whole/results.csv"), read("killed/results.csv"));
}

// Each kill at another moment of a short study's life: while it makes its folder, runs, collects.
TEST_F(SweepStudy, AKillAtAnyMomentOfAShortStudyChangesNoByte) {
  const std::vector<std::string> study = {"ishigami", "--vary", "x.first=lin(-3,3,50)"};
  std::vector<std::string> whole = study;
  whole.insert(whole.end(), {"--out", "whole"});
  ASSERT_EQ(sweep(whole).status, 0);
  for (int i = 0; i < 100; ++i) {
    std::vector<std::string> killed = study;
    killed.insert(killed.end(), {"--out", "killed"});
    sweep(killed, 0.0005 * (i + 1), SIGKILL);
    ASSERT_EQ(sweep(killed).status, 0);
    ASSERT_EQ(read("whole/results.csv"), read("killed/results.csv")) << i;
    std::filesystem::remove_all(folder_ / "killed");
  }
}

}  // namespace
}  // namespace breakwater
