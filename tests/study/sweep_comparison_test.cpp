#include <cmath>
#include <numbers>

#include <breakwater/statistics/sensitivity.h>
#include "study/sweep_folder.h"

namespace breakwater {
namespace {
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

// Five walls and five seeds: x.third = 1.5 is worse in all 25 pairs, but there are only five
// blocks.
TEST_F(SweepComparison, SeedsRepeatASample) {
  write("study.toml", R"toml(
scenario = "ishigami"
case = "noisy"
seeds = { first = 1, count = 5 }
[vary]
"x.second" = "lin(0.1,1,5)"
"trouble.takes_s" = [0, 0.0001]                 # of no effect: its values are repeats
[compare]
"x.third" = [0.5, 1.5]
baseline = "x.third = 0.5"
goal.y_1 = "min"
)toml");
  const ProgramResult few = swept("study.toml --out few --all");
  EXPECT_TRUE(has(few.out, "too few blocks", "with 5 blocks p cannot be below 0.0625"));
  auto cells = results("few", "comparison.csv");
  EXPECT_EQ(cells[1].at(18) + cells[1].at(23) + cells[1].at(14), "too few blocks50.0625");
  const std::string page = read("few/report.html");
  EXPECT_TRUE(has(page, ">too few blocks</td>"));
  // With `--worlds seeds` each seed is a block. The two values of an ineffective key count once.
  swept("study.toml --worlds seeds --out seeds");
  cells = results("seeds", "comparison.csv");
  EXPECT_EQ(cells[1].at(18) + cells[1].at(23), "worse25");
  EXPECT_TRUE(has(read("seeds/study.toml"), "worlds = \"seeds\"\n"));
  EXPECT_EQ(read("seeds/results.csv"), read("few/results.csv"));
  // Without a varied key the seeds are the blocks.
  write("seeds.toml", R"toml(
scenario = "ishigami"
case = "noisy"
seeds = { first = 1, count = 8 }
[compare]
"y.noise" = [0.1, 0.2]
metrics = ["y_1"]
)toml");
  swept("seeds.toml --out alone");
  EXPECT_EQ(results("alone", "comparison.csv").at(1).at(23), "8");
  expect_refusals(
      "ishigami_lab sweep study.toml --out no ",
      {{"--worlds sample",
        "--worlds: must be one of samples, seeds, is \"sample\" (did you mean samples?)"},
       {"--goal y_1=min --goal y_1=max", "--goal: y_1: is given twice"}});
}

// y = sin x₁ + 7 sin² x₂ + 0.1 x₃⁴ sin x₁ is least for x.third = 0, and at most 8.1 for x.third
// = 1.
TEST_F(SweepComparison, AnswersItsQuestionOnOneScreen) {
  write("study.toml", R"toml(
scenario = "ishigami"
seeds = { first = 1, count = 2 }
[vary]
"x.first"  = "lin(0.1,2.9,12)"
"x.second" = [0.5, 1, 1.5]
[compare]
"x.third" = [2, 1, 0]
goal.y_1 = "min"
[require]
y_1 = { max = 9.5 }
)toml");
  const ProgramResult result = swept("study.toml --out s");
  const std::vector<std::string> lines = testing::lines_of(result.out);
  EXPECT_LE(lines.size(), 25U) << result.out;
  const std::string sentence = "x.third = 0 has the lowest y_1: ";
  EXPECT_EQ(lines.at(0).substr(0, sentence.size()), sentence);
  EXPECT_TRUE(has(result.out, "below the next (x.third = 1)", "in 36 of 36", "216 of 216",
                  "y_1 at most 9.5 in all conditions."));
  EXPECT_TRUE(lacks(result.out, "better in"));
  EXPECT_TRUE(has(swept("s --all").out, "better in"));
  const std::string json = read("s/ranking.json"), page = read("s/report.html");
  EXPECT_TRUE(has(json, "\"is_shown\": true", "\"p_holm\"", sentence));
  EXPECT_LT(page.find("<p class=\"finding\">" + sentence), page.find("class=\"score\""));
  EXPECT_TRUE(has(page, "aria-label=\"Ranking\""));
  EXPECT_TRUE(has(read("s/study.toml"),
                  "[require]\nshare = 1.0\nconfidence = 0.95\ny_1 = { max = 9.5 }\n"));
  EXPECT_TRUE(has(swept("study.toml --out s").out, sentence));  // the same study
  const std::string options = "ishigami --seeds 1..3 --case plain,noisy --goal y_1=min --out ";
  write("bounded.toml", R"toml(
scenario = "ishigami"
seeds = [1, 2, 3]
[compare]
case = ["plain", "noisy"]
goal.y_1 = "min"
[require]
positive_x_second_1.max = 2
y_1 = { min = 1, max = 9.5 }
)toml");
  swept("bounded.toml --out file");
  swept(options + "options --require y_1=1..9.5 --require positive_x_second_1=..2");
  EXPECT_EQ(read("options/study.toml"), read("file/study.toml"));
  // A study without a goal ranks nothing.
  EXPECT_TRUE(has(swept("ishigami --case plain,noisy --vary x.first=1,2 --out none").out,
                  "Nothing is ranked without a goal"));
}

TEST_F(SweepComparison, ThePageOpensWithTheFirstNamedMetric) {
  int count = 0;
  const auto first = [&](const std::string& options) {
    const std::string out = std::to_string(++count);
    swept("ishigami --case plain,noisy --seeds 1..6 --out " + out + " " + options);
    const std::string page = read(out + "/report.html");
    const std::size_t at = page.find('>', page.find("<h2", page.find("id=\"metric-1\""))) + 1;
    return page.substr(at, page.find('<', at) - at);
  };
  EXPECT_EQ(first(""), "y");
  const std::string second = "positive_x_second_1", label = "Positive x second";
  EXPECT_EQ(first("--metrics " + second), label);
  EXPECT_EQ(first("--goal " + second + "=max"), label);
  EXPECT_EQ(first("--goal y_1=min --goal " + second + "=max"), "y");  // not in alphabetic order
}

TEST_F(SweepComparison, RowsWithFewerTestConditionsAreMarked) {
  write("study.toml", R"toml(
scenario = "ishigami"
[vary]
"x.first" = [0, 0.5, 2]
[compare]
"trouble.fails_above" = [10, 1, 9]
baseline = "trouble.fails_above = 10"
)toml");
  const ProgramResult result = swept("study.toml --out s --all");
  EXPECT_TRUE(has(result.out, "2 *"));
  EXPECT_TRUE(lacks(result.out, "3 *"));
  EXPECT_TRUE(has(result.out, "\n* fewer than 3 blocks: "));
}

// A misspelt name is found before the study runs.
TEST_F(SweepComparison, TheFirstRunsRevealAMisspeltMetric) {
  expect_refusals(
      "ishigami_lab sweep ishigami --case plain,noisy --seeds 1..9 --out misspelt ",
      {{"--goal y_2=max", "--goal: y_2: there is no such metric (did you mean y_1?)"},
       {"--goal unheard_of=max",
        "--goal: unheard_of: there is no such metric (there are y_1, positive_x_second_1)"},
       {"--metrics y_2", "compare.metrics: y_2: there is no such metric (did you mean y_1?)"}});
  EXPECT_EQ(sweep("ishigami --metrics y_2 --dry-run").status, 2);
  // A finished study is not changed by one either.
  const std::string study = "ishigami --case plain,noisy --seeds 1..9 --out finished ";
  swept(study);
  const std::string text = read("finished/study.toml");
  EXPECT_EQ(sweep(study + "--goal y_2=max").err,
            "--goal: y_2: there is no such metric (did you mean y_1?)\n");
  EXPECT_EQ(read("finished/study.toml"), text);
}

TEST_F(SweepComparison, SensitivityIndicesOfTheIshigamiFunctionMatchTheClosedForm) {
  const double pi = std::numbers::pi;
  const std::string from_minus_to_plus_pi = "=uniform(-3.141592653589793,3.141592653589793)";
  swept("ishigami --method saltelli --samples 4096 --vary x.first" + from_minus_to_plus_pi +
        " --vary x.second" + from_minus_to_plus_pi + " --vary x.third" + from_minus_to_plus_pi +
        " --out s");
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 1U + 4096 * 5);
  Eigen::MatrixXd f(4096, 5);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    f(static_cast<Eigen::Index>((i - 1) / 5), static_cast<Eigen::Index>((i - 1) % 5)) =
        std::stod(rows[i][8]);
  }
  const SensitivityIndices indices = sensitivity_indices(f, {.replicates = 0});
  const double a = 7.0, b = 0.1;
  const double v1 = 0.5 * std::pow(1.0 + b * std::pow(pi, 4) / 5.0, 2);
  const double v2 = a * a / 8.0;
  const double v13 = b * b * std::pow(pi, 8) * (1.0 / 18.0 - 1.0 / 50.0);
  const double v = v1 + v2 + v13;
  const double first_order[] = {v1 / v, v2 / v, 0.0}, total[] = {(v1 + v13) / v, v2 / v, v13 / v};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(indices.first_order[k].value, first_order[k], 0.01) << k;
    EXPECT_NEAR(indices.total[k].value, total[k], 0.01) << k;
  }
}

}  // namespace
}  // namespace breakwater
