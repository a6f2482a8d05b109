#include <csignal>
#include <cstdio>
#include <set>
#include <utility>

#include "search/tuning_folder.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::kSmall;
using testing::kTuning;
using testing::ProgramResult;

class Tune : public testing::TuningFolder {};

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

// y = sin x_1 + 7 sin² x_2 has its minimum of 0 in x_2 at 0; sin x_1 falls to the lower end of its
// range. `noisy` adds 0.1 sin(seed).
constexpr const char* kOneObjective = R"(
scenario = "ishigami"
case = ["noisy", "plain"]
algorithm = "cmaes"
budget = 60
population = 6
seeds = [1, 2]
[set]
"x.third" = 0
[search]
"x.first" = { uniform = [-1, 1] }
"x.second" = { uniform = [-1, 1] }
[objective]
y_1 = { goal = "GOAL", over = "mean" }
[validate]
seeds = [11, 12, 13, 14, 18, 19, 20, 24]
)";

TEST_F(Tune, RanksTheTunedCasesOfOneObjective) {
  write("t.toml", testing::replaced(kOneObjective, "GOAL", "min"));
  const ProgramResult result = tuned("t.toml --out s --jobs 2");
  for (const char* word : {"the front", "ypervolume", "Pareto", "compromise", "front.csv"}) {
    EXPECT_TRUE(lacks(result.out, word)) << result.out;
    EXPECT_TRUE(lacks(read("s/report.html"), word)) << word;
    EXPECT_TRUE(lacks(read("s/tuned.csv"), word)) << word;
  }
  EXPECT_TRUE(lacks(read("s/tune.toml"), "points"));
  EXPECT_FALSE(fs::exists(folder_ / "s/front"));
  EXPECT_FALSE(fs::exists(folder_ / "s/hypervolume.csv"));
  // Equal budgets, and the same fresh conditions.
  std::map<std::string, int> runs;
  for (const auto& row : results("s")) ++runs[row[1] + " " + row[3]];
  EXPECT_EQ(runs["plain search"], 120);
  EXPECT_EQ(runs["noisy search"], 120);
  EXPECT_EQ(runs["plain validate"], 8);
  EXPECT_EQ(runs["noisy validate"], 8);
  const auto rows = results("s", "tuned.csv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].back(), "at_bound");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].back(), "x.first") << "x.second has its optimum inside";
    EXPECT_LT(std::stod(rows[i][3]), -0.98);
    EXPECT_NEAR(std::stod(rows[i][4]), 0.0, 0.1);
  }
  EXPECT_TRUE(has(result.out, " (at its bound)"));
  EXPECT_TRUE(has(read("s/ranking.json"), "\"metric\": \"y_1\""));
  ran("ishigami_lab run ishigami --config s/tuned/plain.toml --out r");
  // The page, the terminal and the ranking say the same sentence. The file in the folder is the
  // same tuning.
  const std::string sentence = result.out.substr(0, 24);
  EXPECT_TRUE(has(read("s/report.html"), sentence)) << sentence;
  const std::string table = read("s/tuned.csv");
  tuned("s --jobs 1");
  EXPECT_EQ(read("s/tuned.csv"), table);
  // The other goal: the other end of the range, and a larger value.
  write("t.toml", testing::replaced(kOneObjective, "GOAL", "max"));
  tuned("t.toml --out most --quiet");
  EXPECT_GT(std::stod(results("most", "tuned.csv")[1][3]), 0.98);
  // One case without a validation.
  write("t.toml", testing::replaced(testing::replaced(kOneObjective, "GOAL", "min"),
                                    "[\"noisy\", \"plain\"]", "\"plain\""));
  std::string alone = read("t.toml");
  write("t.toml", alone.substr(0, alone.find("[validate]")));
  EXPECT_TRUE(
      has(tuned("t.toml --out alone").out, "plain has the mean y_1 ", "the value is too good"));
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

// The metric is one of the scenario, but the run is shorter than its window.
TEST_F(Tune, AMetricWithoutItsWindowIsNoUnknownOne) {
  write("t.toml",
        "scenario = \"motor_estimation\"\ncase = \"stf\"\nalgorithm = \"cmaes\"\nbudget = 10\n"
        "population = 5\n[set]\nrun.duration_s = 0.3\n[search]\n"
        "observer.alpha = { log_uniform = [1, 2] }\n[objective]\nrms_torque_Nm = { goal = \"min\" "
        "}\n");
  EXPECT_TRUE(has(run("breakwater tune t.toml --out s").err,
                  "t.toml:11: objective.rms_torque_Nm: a run of stf lacks it: the run does not "
                  "cover its window, from disturbance.start_s to the run's end\n"));
}

TEST_F(Tune, AnEditedTuningRunsAgainWhatItAsksFor) {
  const std::string other = testing::replaced(kTuning, "[-3, 3]", "[-2, 3]");
  ASSERT_NE(other, kTuning);
  write("t.toml", kTuning);
  write("other.toml", other);
  tuned("t.toml --out s --quiet");
  tuned("other.toml --out new --quiet");
  for (int both = 0; both < 2; ++both) {  // cases
    write("s/tune.toml", testing::replaced(read("s/tune.toml"), "[-3", "[-2"));
  }
  EXPECT_TRUE(has(tuned("s --quiet").err, "had other values than this search asks for"));
  expect_same("s", "new");
  EXPECT_TRUE(lacks(tuned("s --quiet").err, "had other values"));
}

TEST_F(Tune, NonsenseIsOneLineAndStatus2) {
  const std::string search = "[search]\n\"x.first\" = { uniform = [-3, 3] }\n";
  const std::string objective = "[objective]\ny_1 = { goal = \"min\" }\n";
  const std::string two = objective + "positive_x_second_1 = { goal = \"max\" }\n";
  const std::string budget = "budget = 80\n";
  const std::string listed = budget + "worlds = \"list\"\n" + search + two;
  for (const auto& [text, line] : Refusals{
           {search + two, "bad.toml: budget: is missing"},
           {"budget = 79\n" + search + two,
            "bad.toml:2: budget: a budget of 79 is below one generation: 40 are drawn before it, "
            "and as many are bred of them"},
           {"budgte = 80\n", "bad.toml:2: budgte: unknown key (did you mean budget?)"},
           {budget + search, "bad.toml: objective: names no metric"},
           {budget + two, "bad.toml: search: names no key"},
           {budget + "[search]\n" + two, "bad.toml: search: names no key"},
           {budget + search + objective,
            "bad.toml: algorithm: nsga2 needs two objectives or more; cmaes and bobyqa have one"},
           {budget + "algorithm = \"nsga3\"\n" + search + two,
            "bad.toml:3: algorithm: must be one of nsga2, nspso, maco, cmaes, bobyqa, is \"nsga3\" "
            "(did you mean nsga2?)"},
           {budget + "algorithm = \"cmaes\"\n" + search + two,
            "bad.toml:3: algorithm: cmaes has one objective, not 2; nsga2, nspso and maco have "
            "several"},
           {budget + "population = 10\n" + search + two,
            "bad.toml:3: population: nsga2's population must be a multiple of 4, 8 at least, not "
            "10"},
           {budget + "[search]\n\"x.frist\" = { uniform = [0, 1] }\n" + two,
            "bad.toml:4: search.x.frist: unknown key (did you mean x.first?)"},
           {budget + "[search]\n\"x.first\" = { normal = [0, 1] }\n" + two,
            "bad.toml:4: search.x.first: a search needs ends: uniform, log_uniform or values"},
           {budget + "[search]\n\"x.first\" = { uniform = [1, 0] }\n" + two,
            "bad.toml:4: search.x.first: the range [1, 0] is upside down"},
           {budget + "[search]\n\"y.noise\" = { uniform = [-1, 1] }\n" + two,
            "bad.toml:4: search.y.noise: must be 0 or more, is -0.8675734021522394"},
           {budget + search + two + "y_3 = { goal = \"min\" }\n",
            "bad.toml:8: objective.y_3: a run of plain has no such metric (did you mean y_1?)"},
           {budget + search + two + "[constraint]\ny_2 = { max = 1 }\n",
            "bad.toml:9: constraint.y_2: a run of plain has no such metric (did you mean y_1?)"},
           {budget + search + two + "[constraint]\ny_1 = { over = \"worst\" }\n",
            "bad.toml:9: constraint.y_1: must have either min or max"},
           {budget + search + "[objective]\ny_1 = { goal = \"mni\" }\n",
            "bad.toml:6: objective.y_1.goal: must be one of min, max, is \"mni\" (did you mean "
            "min?)"},
           {budget + search + "[objective]\ny_1 = \"min\"\n",
            "bad.toml:6: objective.y_1: must be a table: { goal = \"min\", over = \"median\" }"},
           {budget + search + two + "[world]\n\"x.first\" = [1, 2]\n",
            "bad.toml:9: world.x.first: is searched too"},
           {"case = \"plian\"\n" + budget + search + two,
            "bad.toml:2: case: PROJECT/tests/study/ishigami/ishigami.toml has no case \"plian\" "
            "(did you mean plain?)"},
           {budget + search + two + "[for_each.plian]\n",
            "bad.toml:8: for_each.plian: PROJECT/tests/study/ishigami/ishigami.toml has no case "
            "\"plian\" (did you mean plain?)"},
           {budget + search + two + "[set]\n\"x.first\" = 1\n",
            "bad.toml:4: search.x.first: is set and searched"},
           {budget + search + two + "[set]\n\"x.third\" = 1\n[world]\n\"x.third\" = [1, 2]\n",
            "bad.toml:11: world.x.third: is set and varied"},
           {budget + search + two + "[set]\n\"x.thrid\" = 1\n",
            "bad.toml:9: set.x.thrid: unknown key (did you mean x.third?)"},
           {budget + "seeds = [1, 2]\n" + search + two + "[set]\nrun.seed = 1\n",
            "bad.toml:10: set.run.seed: stands beside seeds: leave one of them out"},
           {budget + search + two + "[world]\n\"x.third\" = { uniform = [1, 2] }\n",
            "bad.toml:9: world.x.third: a world has values: an array, lin() or log()"},
           {listed + "[world]\n\"x.third\" = [1, 2]\n\"y.noise\" = [0, 1, 2]\n",
            "bad.toml:11: world.y.noise: has 3 values, x.third has 2: in a list all have as many"},
           {budget + search + two + "[world]\n\"run.seed\" = [1, 2]\n",
            "bad.toml:9: world.run.seed: say seeds instead"},
           {budget + "worlds = \"lits\"\n" + search + two,
            "bad.toml:3: worlds: must be one of grid, list, is \"lits\" (did you mean list?)"},
           {budget + search + "[vary]\n\"x.first\" = [1]\n" + two,
            "bad.toml:5: vary: is of a sweep: breakwater sweep"},
           {budget + search + two + "[validate]\npoints = 3\n",
            "bad.toml:8: validate: needs seeds or a world that the tuning does not have"},
           {budget + "seeds = [1, 2]\n" + search + two + "[validate]\nseeds = [2, 3]\n",
            "bad.toml:9: validate: has a world that the tuning has too"},
           {budget + "algorithm = \"cmaes\"\n" + search +
                "[objective]\ny_1 = { goal = \"min\", reference = 3 }\n",
            "bad.toml:7: objective.y_1.reference: is of a hypervolume, which one objective does "
            "not "
            "have"},
           {budget + "algorithm = \"cmaes\"\n" + search + objective +
                "[validate]\nseeds = [9]\npoints = 3\n",
            "bad.toml:10: validate.points: is of a front, which one objective does not have"},
           {budget + "case = [\"plain\", \"plain\"]\n" + search + two,
            "bad.toml:3: case: plain is there twice"},
           {budget + "case = [\"plain\", \"nosy\"]\n" + search + two,
            "bad.toml:3: case: PROJECT/tests/study/ishigami/ishigami.toml has no case \"nosy\" "
            "(did you mean noisy?)"},
           {budget + "case = \"nosy\"\n" + search + two,
            "bad.toml:3: case: PROJECT/tests/study/ishigami/ishigami.toml has no case \"nosy\" "
            "(did you mean noisy?)"},
           {"budget = 1000000\nseeds = { count = 1000 }\n" + search + two,
            "budget: 1e+09 runs are more than 10000000: 1 cases, 1000000 evaluations, 1000 worlds "
            "and seeds"}}) {
    write("bad.toml", "scenario = \"ishigami\"\n" + text);
    SCOPED_TRACE(text);
    expect_refused("ishigami_lab tune bad.toml --out s", line);
  }
}

TEST_F(Tune, WorldsAreCombinationsOrAList) {
  const std::string head =
      "scenario = \"ishigami\"\nbudget = 16\npopulation = 8\nseeds = { count = 2 }\n";
  const std::string rest =
      "[search]\n\"x.first\" = { uniform = [-3, 3] }\n[objective]\ny_1 = { goal = \"min\" }\n"
      "positive_x_second_1 = { goal = \"max\" }\n"
      "[world]\n\"x.third\" = [-1, 0, 1]\n\"y.noise\" = [0, 0.1, 0.2]\n"
      "[validate]\n[validate.world]\n\"x.third\" = [2, 3]\n\"y.noise\" = [0, 0.1]\n";
  // For each candidate: x.third and y.noise of its test conditions.
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
  tuned("grid.toml --out grid");
  EXPECT_EQ(worlds("grid", "search").size(), 9U);
  EXPECT_EQ(worlds("grid", "validate").size(), 4U);
  write("list.toml", head + "worlds = \"list\"\n" + rest);
  tuned("list.toml --out list");
  EXPECT_EQ(worlds("list", "search"), (Pairs{{"-1", "0"}, {"0", "0.1"}, {"1", "0.2"}}));
  EXPECT_EQ(worlds("list", "validate"), (Pairs{{"2", "0"}, {"3", "0.1"}}));
  // The file in the folder gives the same tuning.
  tuned("list");
}

// The list has 1 to 3 s and 4 to 6 s. The window from 4 to 3 s is not part of it.
TEST_F(Tune, WorldsOfAListAreCheckedSeparately) {
  const std::string text =
      "scenario = \"motor_estimation\"\nbudget = 16\npopulation = 8\n"
      "[search]\n\"controller.kp\" = { uniform = [5, 10] }\n[objective]\n"
      "peak_position_rad = { goal = \"min\" }\nrmse_velocity_rad_s = { goal = \"min\" }\n"
      "[world]\n\"metrics.from_s\" = [1, 4]\n\"metrics.to_s\" = [3, 6]\n";
  write("grid.toml", text);
  expect_refused("breakwater tune grid.toml --dry-run",
                 "grid.toml:11: world.metrics.to_s: must be later than metrics.from_s");
  write("list.toml", "worlds = \"list\"\n" + text);
  EXPECT_EQ(ran("breakwater tune list.toml --dry-run").err, "");
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

  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& line) {
    write("bad.toml", testing::replaced(kElements, from, to));
    expect_refused("breakwater tune bad.toml --out b", "bad.toml:" + line);
  };
  refused("s[3]", "s[4]", "11: search.controller.t_ref_s[4]: controller.t_ref_s has 3 elements");
  refused("t_ref_s[1]", "t_ref_s[0]",
          "10: search.controller.t_ref_s[0]: elements are counted from 1: controller.t_ref_s[1] is "
          "the first");
  refused("controller.t_ref_s[1]", "wall.distance_m[1]",
          "10: search.wall.distance_m[1]: wall.distance_m is no array");
  refused("\"controller.t_ref_s[3]\" = { uniform = [0.4, 2] }",
          "controller.t_ref_s = [[1, 1, 1], [2, 2, 2]]",
          "11: search.controller.t_ref_s: controller.t_ref_s[1] is given too: give the array, or "
          "elements of it");
  refused("uniform = [0.4, 2] }\n\"o", "uniform = [-0.4, 2] }\n\"o",
          "11: search.controller.t_ref_s[3]: must be positive, is -0.39999999760000005");
  refused("[objective]", "[world]\n\"controller.t_ref_s[2]\" = [1, 0]\n[objective]",
          "14: world.controller.t_ref_s[2]: must be positive, is 0");
}

TEST_F(Tune, WarnsOfAKeyThatACaseDoesNotUse) {
  write("t.toml",
        "scenario = \"motor_estimation\"\nbudget = 16\npopulation = "
        "8\n[for_each.stf]\n[for_each.qvff]\n"
        "[set]\n\"disturbance.frequency_rad_s\" = 2\n"
        "[search]\n\"controller.kp\" = { uniform = [5, 10] }\n[objective]\n"
        "peak_position_rad = { goal = \"min\" }\nrmse_velocity_rad_s = { goal = \"min\" }\n");
  const ProgramResult result = ran("breakwater tune t.toml --dry-run");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  EXPECT_TRUE(has(result.err, "tune: warning: stf: ", "disturbance.kind"));
}

// kTuning with only two generations.
std::string brief(const std::string& more) {
  return testing::replaced(kTuning, "64", "16") + more;
}

TEST_F(Tune, ACrashIsAFailedRun) {
  // x.first is in -3 … 3. Values above 1 end their process; the middle does not.
  write("t.toml", std::string(kSmall) + "[set]\n\"trouble.crashes_above\" = 1\n");
  EXPECT_EQ(tune("t.toml --out once --quiet").status, 128 + SIGABRT);
  tuned("t.toml --out s --isolate --jobs 2");
  const auto rows = results("s");
  std::size_t crashes = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const bool has_crashed = std::find(rows[i].begin(), rows[i].end(), "crashed") != rows[i].end();
    EXPECT_EQ(has_crashed, std::stod(rows[i][5]) > 1.0);
    crashes += has_crashed;
  }
  EXPECT_GT(crashes, 0U);
  for (const auto& point : results("s", "front.csv")) {
    if (point[0] != "case") {
      EXPECT_LE(std::stod(point[3]), 1.0);
    }
  }
  // One process at a time with repeated kills, then a single process, on the same folders.
  for (const std::size_t count : {3, 8}) {
    tune("t.toml --out killed --isolate --quiet", has_results("killed", count));
  }
  tuned("t.toml --out killed --isolate --jobs 1 --quiet");
  expect_same("s", "killed");
  tuned("once --isolate --quiet");
  expect_same("s", "once");
  // All runs are done, so nothing runs or crashes.
  tuned("s --quiet");
}

TEST_F(Tune, SeparateProcessesChangeNoResult) {
  write("t.toml", brief(""));
  const ProgramResult here = tuned("t.toml --out one --quiet");
  const ProgramResult apart = tuned("t.toml --out apart --isolate --quiet");
  EXPECT_EQ(apart.err, here.err);
  expect_same("one", "apart");
}

TEST_F(Tune, WithIsolateTheFileIsCheckedBeforeItBegins) {
  write("t.toml", testing::replaced(kTuning, "y_1 = { max", "y_3 = { max"));
  expect_refused(
      "ishigami_lab tune t.toml --out s --isolate",
      "t.toml:16: constraint.y_3: a run of plain has no such metric (did you mean y_1?)");
  // A crash in the middle of the ranges is allowed.
  write("t.toml", brief("[set]\n\"trouble.crashes_above\" = -0.1\n"));
  tuned("t.toml --out s --isolate --quiet");
  EXPECT_GT(results("s").size(), 1U);
}

TEST_F(Tune, ARunKilledFromOutsideStaysUndone) {
  write("t.toml", brief("[set]\n\"trouble.killed_above\" = 2\n"));
  const ProgramResult killed = tune("t.toml --out s --isolate --quiet");
  EXPECT_EQ(killed.status, 2);
  EXPECT_TRUE(has(killed.err, "is left undone: its process was ended by signal 9",
                  "left undone: the same command goes on\n"));
}

TEST_F(Tune, ADryRunSaysHowLongItTakes) {
  write("t.toml", std::string(kTuning) + "[set]\n\"trouble.takes_s\" = 0.1\n");
  const ProgramResult result = tuned("t.toml --out s --dry-run --jobs 2");
  EXPECT_TRUE(result.out.starts_with(
      "256 runs: 2 cases, 64 evaluations of each, 2 worlds and seeds together\n"
      "at most 36 more to validate: 3 of each front in 6\nabout "))
      << result.out;
  // 292 runs of slightly more than 0.1 s.
  double seconds = 0.0;
  ASSERT_EQ(std::sscanf(result.out.c_str() + result.out.find("about "), "about %lf s on 2 cores",
                        &seconds),
            1)
      << result.out;
  EXPECT_GE(seconds, 14.6 - 0.05);
  EXPECT_LT(seconds, 2.0 * 14.6);
  EXPECT_FALSE(fs::exists(folder_ / "s"));
  // Trial runs find this fault before the tuning begins.
  write("t.toml", std::string(kTuning) + "[set]\n\"trouble.fails_above\" = -1\n");
  EXPECT_EQ(
      tune("t.toml --out s --dry-run").err,
      "tune: warning: plain: the candidate in the middle fails: at 0.5 s: x_1 is too large\n"
      "tune: warning: noisy: the candidate in the middle fails: at 0.5 s: x_1 is too large\n");
}

TEST_F(Tune, IncompleteGenerationsAreNotCounted) {
  write("t.toml", testing::replaced(kTuning, "64", "20"));
  EXPECT_TRUE(
      tuned("t.toml --out s --dry-run")
          .out.starts_with("64 runs: 2 cases, 16 evaluations of each, 2 worlds and seeds "
                           "together (4 of the budget are left: they make no generation)\n"));
  tuned("t.toml --out s --quiet");
  EXPECT_TRUE(has(tune("s --status").out, "64 of 64 runs of the search are done, "));
}

TEST_F(Tune, NamesTheKindOfAWrongTarget) {
  fs::create_directory(folder_ / "empty");
  swept("ishigami --out swept --quiet");
  write("t.toml", brief(""));
  tuned("t.toml --out tuned --quiet");
  write("bare.toml", "[search]\nx.first[1] = [1, 2]\n");
  expect_refusals(
      "ishigami_lab ",
      {{"tune ishigami", "ishigami: is a scenario: a tuning is a file that names it"},
       {"tune ishigmi", "ishigmi: there is no such file or folder"},
       {"tune empty", "empty: has no tune.toml: it is no tuning's folder"},
       {"tune swept", "swept: has no tune.toml: it is a study's: ishigami_lab sweep"},
       {"sweep tuned", "tuned: has no study.toml: it is ishigami_lab tune's"},
       {"tune bare.toml",
        "bare.toml:2: is not TOML: Error while parsing key-value pair: expected '=', saw '[' "
        "(a key with brackets needs quotes)"}});
}

TEST_F(Tune, ReportsThatNoCandidateSurvives) {
  write("t.toml", std::string(kSmall) + "[constraint]\ny_1 = { max = -99 }\n");
  const ProgramResult result = tune("t.toml --out s");
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(result.err, "tune: plain: no candidate of 16 met all constraints without a failure\n");
  EXPECT_EQ(results("s", "front.csv").size(), 1U);
  // Another tuning is refused in this folder.
  write("t.toml", read("t.toml") + "[world]\n\"x.third\" = [0]\n");
  expect_refused(
      "ishigami_lab tune t.toml --out s",
      "HERE/s: holds another study: here it is `[world]`; leave it be with another --out");
}

}  // namespace
}  // namespace breakwater
