#include <csignal>

#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>
#include "study/sweep_folder.h"

namespace breakwater::sweep_test {
namespace fs = std::filesystem;
using testing::ProgramResult;

class Sweep : public testing::SweepFolder {};

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

TEST_F(Sweep, WorkersProcessesAndKillsDoNotChangeTheResults) {
  const std::string study =
      "ishigami --vary x.first=lin(-3,3,12) --vary x.second=lin(-3,3,12) --case plain,noisy "
      "--set trouble.fails_above=2 --set trouble.takes_s=0.002 --out ";
  swept(study + "by-one --jobs 1");
  swept(study + "three --jobs 3");
  swept(study + "apart --isolate");
  run_and_kill(study + "elsewhere/killed --jobs 2", 8, 0.3, 2);
  // All differences of the pages are in one place.
  const auto without_machine = [&](const std::string& folder) {
    std::string page = read(folder + "/report.html");
    const std::size_t begin = page.find("<!-- this machine"), end = page.find("<!-- end of this");
    EXPECT_LT(begin, end);
    EXPECT_TRUE(has(page.substr(begin, end - begin), folder));
    page.erase(begin, end - begin);
    EXPECT_TRUE(lacks(page, folder));
    return page;
  };
  for (const char* other : {"three", "apart", "elsewhere/killed"}) {
    EXPECT_EQ(read("by-one/results.csv"), read(std::string(other) + "/results.csv")) << other;
    EXPECT_EQ(without_machine("by-one"), without_machine(other));
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

TEST_F(Sweep, ACrashHasTheKeyOfItsPoint) {
  const std::string run_of = "ishigami --set x.first=3 --set trouble.crashes_above=2 ";
  swept(run_of + "--isolate --out s");
  const std::string config = ran("ishigami_lab run " + run_of + "--print-config").out;
  EXPECT_EQ(results("s").at(1).at(0), point_key(config, {}));
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

}  // namespace breakwater::sweep_test
