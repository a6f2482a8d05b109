#include <csignal>

#include "study/sweep_folder.h"

namespace breakwater::sweep_study {

using SweepStudy = testing::SweepFolder;

TEST_F(SweepStudy, AHundredKillsDoNotChangeTheResults) {
  const std::string study =
      "ishigami --vary x.first=lin(-3,3,20) --vary x.second=lin(-3,3,20) --seeds 1..5 "
      "--set trouble.takes_s=0.005 --jobs 2 --out ";
  swept(study + "whole");
  run_and_kill(study + "killed", 100, 0.2, 1);
  EXPECT_EQ(read("whole/results.csv"), read("killed/results.csv"));
}

// Kills at all moments of a short study: while it makes its folder, runs or collects.
TEST_F(SweepStudy, AKillAtAnyTimeDoesNotChangeTheResults) {
  const std::string study = "ishigami --vary x.first=lin(-3,3,50) --out ";
  swept(study + "whole");
  for (int i = 0; i < 100; ++i) {
    sweep(study + "killed", testing::worked_for(0.0005 * i), SIGKILL);
    swept(study + "killed");
    ASSERT_EQ(read("whole/results.csv"), read("killed/results.csv")) << i;
    std::filesystem::remove_all(folder_ / "killed");
  }
}

}  // namespace breakwater::sweep_study
