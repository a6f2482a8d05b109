#include <csignal>

#include "study/sweep_folder.h"

namespace breakwater::tune_test {
namespace fs = std::filesystem;
using testing::ProgramResult;

// Two cases with equal budgets, a constraint on one objective, and a validation.
const std::string kTuning = testing::text_of(testing::source_file("tests/search/tuning.toml"));

class Tune : public testing::SweepFolder {
 protected:
  ProgramResult tune(const std::string& words, const testing::Moment& when = nullptr,
                     int signal = SIGKILL) const {
    return run("ishigami_lab tune " + words, when, signal);
  }
  ProgramResult tuned(const std::string& words) const { return done(tune(words)); }
  void expect_same(const std::string& one, const std::string& other) {
    for (const char* file :
         {"results.csv", "front.csv", "hypervolume.csv", "report.html", "front/1.toml"}) {
      EXPECT_NE(read(one + "/" + file), "") << file;
      EXPECT_EQ(read(one + "/" + file), read(other + "/" + file)) << file;
    }
  }
};

TEST_F(Tune, WritesAFrontWhosePointsRun) {
  write("t.toml", kTuning);
  const ProgramResult result = tuned("t.toml --out s");
  // Without noise both seeds of a candidate give the same run, and so do all six of its validation.
  const std::string copies =
      " runs are the same as another one of their candidate: what differs between their "
      "conditions, "
      "such as the seed, changes nothing there\n";
  EXPECT_TRUE(has(result.err, "tune: warning: search: 64 of 256" + copies,
                  "tune: warning: validation: 18 of 36" + copies));
  const auto front = results("s", "front.csv");
  EXPECT_EQ(front[0],
            (std::vector<std::string>{
                "case", "front", "evaluation", "x.first", "x.second", "x.third", "y_1", "y_1_fresh",
                "y_1_fresh_lower", "y_1_fresh_upper", "positive_x_second_1",
                "positive_x_second_1_fresh", "positive_x_second_1_fresh_lower",
                "positive_x_second_1_fresh_upper", "y_1_constraint", "y_1_constraint_fresh",
                "y_1_constraint_fresh_lower", "y_1_constraint_fresh_upper", "fresh_failures"}));
  ASSERT_GT(front.size(), 2U);
  std::size_t validated = 0;
  for (std::size_t i = 1; i < front.size(); ++i) {
    EXPECT_EQ(front[i][1], std::to_string(i));
    EXPECT_GT(std::stod(front[i][4]), 0.0);  // the second objective exists
    EXPECT_LE(std::stod(front[i][6]), 8.0);
    EXPECT_EQ(front[i][5].empty(), front[i][0] == "plain");
    validated += !front[i][7].empty();
    if (front[i][0] == "plain" && !front[i][7].empty()) {
      EXPECT_EQ(front[i][6], front[i][7]);
    }
    EXPECT_TRUE(fs::exists(folder_ / "s/front" / (front[i][1] + ".toml")));
  }
  EXPECT_EQ(validated, 6U);
  EXPECT_EQ(results("s").size(), 1U + 2 * 64 * 2 + 6 * 6);
  EXPECT_TRUE(
      has(read("s/report.html"), "have the reference point y_1 = ", ", positive_x_second_1 = "));
  // The file of a point reproduces its run.
  ran("ishigami_lab run ishigami --config s/front/1.toml --out r");
  EXPECT_TRUE(has(read("r/metrics.json"), "y_1"));
  // The hypervolume grows with the budget.
  const auto volumes = results("s", "hypervolume.csv");
  ASSERT_EQ(volumes.size(), 1U + 2 * 8);
  for (std::size_t i = 2; i < 9; ++i) {
    EXPECT_GE(std::stod(volumes[i][2]), std::stod(volumes[i - 1][2]));
  }
  EXPECT_GT(std::stod(volumes[8][2]), 0.0);
}

TEST_F(Tune, WorkersAndKillsChangeNoResult) {
  write("t.toml", kTuning);
  const std::string one = "t.toml --quiet --jobs 1 --out ", two = "t.toml --quiet --jobs 2 --out ";
  tuned(one + "one");
  tuned(two + "two");
  expect_same("one", "two");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> moment(0.005, 0.3);
  for (int i = 0; i < 20; ++i) {
    tune((i % 2 == 0 ? one : two) + "killed", testing::worked_for(moment(random)));
  }
  tuned(two + "killed");
  expect_same("one", "killed");
  // The folder's name alone also works. All runs are done, so nothing runs.
  tuned("killed");
  expect_same("one", "killed");
}

// Searches the settling time of one joint and a single pole.
constexpr const char* kElements = R"(
scenario = "arm_wall_contact"
budget = 16
population = 8
[set]
"run.duration_s" = 3.0
"wall.solid_from_s" = 1.0
"force.from_s" = 1.0
[search]
"controller.t_ref_s[1]" = { log_uniform = [0.4, 2] }
"controller.t_ref_s[3]" = { uniform = [0.4, 2] }
"observer.poles_rad_s[1][2]" = [-41, -42, -43]
[objective]
max_posture_error_rad = { goal = "min" }
saturated_time_s = { goal = "min" }
)";

TEST_F(Tune, ElementsOfArraysAreSearchedAlone) {
  write("t.toml", kElements);
  ran("breakwater tune t.toml --out s --quiet");
  const auto front = results("s", "front.csv");
  EXPECT_EQ(front[0][3], "controller.t_ref_s[1]");
  EXPECT_EQ(front[0][5], "observer.poles_rad_s[1][2]");
  // The configuration of the first point, written by hand with whole arrays.
  EXPECT_EQ(read("s/front/1.toml"),
            ran("breakwater run arm_wall_contact --print-config --set run.duration_s=3 "
                "wall.solid_from_s=1 force.from_s=1 controller.t_ref_s=[" +
                front[1][3] + ",1," + front[1][4] + "] observer.poles_rad_s=[[-40," + front[1][5] +
                ",-46],[-41,-44,-47],[-42,-45,-48]]")
                .out);
  // The file in the folder gives the same tuning.
  ran("breakwater tune s --quiet");
}

}  // namespace breakwater::tune_test
