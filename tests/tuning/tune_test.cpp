// `breakwater tune` as users meet it.
#include <algorithm>
#include <set>
#include <utility>

#include "tuning/tuning_folder.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::kTuning;
using testing::ProgramResult;

class Tune : public testing::TuningFolder {};

TEST_F(Tune, LeavesAFrontThatCanBeRun) {
  write("t.toml", kTuning);
  const ProgramResult result = tune({"t.toml", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
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
    EXPECT_GT(std::stod(front[i][4]), 0.0);  // else there is no second objective
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
  // A point's file is its run.
  const ProgramResult run = testing::run_program(
      {ISHIGAMI_LAB, "run", "ishigami", "--config", "s/front/1.toml", "--out", "r"}, folder_);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(read("r/metrics.json").find("y_1"), std::string::npos);
  // The volume grows with the budget.
  const auto volumes = results("s", "hypervolume.csv");
  ASSERT_EQ(volumes.size(), 1U + 2 * 8);
  for (std::size_t i = 2; i < 9; ++i) {
    EXPECT_GE(std::stod(volumes[i][2]), std::stod(volumes[i - 1][2]));
  }
  EXPECT_GT(std::stod(volumes[8][2]), 0.0);
}

TEST_F(Tune, WorkersAndKillsChangeNoByte) {
  write("t.toml", kTuning);
  const auto in = [](const std::string& out, const std::string& jobs) {
    return std::vector<std::string>{"t.toml", "--out", out, "--jobs", jobs, "--quiet"};
  };
  ASSERT_EQ(tune(in("one", "1")).status, 0);
  ASSERT_EQ(tune(in("two", "2")).status, 0);
  expect_same("one", "two");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> moment(0.005, 0.3);
  for (int i = 0; i < 20; ++i) tune(in("killed", i % 2 == 0 ? "1" : "2"), moment(random));
  ASSERT_EQ(tune(in("killed", "2")).status, 0);
  expect_same("one", "killed");
  // The folder's name alone goes on too: all is there, and nothing runs.
  ASSERT_EQ(tune({"killed"}).status, 0);
  expect_same("one", "killed");
}

TEST_F(Tune, NonsenseIsOneLineAndStatus2) {
  const std::string head = "scenario = \"ishigami\"\n";
  const std::string search = "[search]\n\"x.first\" = { uniform = [-3, 3] }\n";
  const std::string objective = "[objective]\ny_1 = { goal = \"min\" }\n";
  const std::string two = objective + "positive_x_second_1 = { goal = \"max\" }\n";
  const auto expect = [&](const std::string& text, const std::string& message) {
    write("bad.toml", head + text);
    const ProgramResult result = tune({"bad.toml", "--out", "s"});
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err << message;
    EXPECT_FALSE(fs::exists(folder_ / "s"));
  };
  const std::string budget = "budget = 80\n";
  expect(search + two, "bad.toml: budget: is missing");
  expect("budget = 79\n" + search + two, "bad.toml:2: budget: a budget of 79 is below one");
  expect("budgte = 80\n", "bad.toml:2: budgte: unknown key (did you mean budget?)");
  expect(budget + search, "bad.toml: objective: names no metric");
  expect(budget + two, "bad.toml: search: names no key");
  expect(budget + "[search]\n" + two, "bad.toml: search: names no key");
  expect(budget + search + objective, "nsga2 needs two objectives");
  expect(budget + "algorithm = \"nsga3\"\n" + search + two, "(did you mean nsga2?)");
  expect(budget + "algorithm = \"cmaes\"\n" + search + two, "cmaes has one objective, not 2");
  expect(budget + "population = 10\n" + search + two,
         "bad.toml:3: population: nsga2's population must be a multiple of 4");
  expect(budget + "[search]\n\"x.frist\" = { uniform = [0, 1] }\n" + two,
         "bad.toml:4: search.x.frist: unknown key (did you mean x.first?)");
  expect(budget + "[search]\n\"x.first\" = { normal = [0, 1] }\n" + two, "a search needs ends");
  expect(budget + "[search]\n\"x.first\" = { uniform = [1, 0] }\n" + two, "is upside down");
  expect(budget + "[search]\n\"y.noise\" = { uniform = [-1, 1] }\n" + two,
         "bad.toml:4: search.y.noise: must");
  expect(budget + search + two + "y_3 = { goal = \"min\" }\n",
         "bad.toml:8: objective.y_3: a run of plain has no such metric (did you mean y_1?)");
  expect(budget + search + two + "[constraint]\ny_2 = { max = 1 }\n",
         "bad.toml:9: constraint.y_2: a run of plain has no such metric (did you mean y_1?)");
  expect(budget + search + two + "[constraint]\ny_1 = { over = \"worst\" }\n",
         "bad.toml:9: constraint.y_1: must have min or max");
  expect(budget + search + "[objective]\ny_1 = { goal = \"mni\" }\n", "(did you mean min?)");
  expect(budget + search + "[objective]\ny_1 = \"min\"\n", "must be a table");
  expect(budget + search + two + "[world]\n\"x.first\" = [1, 2]\n", "is searched too");
  expect(budget + search + two + "[world]\n\"x.third\" = { uniform = [1, 2] }\n",
         "a world has values");
  const std::string listed = budget + "worlds = \"list\"\n" + search + two;
  expect(listed + "[world]\n\"x.third\" = [1, 2]\n\"y.noise\" = [0, 1, 2]\n",
         "world.y.noise: has 3 values, x.third has 2: in a list all have as many");
  expect(budget + "worlds = \"lits\"\n" + search + two, "(did you mean list?)");
  expect(budget + search + "[vary]\n\"x.first\" = [1]\n" + two, "is of a sweep: breakwater sweep");
  expect(budget + search + two + "[validate]\npoints = 3\n", "needs seeds or a world");
  expect(budget + "seeds = [1, 2]\n" + search + two + "[validate]\nseeds = [2, 3]\n",
         "has a world that the tuning has too");
  expect(budget + "case = \"nosy\"\n" + search + two, "(did you mean noisy?)");
  expect("budget = 1000000\nseeds = { count = 1000 }\n" + search + two, "are more than 10000000");
}

TEST_F(Tune, WorldsAreCombinationsOrAList) {
  const std::string head =
      "scenario = \"ishigami\"\nbudget = 16\npopulation = 8\nseeds = { count = 2 }\n";
  const std::string rest =
      "[search]\n\"x.first\" = { uniform = [-3, 3] }\n[objective]\ny_1 = { goal = \"min\" }\n"
      "positive_x_second_1 = { goal = \"max\" }\n"
      "[world]\n\"x.third\" = [-1, 0, 1]\n\"y.noise\" = [0, 0.1, 0.2]\n"
      "[validate]\n[validate.world]\n\"x.third\" = [2, 3]\n\"y.noise\" = [0, 0.1]\n";
  // Of each candidate: x.third and y.noise of its worlds.
  using Pairs = std::set<std::pair<std::string, std::string>>;
  const auto worlds = [&](const std::string& folder, const std::string& use) {
    const auto rows = results(folder);
    const auto column = [&](const char* name) {
      const auto found = std::find(rows[0].begin(), rows[0].end(), name);
      EXPECT_NE(found, rows[0].end()) << name;
      return static_cast<std::size_t>(found - rows[0].begin());
    };
    Pairs found;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (rows[i][column("use")] != use) continue;
      found.insert({rows[i][column("x.third")], rows[i][column("y.noise")]});
    }
    return found;
  };
  write("grid.toml", head + rest);
  ASSERT_EQ(tune({"grid.toml", "--out", "grid"}).status, 0);
  EXPECT_EQ(worlds("grid", "search").size(), 9U);
  EXPECT_EQ(worlds("grid", "validate").size(), 4U);
  write("list.toml", head + "worlds = \"list\"\n" + rest);
  ASSERT_EQ(tune({"list.toml", "--out", "list"}).status, 0);
  EXPECT_EQ(worlds("list", "search"), (Pairs{{"-1", "0"}, {"0", "0.1"}, {"1", "0.2"}}));
  EXPECT_EQ(worlds("list", "validate"), (Pairs{{"2", "0"}, {"3", "0.1"}}));
  // The folder's own file says the same.
  EXPECT_EQ(tune({"list"}).status, 0);
}

// From 1 to 3 s and from 4 to 6 s: nobody asks for a window from 4 to 3 s.
TEST_F(Tune, WorldsOfAListAreCheckedAsTheyAre) {
  const std::string text =
      "scenario = \"motor_estimation\"\nbudget = 16\npopulation = 8\n"
      "[search]\n\"controller.kp\" = { uniform = [5, 10] }\n[objective]\n"
      "peak_position_rad = { goal = \"min\" }\nrmse_velocity_rad_s = { goal = \"min\" }\n"
      "[world]\n\"metrics.from_s\" = [1, 4]\n\"metrics.to_s\" = [3, 6]\n";
  write("grid.toml", text);
  EXPECT_EQ(testing::run_program({"breakwater", "tune", "grid.toml", "--dry-run"}, folder_).status,
            2);
  write("list.toml", "worlds = \"list\"\n" + text);
  const ProgramResult list =
      testing::run_program({"breakwater", "tune", "list.toml", "--dry-run"}, folder_);
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_EQ(list.err, "");
}

TEST_F(Tune, WarnsOfAKeyThatACaseDoesNotUse) {
  write("t.toml",
        "scenario = \"motor_estimation\"\nbudget = 16\npopulation = "
        "8\n[for_each.stf]\n[for_each.qvff]\n"
        "[set]\n\"disturbance.frequency_rad_s\" = 2\n"
        "[search]\n\"controller.kp\" = { uniform = [5, 10] }\n[objective]\n"
        "peak_position_rad = { goal = \"min\" }\nrmse_velocity_rad_s = { goal = \"min\" }\n");
  const ProgramResult result =
      testing::run_program({"breakwater", "tune", "t.toml", "--dry-run"}, folder_);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  EXPECT_NE(result.err.find("tune: warning: stf: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("disturbance.kind"), std::string::npos) << result.err;
}

TEST_F(Tune, SaysIfNobodySurvives) {
  write("t.toml",
        "scenario = \"ishigami\"\nbudget = 16\npopulation = 8\n[search]\n"
        "\"x.first\" = { uniform = [-3, 3] }\n[objective]\ny_1 = { goal = \"min\" }\n"
        "positive_x_second_1 = { goal = \"max\" }\n[constraint]\ny_1 = { max = -99 }\n");
  const ProgramResult result = tune({"t.toml", "--out", "s"});
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(result.err, "tune: plain: no candidate of 16 met all constraints without a failure\n");
  EXPECT_EQ(results("s", "front.csv").size(), 1U);
  // Another tuning does not go on there.
  write("t.toml", read("t.toml") + "[world]\n\"x.third\" = [0]\n");
  const ProgramResult other = tune({"t.toml", "--out", "s"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("holds another study"), std::string::npos) << other.err;
}

}  // namespace
}  // namespace breakwater
