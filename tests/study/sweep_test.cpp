#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/experiment/provenance.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>
#include "environment.h"
#include "study/sweep_folder.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;

class Sweep : public testing::SweepFolder {
 protected:
  // Until the study s has a result.
  void wait_for_a_result() const {
    while (!has_results("s")(0)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

TEST_F(Sweep, AGridHasOneRowPerRunInOrder) {
  swept(
      "ishigami --case plain,noisy --vary x.first=0.1,0.2 --vary x.second=lin(-1,1,3) "
      "--seeds 1..2 --out s");
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 1U + 2 * 3 * 2 * 2);
  EXPECT_EQ(rows[0],
            (std::vector<std::string>{"point", "case", "seed", "x.first", "x.second", "status",
                                      "state_hash", "y_1", "positive_x_second_1"}));
  for (const auto& [row, cells] :
       {std::pair(1, "plain1 0.1 -1"), std::pair(2, "noisy1 0.1 -1"), std::pair(3, "plain2 0.1 -1"),
        std::pair(5, "plain1 0.1 0"), std::pair(24, "noisy2 0.2 1")}) {
    const auto& is = rows[static_cast<std::size_t>(row)];
    EXPECT_EQ(is[1] + is[2] + " " + is[3] + " " + is[4], cells);
  }
  std::set<std::string> keys;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    keys.insert(rows[i][0]);
    EXPECT_EQ(rows[i][5], "complete");
    const double y = std::sin(std::stod(rows[i][3])) +
                     7 * std::pow(std::sin(std::stod(rows[i][4])), 2) +
                     0.1 * std::pow(0.5, 4) * std::sin(std::stod(rows[i][3])) +
                     (rows[i][1] == "noisy" ? 0.1 * std::sin(std::stod(rows[i][2])) : 0.0);
    EXPECT_EQ(std::stod(rows[i][7]), y);  // 17 digits identify the double
    EXPECT_EQ(rows[i][8].empty(), std::stod(rows[i][4]) <= 0.0);
  }
  EXPECT_EQ(keys.size(), rows.size() - 1);
}

TEST_F(Sweep, AStudyFileAndItsOptionsAreTheSameStudy) {
  write("study.toml", R"(
scenario = "ishigami"
method = "sobol"
samples = 8
seeds = { first = 3, count = 2 }
[set]
x.third = 0.25
[vary]
x.first = { uniform = [-1, 1] }
"x.second" = { normal = [0.5, 0.1] }
[compare]
case = ["plain", "noisy"]
baseline = "plain"
)");
  swept("study.toml --out a");
  swept(
      "ishigami --method sobol --samples 8 --seeds 3..4 --set x.third=0.25 --vary "
      "x.first=uniform(-1,1) --vary x.second=normal(0.5,0.1) --case plain,noisy --baseline "
      "plain --out b");
  EXPECT_EQ(read("a/results.csv"), read("b/results.csv"));
  EXPECT_EQ(results("a").size(), 33U);
  // An option has priority over the file, in any spelling of the key.
  swept("study.toml --vary x.first=uniform(5,6) --set x.third=0.5 --baseline noisy --out d");
  const auto rows = results("d");
  ASSERT_EQ(rows.size(), 33U);
  const auto first = static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), "x.first") -
                                              rows[0].begin());
  EXPECT_GE(std::stod(rows[1][first]), 5.0);
  // The study file in the folder is valid too.
  swept("a/study.toml --out c");
  EXPECT_EQ(read("a/results.csv"), read("c/results.csv"));
}

TEST_F(Sweep, WorkersProcessesAndKillsDoNotChangeTheResults) {
  const std::string study =
      "ishigami --vary x.first=lin(-3,3,12) --vary x.second=lin(-3,3,12) "
      "--set trouble.fails_above=2 --set trouble.takes_s=0.002 --out ";
  swept(study + "one --jobs 1");
  swept(study + "three --jobs 3");
  swept(study + "apart --isolate");
  run_and_kill(study + "killed --jobs 2", 8, 0.15, 2);
  for (const char* other : {"three", "apart", "killed"}) {
    EXPECT_EQ(read("one/results.csv"), read(std::string(other) + "/results.csv")) << other;
  }
}

TEST_F(Sweep, ARunWithADamagedLineIsRepeated) {
  const std::string study = "ishigami --vary x.first=lin(0,1,20) --out s --jobs 1";
  swept(study);
  const std::string whole = read("s/results.csv");
  fs::path shard;
  for (const auto& entry : fs::directory_iterator(folder_ / "s/shards")) shard = entry.path();
  const std::string text = testing::text_of(shard);
  std::string damaged = text.substr(0, text.size() - 7);      // the last line is truncated
  damaged[damaged.find('\n', damaged.size() / 2) + 20] ^= 1;  // and one line is damaged
  std::ofstream(shard, std::ios::binary) << damaged;
  EXPECT_TRUE(has(sweep("s --status").out, "18 of 20 points are done"));
  swept(study);
  EXPECT_EQ(read("s/results.csv"), whole);
}

TEST_F(Sweep, APointEqualsTheRunOfItsConfiguration) {
  ran("breakwater sweep motor_estimation --case idob --vary encoder.bits=6,8 --seeds 2..3 "
      "--duration 0.2 --out s");
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 5U);
  const auto& row = rows[3];  // 8 bits, seed 2
  ran("motor_estimation --case idob --set encoder.bits=8 --seed 2 --duration 0.2 --out alone "
      "--quiet");
  const auto alone = json("alone/manifest.json");
  EXPECT_EQ(alone["point"], row[0]);
  EXPECT_EQ(alone["state_hash"], row[5]);
  ran("breakwater sweep s --replay " + row[0]);
  const std::string replayed = "s/runs/" + row[0];
  EXPECT_EQ(state_hash(replayed), row[5]);
  EXPECT_EQ(read(replayed + "/config.toml"), read("alone/config.toml"));
  EXPECT_EQ(read(replayed + "/metrics.json"), read("alone/metrics.json"));
  EXPECT_EQ(read(replayed + "/log.h5"), read("alone/log.h5"));
  expect_refused("breakwater sweep s --replay 0123456789abcdef",
                 "--replay: no point of HERE/s that ran is 0123456789abcdef: the column `point` of "
                 "results.csv names them");
}

// `./dev tsan` runs it.
TEST_F(Sweep, ThreadsShareModelsAndTheShard) {
  for (const std::string jobs : {"1", "4"}) {
    ran("breakwater sweep motor_estimation --case idob,stf --vary encoder.bits=6,8 --seeds 1..3 "
        "--duration 0.05 --keep failed --jobs " +
        jobs + " --out " + jobs);
  }
  EXPECT_EQ(read("1/results.csv"), read("4/results.csv"));
}

TEST_F(Sweep, KeepsTheChosenFolders) {
  for (const auto& [keep, count] :
       std::map<std::string, std::size_t>{{"metrics", 0}, {"failed", 1}, {"all", 3}}) {
    swept("ishigami --vary x.first=0,1,3 --set trouble.fails_above=2 --keep " + keep + " --out " +
          keep);
    std::set<std::string> kept;
    if (fs::exists(folder_ / keep / "runs")) {
      for (const auto& run : fs::directory_iterator(folder_ / keep / "runs")) {
        kept.insert(run.path().filename());
        EXPECT_TRUE(fs::exists(run.path() / "log.h5"));
      }
    }
    EXPECT_EQ(kept.size(), count) << keep;
    for (const auto& row : results(keep)) {
      EXPECT_EQ(row[4] == "failed" && kept.contains(row[0]),
                row[4] == "failed" && keep != "metrics");
    }
  }
}

TEST_F(Sweep, AFailureCountsOrStopsTheStudy) {
  const std::string study =
      "ishigami --vary x.first=lin(0,3,30) --set trouble.fails_above=1 --jobs 1 --out ";
  EXPECT_TRUE(has(swept(study + "counted").out, "20 failed"));
  EXPECT_EQ(results("counted").size(), 31U);
  EXPECT_EQ(results("counted").back()[4], "failed");
  EXPECT_EQ(results("counted").back()[6], "");  // this run has no metrics
  const ProgramResult stopped = sweep(study + "stopped --on-failure stop");
  EXPECT_EQ(stopped.status, 3);
  EXPECT_TRUE(has(stopped.err, "failed: at 0.5 s: x_1 is too large"));
  EXPECT_EQ(results("stopped").size(), 12U);
}

TEST_F(Sweep, ACrashInASeparateProcessLosesOneRun) {
  const std::string study =
      "ishigami --vary x.first=lin(0,3,31) --set trouble.crashes_above=2.85 --isolate --out s";
  EXPECT_TRUE(has(swept(study).out, "2 crashed"));
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 32U);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][4], i < 30 ? "complete" : "crashed") << i;
  }
}

// All differences are in one place.
TEST_F(Sweep, AKilledStudyGivesTheSamePage) {
  const std::string study =
      "ishigami --vary x.first=lin(-3,3,40) --case plain,noisy --seeds 1..3 "
      "--set trouble.takes_s=0.003 ";
  swept(study + "--out whole --jobs 1");
  run_and_kill(study + "--out elsewhere/killed --jobs 2", 4, 0.6, 2);
  const auto without_machine = [&](const std::string& folder) {
    std::string page = read(folder + "/report.html");
    const std::size_t begin = page.find("<!-- this machine"), end = page.find("<!-- end of this");
    EXPECT_LT(begin, end);
    EXPECT_TRUE(has(page.substr(begin, end - begin), folder));
    page.erase(begin, end - begin);
    EXPECT_TRUE(lacks(page, folder));
    return page;
  };
  EXPECT_EQ(without_machine("whole"), without_machine("elsewhere/killed"));
}

TEST_F(Sweep, TasksOfAnySchedulerCompleteTheStudy) {
  const std::string study = "ishigami --vary x.first=lin(0,1,25) --out ";
  swept(study + "whole");
  write("tasks.sh", swept(study + "tasks --print-tasks --tasks 4").out);
  EXPECT_EQ(lines("tasks.sh").size(), 4U);
  ran("/bin/sh -e tasks.sh");
  swept("tasks");
  EXPECT_EQ(read("whole/results.csv"), read("tasks/results.csv"));
}

TEST_F(Sweep, ADryRunCountsAndLeavesNothing) {
  const ProgramResult result = swept(
      "ishigami --vary x.first=lin(0,1,1000) --seeds 1..10 --set trouble.takes_s=0.01 "
      "--jobs 2 --dry-run --out s");
  EXPECT_TRUE(has(result.out, "10000 runs: 1000 samples, 10 seeds, 1 candidate",
                  "about 5"));  // slightly more than 50 s
  EXPECT_FALSE(fs::exists(folder_ / "s"));
}

TEST_F(Sweep, AnInterruptionExplainsHowToContinue) {
  const ProgramResult result =
      sweep("ishigami --vary x.first=lin(0,1,200) --set trouble.takes_s=0.1 --out s",
            has_results("s"), SIGINT);
  EXPECT_EQ(result.status, 130);
  EXPECT_TRUE(has(result.err, "of 200 points are done; the same command goes on"));
  EXPECT_FALSE(fs::exists(folder_ / "s/results.csv"));
  swept("s --collect");
  EXPECT_LT(results("s").size(), 201U);
}

TEST_F(Sweep, RefusesToContinueAnotherStudy) {
  swept("ishigami --vary x.first=1,2 --out s");
  swept("ishigami --method sobol --samples 4 --vary x.first=uniform(0,1) --out drawn");
  swept("ishigami --method lhs --samples 4 --vary x.first=uniform(0,1) --out cube");
  swept("ishigami --method list --vary x.first=1,2 --vary x.second=3,4 --out list");
  const auto another = [](const std::string& folder, const std::string& reason) {
    return "HERE/" + folder + ": holds another study: " + reason +
           "; leave it be with another --out";
  };
  const std::string drawn = "ishigami --out drawn --vary x.first=uniform(0,1) --method ";
  expect_refusals(
      "ishigami_lab sweep ",
      {{"ishigami --vary x.first=1,3 --out s", another("s", "vary.x.first: 2 is left out")},
       {"ishigami --vary x.first=1,2 --vary x.second=1,2 --out s",
        another("s", "vary: x.second is new")},
       {"ishigami --vary x.second=1,2 --out s", another("s", "vary: x.first is left out")},
       {"ishigami --vary x.first=1,2 --duration 2 --out s",
        another("s", "set: run.duration_s=2 is new")},
       {"ishigami --vary x.first=1,2 --seeds 2..9 --out s", another("s", "seeds: 1 is left out")},
       {"ishigami --vary x.first=1,2 --case noisy --out s",
        another("s", "case: plain is left out")},
       {"ishigami --vary x.first=1,2 --method list --out s",
        another("s", "method is list, and was grid")},
       {drawn + "sobol --samples 2", another("drawn", "samples is 2, and was 4")},
       {drawn + "sobol --samples 8 --sampling-seed 2",
        another("drawn", "sampling_seed is 2, and was 1")},
       {drawn + "sobol --samples 8 --vary x.second=uniform(0,1)",
        another("drawn", "vary: x.second is new")},
       {"ishigami --out drawn --vary x.first=uniform(0,2) --method sobol --samples 4",
        another("drawn",
                "vary.x.first is { uniform = [0.0, 2.0] }, and was { uniform = "
                "[0.0, 1.0] }")},
       {"ishigami --out cube --vary x.first=uniform(0,1) --method lhs --samples 8",
        another("cube",
                "samples: the points of lhs depend on their number, so none of "
                "the 4 is among 8")},
       {"ishigami --out list --method list --vary x.first=1,2 --vary x.second=4,3",
        another("list", "vary.x.second is 4, 3, and was 3, 4")},
       {"s --vary x.first=1,3",
        "s: is a study's folder, and its study.toml says what is run: leave --case, "
        "--vary, --out and the like out"}});
  ran("breakwater sweep motor_estimation --duration 0.01 --out m");
  expect_refused("breakwater sweep cart_position --duration 0.01 --out m",
                 another("m", "scenario is cart_position, and was motor_estimation"));
  // Results of another program are not continued.
  ran("/bin/sed -i 's/^program = .*/program = \"0123456789abcdef\"/' s/study.toml");
  const ProgramResult other = sweep("s");
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "/s: its results are of another program (breakwater ",
                  "): go on with what it was begun with, or begin anew with --rerun\n"));
  swept("s --rerun");
  swept("s");
  // A folder with other files.
  write("mine/thesis.tex", "text");
  expect_refusals(
      "ishigami_lab sweep ",
      {{"ishigami --out mine", "HERE/mine: holds something that is not a study; it is left alone"},
       {"mine", "mine: has no study.toml: it is no study's folder"}});
  EXPECT_EQ(read("mine/thesis.tex"), "text");
}

// Each study of 60 runs or fewer becomes a larger one, which leaves the bytes of that one begun
// alone.
TEST_F(Sweep, AStudyGrows) {
  const std::string grid = "ishigami --vary x.second=1,2,3 --set trouble.fails_above=1.5 ";
  const std::string drawn =
      "ishigami --case plain,noisy --vary x.first=uniform(-3,3) --vary "
      "x.second=normal(0,1) --method ";
  struct Growth {
    std::string before, after;
  };
  const std::vector<Growth> growths = {
      {grid + "--case plain,noisy --vary x.first=1,2 --seeds 1..5",  // 60 runs to 120
       grid + "--case plain,noisy --vary x.first=1,2 --seeds 1..10"},
      {grid + "--vary x.first=1,2 --seeds 3", grid + "--vary x.first=lin(0,3,4) --seeds 5,3"},
      {grid + "--vary x.first=1,2",
       grid + "--vary x.first=3.0,0.5,1e0,2 --case noisy,plain --sqlite"},
      {grid + "--case noisy", grid + "--case plain,noisy --baseline noisy --metrics y_1"},
      {"ishigami --method list --vary x.first=1,2 --vary x.second=3,3",
       "ishigami --method list --vary x.first=1,2,1 --vary x.second=3,3,4"},
      {drawn + "random --samples 10", drawn + "random --samples 25"},
      {drawn + "sobol --samples 8 --seeds 1..2", drawn + "sobol --samples 16 --seeds 1..3"},
      {drawn + "saltelli --samples 4", drawn + "saltelli --samples 8"},
      // These look at the same runs in another way.
      {drawn + "random --samples 10", drawn + "random --samples 10 --baseline noisy --goal y_1=max "
                                              "--metrics y_1 --keep failed --on-failure stop"}};
  const auto outputs = [&] {
    std::map<std::string, std::string> texts;
    for (const auto& entry : fs::directory_iterator(folder_ / "s")) {
      if (entry.is_regular_file()) texts[entry.path().filename()] = testing::text_of(entry.path());
    }
    // The page has the mean processor time of a run, which differs between equal studies.
    std::string& page = texts["report.html"];
    const std::size_t end = page.find(" s a run");
    const std::size_t begin = page.rfind(',', end);
    EXPECT_LT(end - begin, 20U);
    page.erase(begin, end - begin);
    return texts;
  };
  const auto lines_of_points = [&] {
    std::size_t points = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "s/shards")) {
      std::istringstream text(testing::text_of(entry.path()));
      for (std::string line; std::getline(text, line);) points += has(line, "\tasked\t");
    }
    return points;
  };
  for (const auto& [before, after] : growths) {
    fs::remove_all(folder_ / "s");
    swept(before + " --jobs 2 --out s");
    EXPECT_TRUE(lacks(swept(after + " --jobs 3 --out s").err, "warning")) << after;
    EXPECT_EQ(lines_of_points() + 1, results("s").size()) << "only new points run: " << after;
    const auto grown = outputs();
    EXPECT_EQ(swept("s").err, "");
    fs::remove_all(folder_ / "s");
    swept(after + " --out s");
    const auto at_once = outputs();
    ASSERT_EQ(grown.size(), at_once.size()) << after;
    for (const auto& [name, text] : at_once) EXPECT_TRUE(grown.at(name) == text) << name << after;
  }
}

TEST_F(Sweep, AStudyGrowsBetweenKillsAndInTasks) {
  const std::string study =
      "ishigami --case plain,noisy --vary x.first=lin(-3,3,10) --set trouble.takes_s=0.01 ";
  swept(study + "--seeds 1..6 --out whole");
  run_and_kill(study + "--seeds 1..3 --jobs 2 --out s", 4, 0.3, 5);
  run_and_kill(study + "--seeds 1..5 --isolate --jobs 2 --out s", 4, 0.3, 6);
  write("tasks.sh", swept(study + "--seeds 1..6 --out s --print-tasks --tasks 3").out);
  ran("/bin/sh -e tasks.sh");
  swept("s");
  EXPECT_EQ(read("s/results.csv"), read("whole/results.csv"));
  EXPECT_EQ(read("s/comparison.csv"), read("whole/comparison.csv"));
}

TEST_F(Sweep, AStudyAtWorkDoesNotGrow) {
  const std::string study = "ishigami --set trouble.takes_s=0.1 --out s --vary x.first=";
  ReadProgram first(
      {(testing::bin_folder() / "../tests/ishigami_lab").string(), "sweep", "ishigami", "--set",
       "trouble.takes_s=0.1", "--vary", "x.first=lin(0,1,400)", "--out", (folder_ / "s").string()},
      true);
  wait_for_a_result();
  EXPECT_TRUE(has(sweep(study + "lin(0,2,799)").err, " is at this study: it grows after that\n"));
  first.interrupt();
  while (first.next()) continue;
  EXPECT_TRUE(has(sweep(study + "lin(0,2,799) --status").out, " of 799 points are done"));
}

TEST_F(Sweep, RerunKeepsTheUsersFiles) {
  swept("ishigami --vary x.first=1,2 --out s");
  write("s/notes.txt", "mine");
  swept("s --rerun");
  EXPECT_EQ(read("s/notes.txt"), "mine");
  EXPECT_EQ(results("s").size(), 3U);
  expect_refused("ishigami_lab sweep s --rerun --replay " + results("s")[1][0],
                 "sweep: --rerun excludes --replay (see --help)");
  EXPECT_EQ(results("s").size(), 3U);
  // A study file in a folder with other files does not make it a study's folder.
  write("exp/study.toml", "scenario = \"ishigami\"\ncase = \"plain\"\nseeds = [1]\n");
  write("exp/thesis.tex", "text");
  expect_refusals(
      "ishigami_lab sweep exp/study.toml --out exp",
      {{"",
        "HERE/exp/study.toml: was not left by a study: the study's folder must be another (--out)"},
       {" --rerun",
        "HERE/exp/study.toml: was not left by a study: the study's "
        "folder must be another (--out)"}});
  EXPECT_EQ(read("exp/thesis.tex"), "text");
}

TEST_F(Sweep, AFailureStopsSeparateProcessesToo) {
  const ProgramResult stopped = sweep(
      "ishigami --vary x.first=lin(0,3,300) --set trouble.fails_above=0.5 --set "
      "trouble.takes_s=0.01 --isolate --jobs 2 --on-failure stop --out s");
  EXPECT_EQ(stopped.status, 3) << stopped.err;
  EXPECT_TRUE(has(stopped.err, "x_1 is too large"));
  EXPECT_LT(results("s").size(), 200U);
}

TEST_F(Sweep, ACrashHasTheKeyOfItsPoint) {
  const std::string run_of = "ishigami --set x.first=3 --set trouble.crashes_above=2 ";
  swept(run_of + "--isolate --out s");
  const std::string config = ran("ishigami_lab run " + run_of + "--print-config").out;
  EXPECT_EQ(results("s").at(1).at(0), point_key(config, {}));
}

TEST_F(Sweep, ACrashBeforeAnyPointIsNoResult) {
  ProgramResult crashed;
  {
    const testing::Environment broken("ISHIGAMI_TASKS_CRASH", "1");
    crashed = sweep("ishigami --vary x.first=1,2 --isolate --jobs 1 --out s");
  }
  EXPECT_EQ(crashed.status, 2);
  EXPECT_EQ(crashed.err, "--isolate: a process of the study ended with signal 6 (Aborted)\n");
  EXPECT_TRUE(has(sweep("s --status").out, "0 of 2 points are done"));
}

TEST_F(Sweep, APointOfAnotherProcessIsNotTheCrashedOne) {
  ReadProgram study(
      {(testing::bin_folder() / "../tests/ishigami_lab").string(), "sweep", "ishigami", "--vary",
       "x.first=lin(-3,3,64)", "--set", "trouble.crashes_above=2", "--set", "trouble.takes_s=0.04",
       "--isolate", "--jobs", "1", "--out", (folder_ / "s").string()},
      true);
  wait_for_a_result();
  swept("s --points 50-52");
  while (study.next()) continue;
  EXPECT_EQ(study.wait(), 0);
  std::map<std::string, int> crashes;  // by number of the point
  for (const auto& entry : fs::directory_iterator(folder_ / "s/shards")) {
    std::istringstream shard(testing::text_of(entry.path()));
    for (std::string line; std::getline(shard, line);) {
      std::istringstream words(line);
      std::string checksum, kind, number, key, status;
      words >> checksum >> kind >> number;
      if (kind == "asked") words >> number;  // behind the hash of what was asked
      words >> key >> status;
      if (status == "crashed") ++crashes[number];
    }
  }
  ASSERT_EQ(crashes.size(), 11U);
  EXPECT_EQ(crashes.begin()->first, "53");
}

TEST_F(Sweep, TwoProcessesWithTheSamePointsBothSucceed) {
  swept("ishigami --vary x.first=lin(0,1,24) --set trouble.takes_s=0.03 --print-tasks --out s");
  ReadProgram first({(testing::bin_folder() / "../tests/ishigami_lab").string(), "sweep",
                     (folder_ / "s").string(), "--points", "0-23", "--isolate", "--jobs", "1"},
                    true);
  swept("s --points 0-23 --isolate --jobs 1");
  while (first.next()) continue;
  EXPECT_EQ(first.wait(), 0);
}

TEST_F(Sweep, APointKilledFromOutsideStaysUndone) {
  const std::string study =
      "ishigami --vary x.first=lin(0,3,31) --set trouble.killed_above=2.85 --isolate --out s";
  const ProgramResult killed = sweep(study);
  EXPECT_EQ(killed.status, 2);
  EXPECT_TRUE(has(killed.err, "is left undone: its process was ended by signal 9",
                  "s: 2 runs were left undone: the same command goes on\n"));
  EXPECT_EQ(results("s").size(), 30U);
  EXPECT_EQ(sweep(study).status, 2);
  // A scheduler's task too, except where its points are done.
  const ProgramResult task = sweep("s --isolate --points 20-30");
  EXPECT_EQ(task.status, 2);
  EXPECT_TRUE(has(task.err, "s: 2 runs were left undone"));
  swept("s --isolate --points 0-28");
}

TEST_F(Sweep, AnElementOfAnArrayIsAKey) {
  const std::string study = "breakwater sweep arm_wall_contact --duration 0.005 --out ";
  ran(study +
      "elements --vary controller.t_ref_s[3]=0.7,0.9 --vary "
      "observer.poles_rad_s[2][1]=-41,-51");
  ran(study +
      "arrays --vary controller.t_ref_s=[1,1,0.7],[1,1,0.9] --vary "
      "observer.poles_rad_s=[[-40,-43,-46],[-41,-44,-47],[-42,-45,-48]],"
      "[[-40,-43,-46],[-51,-44,-47],[-42,-45,-48]]");
  const auto elements = results("elements");
  EXPECT_EQ(elements[0][3], "controller.t_ref_s[3]");
  EXPECT_EQ(elements[0][4], "observer.poles_rad_s[2][1]");
  ASSERT_EQ(elements.size(), 5U);
  EXPECT_EQ(elements[3][3], "0.9");
  EXPECT_EQ(elements[3][4], "-41");
  // The points have the same keys and so the same runs, in the same order.
  for (std::size_t i = 1; i < elements.size(); ++i) {
    EXPECT_TRUE(lines("arrays/results.csv")[i].starts_with(elements[i][0] + ","));
    EXPECT_TRUE(has(lines("arrays/results.csv")[i], "," + elements[i][6]));
  }
  // The file in the folder gives the same study, and so does a study file in this spelling.
  ran("breakwater sweep elements --quiet");
  EXPECT_TRUE(has(read("elements/study.toml"), "\"controller.t_ref_s[3]\" = [0.7, 0.9]\n"));

  expect_refusals(
      study + "refused --vary ",
      {{"controller.t_ref_s[4]=1,2",
        "--vary: controller.t_ref_s[4]: controller.t_ref_s has 3 elements"},
       {"wall.distance_m[1]=1,2", "--vary: wall.distance_m[1]: wall.distance_m is no array"},
       {"controller.t_ref_s[1]=1,-2", "--vary: controller.t_ref_s[1]: must be positive, is -2"},
       {"controller.t_ref_s=[1,1,1],[1,-2,1]",
        "--vary: controller.t_ref_s[2]: must be positive, is -2"},
       {"controller.t_ref_s[1]=1,2 --set controller.t_ref_s=[1,1,1]",
        "--vary: controller.t_ref_s[1]: controller.t_ref_s is given too: give the array, or "
        "elements of it"}});
  EXPECT_EQ(run(study + "vain --case hpfc-2N --vary controller.t_ref_s[1]=1,2").err,
            "sweep: warning: --vary: controller.t_ref_s[1]: has an effect only where "
            "controller.name is proposed or tlsc or energy_admittance or impact_qp or "
            "contact_mpc\n");
}

// A study's file is edited in its folder, or shards are copied from another study.
TEST_F(Sweep, ARowHasTheResultsOfItsOwnRun) {
  const auto same_as_new = [&](const std::string& study, const std::string& words,
                               bool is_new = true) {
    const ProgramResult result = swept(study);
    EXPECT_EQ(has(result.err, "sweep: warning: ", ".shard: ", "of other runs than this study"),
              is_new);
    fs::remove_all(folder_ / "new");
    swept("ishigami --case noisy " + words + " --out new");
    EXPECT_EQ(read(study + "/results.csv"), read("new/results.csv")) << words;
    EXPECT_EQ(swept(study).err, "");
  };
  swept("ishigami --case noisy --vary x.first=1,2 --seeds 1..3 --out s");
  write("s/study.toml", testing::replaced(read("s/study.toml"), "[1, 2]", "[5, 6]"));
  EXPECT_TRUE(has(sweep("s --status").out, "0 of 6 points are done"));
  same_as_new("s", "--vary x.first=5,6 --seeds 1..3");
  write("s/study.toml", testing::replaced(read("s/study.toml"), "count = 3", "count = 4"));
  same_as_new("s", "--vary x.first=5,6 --seeds 1..4");
  write("s/study.toml", testing::replaced(read("s/study.toml"), "count = 4", "count = 1"));
  same_as_new("s", "--vary x.first=5,6 --seeds 1", false);  // all are there

  swept("ishigami --case noisy --vary x.first=7,8 --out t");
  fs::remove_all(folder_ / "s/shards");
  fs::copy(folder_ / "t/shards", folder_ / "s/shards");
  same_as_new("s", "--vary x.first=5,6 --seeds 1");
}

TEST_F(Sweep, AReplayEqualsTheRunOrReportsADifference) {
  swept("ishigami --vary x.first=1,2 --out s");
  const std::string key = results("s").at(1).at(0);
  swept("s --replay " + key.substr(0, 8));
  EXPECT_TRUE(fs::exists(folder_ / "s/runs" / key / "log.h5"));
  // Simulates a result from another machine.
  PointResult other = ShardIndex(folder_ / "s/shards", 2).read(0);
  fs::remove_all(folder_ / "s/shards");
  fs::create_directory(folder_ / "s/shards");
  other.state_hash = "0123456789abcdef";
  Shard(folder_ / "s/shards").add(other);
  const ProgramResult differs = sweep("s --replay " + key);
  EXPECT_EQ(differs.status, 3);
  EXPECT_TRUE(has(differs.err, "is not the run of results.csv"));
}

TEST_F(Sweep, AReplayOfARefusedPointHasNoFolder) {
  ran("breakwater sweep motor_estimation --vary metrics.from_s=0.1,0.5 --vary "
      "metrics.to_s=1.0,0.3 --duration 0.01 --out s");
  std::string key;
  for (const auto& row : results("s")) {
    if (std::find(row.begin(), row.end(), "refused") != row.end()) key = row[0];
  }
  ASSERT_FALSE(key.empty());
  const ProgramResult replayed = run("breakwater sweep s --replay " + key);
  EXPECT_EQ(replayed.status, 3);
  EXPECT_EQ(replayed.out, "");
  EXPECT_TRUE(has(replayed.err, "is refused, and has no folder"));
}

TEST_F(Sweep, ASeedIsExact) {
  swept("ishigami --set run.seed=9007199254740993 --sqlite --out s");
  EXPECT_EQ(results("s").at(1).at(2), "9007199254740993");
  write("look.py",
        "import sqlite3\nprint(sqlite3.connect('s/results.sqlite').execute("
        "'SELECT seed FROM results').fetchone()[0])\n");
  EXPECT_EQ(run("/usr/bin/python3 look.py").out, "9007199254740993\n");
}

TEST_F(Sweep, BlanksAroundValuesAreIgnored) {
  for (const std::string seeds : {"1, 2", "1 .. 2", " 1..2 "}) {
    swept("ishigami --case 'plain, noisy' --vary 'x.first= 1 , 2' --seeds '" + seeds + "' --out s");
    EXPECT_EQ(results("s").size(), 9U);
  }
  ran("breakwater sweep motor_estimation --vary 'observer.name=idob, stf' --duration 0.01 "
      "--out words");
  EXPECT_EQ(results("words").size(), 3U);
}

TEST_F(Sweep, ADryRunOfOneRunReportsIt) {
  const ProgramResult result = sweep("ishigami --dry-run");
  EXPECT_TRUE(result.out.starts_with("1 run: 1 sample, 1 seed, 1 candidate\n")) << result.out;
}

// 100 000 points with different lengths, whose mean is 2 (first: 0.5, mean: 1).
TEST_F(Sweep, ADryRunDoesNotLookAtEveryPoint) {
  const ProgramResult result = sweep(
      "ishigami --vary x.first=lin(0,1,100) --vary run.duration_s=lin(0.5,1.5,1000) --set "
      "trouble.takes_s=0.36 --jobs 2 --dry-run");
  EXPECT_TRUE(has(result.out, "about 10."));  // slightly more than 10 h
  EXPECT_LT(result.seconds, 20.0);
}

TEST_F(Sweep, TheRemainingTimeIsEstimatedPerCandidate) {
  swept("ishigami --case plain,noisy --vary x.first=1,2 --out s");
  const fs::path shards = folder_ / "s/shards";
  std::vector<PointResult> points;
  for (std::size_t i = 0; i < 3; ++i) points.push_back(ShardIndex(shards, 4).read(i));
  fs::remove_all(shards);
  fs::create_directory(shards);
  for (PointResult& point : points) {
    point.cost_s = point.number % 2 == 0 ? 1.0 : 50.0;
    Shard(shards).add(point);
  }
  EXPECT_TRUE(has(sweep("s --status").out, "50.0 s of processor time to go"));
  // One candidate has not begun, and one point of the other ran twice.
  fs::remove_all(shards);
  fs::create_directory(shards);
  for (const std::size_t i : {0, 0, 2}) Shard(shards).add(points.at(i));
  EXPECT_TRUE(has(sweep("s --status").out, "2.0 s of processor time to go"));
}

TEST_F(Sweep, UnreadableSubmissionsAreNotIgnored) {
  fs::create_directory(folder_ / "s");
  write("s/slurm", "no folder");
  EXPECT_THROW(queued(StudyFolder(folder_ / "s", kSweep), 1), std::invalid_argument);
}

TEST_F(Sweep, TwoStudiesCannotBeginInOneFolder) {
  const ScenarioFile file(testing::source_file("tests/study/ishigami/ishigami.toml"), "ishigami");
  const StudyFolder study(folder_ / "s", kSweep);
  study.make("a = 1\n", file);
  EXPECT_TRUE(has(read("s/study.toml"), file_hash(file.file())));
  EXPECT_NO_THROW(study.make("a = 1\n", file));  // as another process at the same time
  EXPECT_NO_THROW(study.make("a = 1\n\n[slurm]\naccount = \"mine\"\n", file));
  EXPECT_THROW(study.make("a = 2\n", file), std::invalid_argument);
  study.make_anew("a = 2\n", file);
  EXPECT_TRUE(has(read("s/study.toml"), "a = 2\n"));
}

TEST_F(Sweep, WarnsOfTwoSweepsOfOneStudy) {
  const std::vector<std::string> study = {
      (testing::bin_folder() / "../tests/ishigami_lab").string(),
      "sweep",
      "ishigami",
      "--vary",
      "x.first=lin(0,1,400)",
      "--set",
      "trouble.takes_s=0.1",
      "--jobs",
      "1",
      "--out",
      (folder_ / "s").string()};
  ReadProgram first(study, true);
  wait_for_a_result();
  ReadProgram second(study, true);
  std::string said;
  while (said.find("points may be run twice") == std::string::npos) {
    const auto line = second.next();
    if (!line) break;
    said += *line + "\n";
  }
  EXPECT_TRUE(has(said, "is at this study too"));
  for (ReadProgram* program : {&first, &second}) {
    program->interrupt();
    while (program->next()) continue;
  }
}

// Each process runs one point, so it alone would not notice the change.
TEST_F(Sweep, AModelThatChangesBetweenProcessesEndsTheStudy) {
  fs::copy_file(testing::source_file("models/motor.xml"), folder_ / "own.xml");
  ReadProgram study(
      {(testing::bin_folder() / "breakwater").string(), "sweep", "motor_estimation", "--set",
       "model.mjcf=" + (folder_ / "own.xml").string(), "--seeds", "1..7", "--duration", "0.01",
       "--isolate", "--jobs", "1", "--out", (folder_ / "s").string()},
      true);
  wait_for_a_result();
  std::ofstream(folder_ / "own.xml", std::ios::app) << "<!-- changed -->\n";
  std::string said;
  while (const auto line = study.next()) said += *line + "\n";
  EXPECT_EQ(WEXITSTATUS(study.wait()), 2);
  EXPECT_TRUE(has(said, "own.xml has changed since"));
  EXPECT_FALSE(fs::exists(folder_ / "s/results.csv"));
  // The results have none of the other version.
  fs::copy_file(testing::source_file("models/motor.xml"), folder_ / "own.xml",
                fs::copy_options::overwrite_existing);
  ran("breakwater sweep s");
  EXPECT_EQ(results("s").size(), 8U);
}

TEST_F(Sweep, AStudyDoesNotContinueWithChangedModels) {
  fs::copy_file(testing::source_file("models/motor.xml"), folder_ / "own.xml");
  const std::string study =
      "breakwater sweep motor_estimation --set model.mjcf=own.xml --seeds 1..2 --duration 0.01 "
      "--out s";
  ran(study);
  std::ofstream(folder_ / "own.xml", std::ios::app) << "<!-- changed -->\n";
  expect_refused(study,
                 "HERE/s: HERE/own.xml has changed since: go on with what it was begun with, or "
                 "begin anew with --rerun");
  // Shards of both versions, of nodes that do not see the same file, say.
  ModelHashes models = ShardIndex(folder_ / "s/shards", 2).models();
  models.begin()->second = "0123456789abcdef";
  Shard(folder_ / "s/shards").add(models);
  expect_refused(study,
                 "HERE/s/shards: some results are of another version of HERE/own.xml than others: "
                 "begin anew with --rerun");
  expect_refused("breakwater sweep s --collect",
                 "HERE/s/shards: some results are of another version of HERE/own.xml than others: "
                 "begin anew with --rerun");
}

}  // namespace
}  // namespace breakwater
