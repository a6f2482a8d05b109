// `breakwater tune` as users meet it.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <set>
#include <utility>

#include "search/tuning_folder.h"

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
  // Without noise both seeds of a candidate, and all six that validate it, are one run.
  const std::string copies =
      " runs are the same as another one of their candidate: without noise seeds change nothing\n";
  EXPECT_NE(result.err.find("tune: warning: search: 64 of 256" + copies), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("tune: warning: validation: 18 of 36" + copies), std::string::npos)
      << result.err;
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
  EXPECT_NE(read("s/report.html").find("have the reference point y_1 = "), std::string::npos);
  EXPECT_NE(read("s/report.html").find(", positive_x_second_1 = "), std::string::npos);
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
  expect("case = \"plian\"\n" + budget + search + two, "bad.toml:2: case: ");
  expect(budget + search + two + "[for_each.plian]\n", "(did you mean plain?)");
  expect(budget + search + two + "[set]\n\"x.first\" = 1\n", "search.x.first: is set and searched");
  expect(budget + search + two + "[set]\n\"x.third\" = 1\n[world]\n\"x.third\" = [1, 2]\n",
         "world.x.third: is set and varied");
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

// One joint's settling time, and one pole, alone.
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
  const auto breakwater = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "breakwater");
    return testing::run_program(words, folder_);
  };
  const ProgramResult result = breakwater({"tune", "t.toml", "--out", "s", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto front = results("s", "front.csv");
  EXPECT_EQ(front[0][3], "controller.t_ref_s[1]");
  EXPECT_EQ(front[0][5], "observer.poles_rad_s[1][2]");
  // The first point by hand, with whole arrays: the same configuration.
  const ProgramResult by_hand = breakwater(
      {"run", "arm_wall_contact", "--print-config", "--set", "run.duration_s=3",
       "wall.solid_from_s=1", "force.from_s=1",
       "controller.t_ref_s=[" + front[1][3] + ", 1.0, " + front[1][4] + "]",
       "observer.poles_rad_s=[[-40, " + front[1][5] + ", -46], [-41, -44, -47], [-42, -45, -48]]"});
  EXPECT_EQ(by_hand.status, 0) << by_hand.err;
  EXPECT_EQ(read("s/front/1.toml"), by_hand.out);
  // The tuning's own file says the same.
  EXPECT_EQ(breakwater({"tune", "s", "--quiet"}).status, 0);

  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& message) {
    std::string text = kElements;
    write("bad.toml", text.replace(text.find(from), from.size(), to));
    const ProgramResult bad = breakwater({"tune", "bad.toml", "--out", "b"});
    EXPECT_EQ(bad.status, 2);
    EXPECT_EQ(bad.err, "bad.toml:" + message + "\n");
    EXPECT_FALSE(fs::exists(folder_ / "b"));
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
  const ProgramResult result =
      testing::run_program({"breakwater", "tune", "t.toml", "--dry-run"}, folder_);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  EXPECT_NE(result.err.find("tune: warning: stf: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("disturbance.kind"), std::string::npos) << result.err;
}

// kTuning with two generations.
std::string brief(const std::string& more) {
  std::string text = kTuning;
  return text.replace(text.find("64"), 2, "16") + more;
}

TEST_F(Tune, ACrashIsAFailedRun) {
  // Of x.first from -3 to 3 all above 1 end their process, and in the middle nothing does.
  write("t.toml", brief("[set]\n\"trouble.crashes_above\" = 1\n"));
  EXPECT_EQ(tune({"t.toml", "--out", "once", "--quiet"}).status, 128 + SIGABRT);
  const ProgramResult result = tune({"t.toml", "--out", "s", "--isolate", "--jobs", "2"});
  ASSERT_EQ(result.status, 0) << result.err;
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
  // Whoever runs what: one process at a time, killed again and again; and what one process began.
  for (int i = 0; i < 2; ++i) tune({"t.toml", "--out", "killed", "--isolate", "--quiet"}, 1.0);
  ASSERT_EQ(tune({"t.toml", "--out", "killed", "--isolate", "--jobs", "1", "--quiet"}).status, 0);
  expect_same("s", "killed");
  ASSERT_EQ(tune({"once", "--isolate", "--quiet"}).status, 0);
  expect_same("s", "once");
  // All is there: nothing runs, and nothing crashes.
  EXPECT_EQ(tune({"s", "--quiet"}).status, 0);
}

TEST_F(Tune, ProcessesOfTheirOwnChangeNoByte) {
  write("t.toml", brief(""));
  const ProgramResult here = tune({"t.toml", "--out", "one", "--quiet"});
  ASSERT_EQ(here.status, 0);
  const ProgramResult apart = tune({"t.toml", "--out", "apart", "--isolate", "--quiet"});
  ASSERT_EQ(apart.status, 0);
  EXPECT_EQ(apart.err, here.err);
  expect_same("one", "apart");
}

TEST_F(Tune, WithIsolateTheFileIsCheckedBeforeItBegins) {
  std::string text = kTuning;
  write("t.toml", text.replace(text.find("y_1 = { max"), 3, "y_3"));
  const ProgramResult wrong = tune({"t.toml", "--out", "s", "--isolate"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("constraint.y_3: a run of plain has no such metric (did you mean y_1?)"),
            std::string::npos)
      << wrong.err;
  EXPECT_EQ(std::count(wrong.err.begin(), wrong.err.end(), '\n'), 1) << wrong.err;
  EXPECT_FALSE(fs::exists(folder_ / "s"));
  // A crash in the middle of the ranges is no mistake.
  write("t.toml", brief("[set]\n\"trouble.crashes_above\" = -0.1\n"));
  EXPECT_EQ(tune({"t.toml", "--out", "s", "--isolate", "--quiet"}).status, 0);
  EXPECT_GT(results("s").size(), 1U);
}

TEST_F(Tune, ARunThatIsKilledFromOutsideIsLeftUndone) {
  write("t.toml", brief("[set]\n\"trouble.killed_above\" = 2\n"));
  const ProgramResult killed = tune({"t.toml", "--out", "s", "--isolate", "--quiet"});
  EXPECT_EQ(killed.status, 2);
  EXPECT_NE(killed.err.find("is left undone: its process was ended by signal 9"), std::string::npos)
      << killed.err;
  EXPECT_NE(killed.err.find("left undone: the same command goes on\n"), std::string::npos)
      << killed.err;
}

TEST_F(Tune, ADryRunSaysHowLongItTakes) {
  write("t.toml", std::string(kTuning) + "[set]\n\"trouble.takes_s\" = 0.1\n");
  const ProgramResult result = tune({"t.toml", "--out", "s", "--dry-run", "--jobs", "2"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(
      result.out.find("256 runs: 2 cases, 64 evaluations of each, 2 worlds and seeds together\n"
                      "at most 36 more to validate: 3 of each front in 6\nabout "),
      0U)
      << result.out;
  // 292 runs of 0.1 s, or a little more.
  double seconds = 0.0;
  ASSERT_EQ(std::sscanf(result.out.c_str() + result.out.find("about "), "about %lf s on 2 cores",
                        &seconds),
            1)
      << result.out;
  EXPECT_GE(seconds, 14.6 - 0.05);
  EXPECT_LT(seconds, 2.0 * 14.6);
  EXPECT_FALSE(fs::exists(folder_ / "s"));
  // What a run of the file tells is told before the tuning begins.
  write("t.toml", std::string(kTuning) + "[set]\n\"trouble.fails_above\" = -1\n");
  EXPECT_EQ(
      tune({"t.toml", "--out", "s", "--dry-run"}).err,
      "tune: warning: plain: the candidate in the middle fails: at 0.5 s: x_1 is too large\n"
      "tune: warning: noisy: the candidate in the middle fails: at 0.5 s: x_1 is too large\n");
}

TEST_F(Tune, WhatMakesNoGenerationIsNotCounted) {
  std::string text = kTuning;
  write("t.toml", text.replace(text.find("64"), 2, "20"));
  EXPECT_EQ(
      tune({"t.toml", "--out", "s", "--dry-run"})
          .out.find("64 runs: 2 cases, 16 evaluations of each, 2 worlds and seeds together (4 of "
                    "the budget are left: they make no generation)\n"),
      0U);
  ASSERT_EQ(tune({"t.toml", "--out", "s", "--quiet"}).status, 0);
  EXPECT_NE(tune({"s", "--status"}).out.find("64 of 64 runs of the search are done, "),
            std::string::npos);
}

TEST_F(Tune, SaysWhatATargetIsInstead) {
  const auto said = [&](const std::string& target) {
    const ProgramResult result = tune({target});
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  EXPECT_EQ(said("ishigami"), "ishigami: is a scenario: a tuning is a file that names it\n");
  EXPECT_EQ(said("ishigmi"), "ishigmi: there is no such file or folder\n");
  fs::create_directory(folder_ / "empty");
  EXPECT_EQ(said("empty"), "empty: has no tune.toml: it is no tuning's folder\n");
  ASSERT_EQ(sweep({"ishigami", "--out", "swept", "--quiet"}).status, 0);
  EXPECT_EQ(said("swept"), "swept: has no tune.toml: it is a study's: ishigami_lab sweep\n");
  write("t.toml", brief(""));
  ASSERT_EQ(tune({"t.toml", "--out", "tuned", "--quiet"}).status, 0);
  EXPECT_EQ(sweep({"tuned"}).err, "tuned: has no study.toml: it is ishigami_lab tune's\n");
  write("bare.toml", "[search]\nx.first[1] = [1, 2]\n");
  EXPECT_EQ(said("bare.toml"),
            "bare.toml:2: is not TOML: Error while parsing key-value pair: expected '=', saw '[' "
            "(a key with brackets needs quotes)\n");
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
