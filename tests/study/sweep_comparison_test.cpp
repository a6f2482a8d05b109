#include <breakwater/statistics/sensitivity.h>
#include "study/sweep_folder.h"

namespace breakwater::sweep_comparison_test {
namespace fs = std::filesystem;
using testing::ProgramResult;

class SweepComparison : public testing::SweepFolder {};

TEST_F(SweepComparison, CandidatesAreComparedInTheSameTestConditions) {
  write("study.toml", R"toml(
scenario = "ishigami"
seeds = { first = 1, count = 2 }
[vary]
"x.second" = "lin(0.1,1,12)"
[compare]
case = ["plain", "noisy"]
"x.third" = [0.5, 1.5]
baseline = "plain, x.third = 0.5"
goal = { y_1 = "min" }
)toml");
  const ProgramResult result = swept("study.toml --out s --all");
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(has(result.out, "no difference shown"));
  const auto cells = results("s", "comparison.csv");
  // A label contains a comma, so it has two cells: metric, goal, "case, key", ….
  ASSERT_EQ(cells.size(), 1U + 2 * 3 + 3);
  EXPECT_EQ(cells[1][0] + cells[1][1], "y_1min");
  // x.third = 1.5 adds 0.1 (1.5⁴ − 0.5⁴) sin x₁ in each test condition, independent of the seed.
  EXPECT_EQ(cells[1][2] + cells[1][3], "\"plain x.third = 1.5\"");
  EXPECT_EQ(cells[1][6], "24");   // pairs
  EXPECT_EQ(cells[1][25], "12");  // blocks
  EXPECT_NEAR(std::stod(cells[1][13]), 0.5 * std::sin(0.5), 1e-12);
  EXPECT_EQ(std::stod(cells[1][16]), std::ldexp(1.0, -11));
  EXPECT_EQ(cells[1].at(20), "worse");
  // Case noisy: the differences with seeds 1 and 2.
  EXPECT_NEAR(std::stod(cells[2][13]), 0.05 * (std::sin(1.0) + std::sin(2.0)), 1e-12);
  // A metric without a goal, equal for all candidates.
  EXPECT_EQ(cells[4][0] + cells[4][1], "positive_x_second_1");
  EXPECT_EQ(cells[4].at(20), "no difference shown");
  EXPECT_EQ(cells[7][0], "failure");
  // A second collection and another number of workers give the same bytes.
  const std::string bytes = read("s/comparison.csv");
  swept("study.toml --out t --jobs 1");
  EXPECT_EQ(read("t/comparison.csv"), bytes);
  // A study with one candidate compares nothing. Seeds are not blocks.
  swept(
      "ishigami --case plain --seeds 1..9 --vary x.second=1,2 --metrics y_1 --goal y_1=max "
      "--out u");
  EXPECT_FALSE(fs::exists(folder_ / "u/comparison.csv"));  // one candidate
  write("deep.toml",
        "scenario = \"ishigami\"\nseeds = [1, 2, 3]\n[vary]\n\"x.second\" = [1, 2]\n"
        "[compare]\n\"x.third\" = [0, 1]\nmetrics = [\"y_1\", \"unheard_of\"]\n");
  EXPECT_EQ(swept("deep.toml --out v").err, "sweep: compare.metrics: unheard_of: no run has it\n");
  EXPECT_EQ(results("v", "comparison.csv").at(1).at(23), "2");  // blocks
}

}  // namespace breakwater::sweep_comparison_test
