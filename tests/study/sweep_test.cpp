#include <csignal>

#include <breakwater/record/file_hash.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>
#include "cli/program.h"

namespace breakwater::sweep_test {
namespace fs = std::filesystem;
using testing::ProgramResult;

class Sweep : public testing::ProgramTest {
 protected:
  // `sweep` of the Ishigami function's program.
  ProgramResult sweep(const std::string& words, const testing::Moment& when = nullptr,
                      int signal = 0) const {
    return run("ishigami_lab sweep " + words, when, signal);
  }
  // The same, but it must succeed.
  ProgramResult swept(const std::string& words) const { return done(sweep(words)); }

  // The key of the first point of the study s.
  std::string first_key() const {
    const std::string row = lines("s/results.csv").at(1);
    return row.substr(0, row.find(','));
  }

  // Runs a study and kills it `kills` times at random moments, then completes it.
  void run_and_kill(const std::string& words, int kills, double longest_s, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> moment(0.0, longest_s);
    for (int i = 0; i < kills; ++i) sweep(words, testing::worked_for(moment(random)), SIGKILL);
    swept(words);
  }
};

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

TEST_F(Sweep, WorkersAndKillsDoNotChangeATuning) {
  const std::string tuning =
      "tune " + testing::source_file("tests/search/tuning.toml") + " --quiet --jobs ";
  const auto tune = [&](const std::string& words, const testing::Moment& when = nullptr) {
    return run("ishigami_lab " + words, when, SIGKILL);
  };
  const auto expect_same = [&](const std::string& other) {
    for (const char* file : {"/results.csv", "/front.csv", "/report.html", "/front/1.toml"}) {
      EXPECT_NE(read("one" + std::string(file)), "") << file;
      EXPECT_EQ(read("one" + std::string(file)), read(other + file)) << file;
    }
  };
  done(tune(tuning + "1 --out one"));
  done(tune(tuning + "2 --out two"));
  expect_same("two");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> moment(0.005, 0.3);
  for (int i = 0; i < 20; ++i) {
    tune(tuning + (i % 2 == 0 ? "1" : "2") + " --out killed", testing::worked_for(moment(random)));
  }
  done(tune(tuning + "2 --out killed"));
  expect_same("killed");
  // The folder's name alone also works. All runs are done, so nothing runs.
  done(tune("tune killed"));
  expect_same("killed");
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
    EXPECT_EQ(lines_of_points() + 1, lines("s/results.csv").size())
        << "only new points run: " << after;
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
  EXPECT_EQ(first_key(), point_key(config, {}));
}

TEST_F(Sweep, AReplayEqualsTheRunOrReportsADifference) {
  swept("ishigami --vary x.first=1,2 --out s");
  const std::string key = first_key();
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

}  // namespace breakwater::sweep_test
