// `breakwater sweep` as users meet it.
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <thread>

#include <breakwater/cluster/slurm_queue.h>
#include <breakwater/experiment/provenance.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/statistics/sensitivity.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_folder.h>
#include "study/sweep_folder.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;
using testing::ProgramResult;

class Sweep : public testing::SweepFolder {
 protected:
  // Whether the study s has a result; not if it takes too long.
  bool wait_for_a_result() const {
    const fs::path shards = folder_ / "s/shards";
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < std::chrono::seconds(60)) {
      if (!results_by_key(shards).empty()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  void expect_refused(const ProgramResult& result, const std::string& message) {
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
  }
};

TEST_F(Sweep, AGridIsOneRowARunInOrder) {
  const ProgramResult result =
      sweep({"ishigami", "--case", "plain,noisy", "--vary", "x.first=0.1,0.2", "--vary",
             "x.second=lin(-1,1,3)", "--seeds", "1..2", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 1U + 2 * 3 * 2 * 2);
  EXPECT_EQ(rows[0],
            (std::vector<std::string>{"point", "case", "seed", "x.first", "x.second", "status",
                                      "state_hash", "y_1", "positive_x_second_1"}));
  EXPECT_EQ(rows[1][1] + rows[1][2] + " " + rows[1][3] + " " + rows[1][4], "plain1 0.1 -1");
  EXPECT_EQ(rows[2][1] + rows[2][2] + " " + rows[2][3] + " " + rows[2][4], "noisy1 0.1 -1");
  EXPECT_EQ(rows[3][1] + rows[3][2] + " " + rows[3][3] + " " + rows[3][4], "plain2 0.1 -1");
  EXPECT_EQ(rows[5][1] + rows[5][2] + " " + rows[5][3] + " " + rows[5][4], "plain1 0.1 0");
  EXPECT_EQ(rows[24][1] + rows[24][2] + " " + rows[24][3] + " " + rows[24][4], "noisy2 0.2 1");
  std::set<std::string> keys;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    keys.insert(rows[i][0]);
    EXPECT_EQ(rows[i][5], "complete");
    const double y = std::sin(std::stod(rows[i][3])) +
                     7 * std::pow(std::sin(std::stod(rows[i][4])), 2) +
                     0.1 * std::pow(0.5, 4) * std::sin(std::stod(rows[i][3])) +
                     (rows[i][1] == "noisy" ? 0.1 * std::sin(std::stod(rows[i][2])) : 0.0);
    EXPECT_EQ(std::stod(rows[i][7]), y);  // 17 digits are all of it
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
  ASSERT_EQ(sweep({"study.toml", "--out", "a"}).status, 0);
  ASSERT_EQ(sweep({"ishigami", "--method", "sobol", "--samples", "8", "--seeds", "3..4", "--set",
                   "x.third=0.25", "--vary", "x.first=uniform(-1,1)", "--vary",
                   "x.second=normal(0.5,0.1)", "--case", "plain,noisy", "--baseline", "plain",
                   "--out", "b"})
                .status,
            0);
  EXPECT_EQ(read("a/results.csv"), read("b/results.csv"));
  EXPECT_EQ(results("a").size(), 33U);
  // An option comes before the file, however that writes its key.
  ASSERT_EQ(sweep({"study.toml", "--vary", "x.first=uniform(5,6)", "--set", "x.third=0.5",
                   "--baseline", "noisy", "--out", "d"})
                .status,
            0);
  const auto rows = results("d");
  ASSERT_EQ(rows.size(), 33U);
  const auto first = static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), "x.first") -
                                              rows[0].begin());
  EXPECT_GE(std::stod(rows[1][first]), 5.0);
  // The study that it left is a study file too.
  ASSERT_EQ(sweep({"a/study.toml", "--out", "c"}).status, 0);
  EXPECT_EQ(read("a/results.csv"), read("c/results.csv"));
}

TEST_F(Sweep, WorkersProcessesAndKillsChangeNoByte) {
  const std::vector<std::string> study = {"ishigami",
                                          "--vary",
                                          "x.first=lin(-3,3,12)",
                                          "--vary",
                                          "x.second=lin(-3,3,12)",
                                          "--set",
                                          "trouble.fails_above=2",
                                          "--set",
                                          "trouble.takes_s=0.002"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), study.begin(), study.end());
    return more;
  };
  ASSERT_EQ(sweep(with({"--out", "one", "--jobs", "1"})).status, 0);
  ASSERT_EQ(sweep(with({"--out", "three", "--jobs", "3"})).status, 0);
  EXPECT_EQ(read("one/results.csv"), read("three/results.csv"));
  ASSERT_EQ(sweep(with({"--out", "apart", "--isolate"})).status, 0);
  EXPECT_EQ(read("one/results.csv"), read("apart/results.csv"));
  run_and_kill(with({"--out", "killed", "--jobs", "2"}), 8, 0.15, 2);
  EXPECT_EQ(read("one/results.csv"), read("killed/results.csv"));
}

TEST_F(Sweep, ATornOrDamagedLineIsRunAgain) {
  const std::vector<std::string> study = {"ishigami", "--vary", "x.first=lin(0,1,20)", "--out", "s",
                                          "--jobs",   "1"};
  ASSERT_EQ(sweep(study).status, 0);
  const std::string whole = read("s/results.csv");
  fs::path shard;
  for (const auto& entry : fs::directory_iterator(folder_ / "s/shards")) shard = entry.path();
  const std::string text = testing::text_of(shard);
  std::string damaged = text.substr(0, text.size() - 7);      // the last line is torn
  damaged[damaged.find('\n', damaged.size() / 2) + 20] ^= 1;  // and one is not its own
  std::ofstream(shard, std::ios::binary) << damaged;
  const ProgramResult status = sweep({"s", "--status"});
  EXPECT_NE(status.out.find("18 of 20 points are done"), std::string::npos) << status.out;
  ASSERT_EQ(sweep(study).status, 0);
  EXPECT_EQ(read("s/results.csv"), whole);
}

TEST_F(Sweep, APointIsTheRunOfItsConfiguration) {
  ASSERT_EQ(run({"breakwater", "sweep", "motor_estimation", "--case", "idob", "--vary",
                 "encoder.bits=6,8", "--seeds", "2..3", "--duration", "0.2", "--out", "s"})
                .status,
            0);
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 5U);
  const auto& row = rows[3];  // 8 bits, seed 2
  ASSERT_EQ(run({"motor_estimation", "--case", "idob", "--set", "encoder.bits=8", "--seed", "2",
                 "--duration", "0.2", "--out", "alone", "--quiet"})
                .status,
            0);
  const auto alone = nlohmann::json::parse(read("alone/manifest.json"));
  EXPECT_EQ(alone["point"], row[0]);
  EXPECT_EQ(alone["state_hash"], row[5]);
  ASSERT_EQ(run({"breakwater", "sweep", "s", "--replay", row[0]}).status, 0);
  const std::string replayed = "s/runs/" + row[0];
  EXPECT_EQ(nlohmann::json::parse(read(replayed + "/manifest.json"))["state_hash"], row[5]);
  EXPECT_EQ(read(replayed + "/config.toml"), read("alone/config.toml"));
  EXPECT_EQ(read(replayed + "/metrics.json"), read("alone/metrics.json"));
  EXPECT_EQ(read(replayed + "/log.h5"), read("alone/log.h5"));
  expect_refused(run({"breakwater", "sweep", "s", "--replay", "0123456789abcdef"}), "no point of");
}

// `./dev tsan` watches it.
TEST_F(Sweep, ThreadsShareModelsAndTheShard) {
  for (const char* jobs : {"1", "4"}) {
    ASSERT_EQ(run({"breakwater", "sweep", "motor_estimation", "--case", "idob,stf", "--vary",
                   "encoder.bits=6,8", "--seeds", "1..3", "--duration", "0.05", "--jobs", jobs,
                   "--keep", "failed", "--out", jobs})
                  .status,
              0);
  }
  EXPECT_EQ(read("1/results.csv"), read("4/results.csv"));
}

TEST_F(Sweep, KeepsTheFoldersThatItIsToldTo) {
  const std::vector<std::string> study = {"ishigami", "--vary", "x.first=0,1,3", "--set",
                                          "trouble.fails_above=2"};
  for (const auto& [keep, count] :
       std::map<std::string, std::size_t>{{"metrics", 0}, {"failed", 1}, {"all", 3}}) {
    std::vector<std::string> arguments = study;
    arguments.insert(arguments.end(), {"--keep", keep, "--out", keep});
    ASSERT_EQ(sweep(arguments).status, 0);
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

TEST_F(Sweep, AFailureIsCountedOrStopsIt) {
  const std::vector<std::string> study = {
      "ishigami", "--vary", "x.first=lin(0,3,30)", "--set", "trouble.fails_above=1", "--jobs", "1"};
  std::vector<std::string> arguments = study;
  arguments.insert(arguments.end(), {"--out", "counted"});
  const ProgramResult counted = sweep(arguments);
  EXPECT_EQ(counted.status, 0);
  EXPECT_NE(counted.out.find("20 failed"), std::string::npos) << counted.out;
  EXPECT_EQ(results("counted").size(), 31U);
  EXPECT_EQ(results("counted").back()[4], "failed");
  EXPECT_EQ(results("counted").back()[6], "");  // no metric of it
  arguments = study;
  arguments.insert(arguments.end(), {"--out", "stopped", "--on-failure", "stop"});
  const ProgramResult stopped = sweep(arguments);
  EXPECT_EQ(stopped.status, 3);
  EXPECT_NE(stopped.err.find("failed: at 0.5 s: x_1 is too large"), std::string::npos)
      << stopped.err;
  EXPECT_EQ(results("stopped").size(), 12U);
}

TEST_F(Sweep, ACrashCostsOneRunInAProcessOfItsOwn) {
  const ProgramResult result = sweep({"ishigami", "--vary", "x.first=lin(0,3,31)", "--set",
                                      "trouble.crashes_above=2.85", "--isolate", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("2 crashed"), std::string::npos) << result.out;
  const auto rows = results("s");
  ASSERT_EQ(rows.size(), 32U);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][4], i < 30 ? "complete" : "crashed") << i;
  }
}

TEST_F(Sweep, SensitivityIndicesOfTheIshigamiFunctionAreTheClosedForm) {
  const double pi = std::numbers::pi;
  ASSERT_EQ(sweep({"ishigami", "--method", "saltelli", "--samples", "4096", "--vary",
                   "x.first=uniform(-3.141592653589793,3.141592653589793)", "--vary",
                   "x.second=uniform(-3.141592653589793,3.141592653589793)", "--vary",
                   "x.third=uniform(-3.141592653589793,3.141592653589793)", "--out", "s"})
                .status,
            0);
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
  EXPECT_NEAR(indices.first_order[0].value, v1 / v, 0.01);
  EXPECT_NEAR(indices.first_order[1].value, v2 / v, 0.01);
  EXPECT_NEAR(indices.first_order[2].value, 0.0, 0.01);
  EXPECT_NEAR(indices.total[0].value, (v1 + v13) / v, 0.01);
  EXPECT_NEAR(indices.total[1].value, v2 / v, 0.01);
  EXPECT_NEAR(indices.total[2].value, v13 / v, 0.01);
}

TEST_F(Sweep, CandidatesAreComparedInTheSameWorlds) {
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
  const ProgramResult result = sweep({"study.toml", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("no difference shown"), std::string::npos) << result.out;
  const auto cells = results("s", "comparison.csv");
  // A label has a comma, and so its quotes are cut in two: metric, goal, "case, key", ….
  ASSERT_EQ(cells.size(), 1U + 2 * 3 + 3 + 2 * 4);
  EXPECT_EQ(cells[1][0] + cells[1][1], "y_1min");
  // x.third = 1.5 adds 0.1 (1.5⁴ − 0.5⁴) sin x₁ in each world, which its seeds leave as it is.
  EXPECT_EQ(cells[1][2] + cells[1][3], "\"plain x.third = 1.5\"");
  EXPECT_EQ(cells[1][6], "24");   // pairs
  EXPECT_EQ(cells[1][27], "12");  // blocks
  EXPECT_NEAR(std::stod(cells[1][13]), 0.5 * std::sin(0.5), 1e-12);
  EXPECT_EQ(std::stod(cells[1][16]), std::ldexp(1.0, -11));
  EXPECT_EQ(cells[1].at(20), "worse");
  // Case noisy: the shift of seed 1 and of seed 2.
  EXPECT_NEAR(std::stod(cells[2][13]), 0.05 * (std::sin(1.0) + std::sin(2.0)), 1e-12);
  // A metric without a goal; all candidates have the same.
  EXPECT_EQ(cells[4][0] + cells[4][1], "positive_x_second_1");
  EXPECT_EQ(cells[4].at(20), "no difference shown");
  EXPECT_EQ(cells[7][0], "failure");
  // The same bytes again, and of another number of workers.
  const std::string bytes = read("s/comparison.csv");
  ASSERT_EQ(sweep({"study.toml", "--out", "t", "--jobs", "1"}).status, 0);
  EXPECT_EQ(read("t/comparison.csv"), bytes);
  // A study of one candidate compares nothing; seeds are no worlds of their own.
  ASSERT_EQ(sweep({"ishigami", "--case", "plain", "--seeds", "1..9", "--vary", "x.second=1,2",
                   "--metrics", "y_1", "--goal", "y_1=max", "--out", "u"})
                .status,
            0);
  EXPECT_FALSE(fs::exists(folder_ / "u/comparison.csv"));  // one candidate
  write("deep.toml",
        "scenario = \"ishigami\"\nseeds = [1, 2, 3]\n[vary]\n\"x.second\" = [1, 2]\n"
        "[compare]\n\"x.third\" = [0, 1]\nmetrics = [\"y_1\"]\ngoal.unheard_of = \"max\"\n");
  const ProgramResult deep = sweep({"deep.toml", "--out", "v"});
  EXPECT_EQ(deep.status, 0);
  EXPECT_EQ(deep.err, "sweep: compare.goal.unheard_of: no run has it\n");
  EXPECT_EQ(results("v", "comparison.csv").at(1).at(25), "2");  // blocks
}

// Five walls and five seeds: x.third = 1.5 is worse in all 25 pairs, and yet in five worlds alone.
TEST_F(Sweep, SeedsRepeatWhatTheVariedKeysMake) {
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
  const ProgramResult few = sweep({"study.toml", "--out", "few"});
  ASSERT_EQ(few.status, 0) << few.err;
  EXPECT_NE(few.out.find("too few blocks"), std::string::npos) << few.out;
  EXPECT_NE(few.out.find("of 5 the least two-sided p is 0.0625"), std::string::npos) << few.out;
  auto cells = results("few", "comparison.csv");
  EXPECT_EQ(cells[1].at(18) + cells[1].at(25) + cells[1].at(14), "too few blocks50.0625");
  const std::string page = read("few/report.html");
  EXPECT_NE(page.find(">too few blocks</b>"), std::string::npos);
  EXPECT_NE(page.find("Between: the share"), std::string::npos);
  // Each seed a world, where that is asked for. Both values of a key without effect are one.
  ASSERT_EQ(sweep({"study.toml", "--worlds", "seeds", "--out", "seeds"}).status, 0);
  cells = results("seeds", "comparison.csv");
  EXPECT_EQ(cells[1].at(18) + cells[1].at(25), "worse25");
  EXPECT_EQ(read("seeds/report.html").find("Between: the share"), std::string::npos);
  EXPECT_NE(read("seeds/study.toml").find("worlds = \"seeds\"\n"), std::string::npos);
  EXPECT_EQ(read("seeds/results.csv"), read("few/results.csv"));
  // Without a varied key seeds are what there is.
  write("seeds.toml", R"toml(
scenario = "ishigami"
case = "noisy"
seeds = { first = 1, count = 8 }
[compare]
"y.noise" = [0.1, 0.2]
metrics = ["y_1"]
)toml");
  ASSERT_EQ(sweep({"seeds.toml", "--out", "alone"}).status, 0);
  EXPECT_EQ(results("alone", "comparison.csv").at(1).at(25), "8");
  expect_refused(sweep({"study.toml", "--worlds", "sample", "--out", "no"}),
                 "--worlds: must be one of samples, seeds, is \"sample\" (did you mean "
                 "samples?)");
  expect_refused(sweep({"study.toml", "--goal", "y_1=min", "--goal", "y_1=max", "--out", "no"}),
                 "--goal: y_1: is given twice");
}

// x.third makes 0.1 x₃⁴ sin x₁ of y: its sign is that of x.first.
TEST_F(Sweep, ASignThatTurnsWithAVariedKeyIsSaid) {
  write("study.toml", R"toml(
scenario = "ishigami"
case = "noisy"
seeds = { first = 1, count = 5 }
[vary]
"x.first" = [-2, -1, -0.5, 1, 2.5]
[compare]
"x.third" = [0.5, 1.5]
baseline = "x.third = 0.5"
metrics = ["y_1"]
)toml");
  const ProgramResult result = sweep({"study.toml", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("† y_1, x.third = 1.5 beside x.third = 0.5: the sign turns with "
                            "x.first (p < 1e-15): -0.4546 at -2, -0.4207 at -1, "),
            std::string::npos)
      << result.out;
  const auto cells = results("s", "comparison_by_key.csv");
  ASSERT_EQ(cells.size(), 6U);
  EXPECT_EQ(cells[1].at(3) + cells[1].at(4), "x.first-2");
  EXPECT_NEAR(std::stod(cells[1].at(7)), 0.5 * std::sin(-2.0), 1e-12);
  EXPECT_EQ(cells[5].at(12), "yes");
  EXPECT_EQ(results("s", "comparison.csv").at(1).at(28), "x.first");
  const std::string page = read("s/report.html");
  EXPECT_NE(page.find("Its sign turns with x.first: x.third = 1.5 beside x.third = 0.5"),
            std::string::npos);
  EXPECT_NE(page.find("y_1, x.third = 1.5 less x.third = 0.5 over x.first"), std::string::npos);
  EXPECT_NE(page.find("its sign turns with x.first</span>"), std::string::npos);
}

TEST_F(Sweep, KeysVariedTogetherAreOneEffect) {
  const ProgramResult result = sweep({"ishigami", "--method", "list", "--vary", "x.first=1,2,3",
                                      "--vary", "x.third=0.1,0.3,0.2", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string said = "x.first (with x.third)";
  EXPECT_NE(result.out.find("vary: " + said + ": varied together"), std::string::npos)
      << result.out;
  const std::string page = read("s/report.html");
  EXPECT_NE(page.find("y_1 over " + said), std::string::npos);
  EXPECT_EQ(page.find("y_1 over x.third"), std::string::npos);
  EXPECT_NE(page.find(said + ": their effects cannot be told apart"), std::string::npos);
}

TEST_F(Sweep, ThePageOpensWithTheFirstMetricThatIsNamed) {
  int count = 0;
  const auto first = [&](const std::vector<std::string>& options) {
    const std::string out = std::to_string(++count);
    std::vector<std::string> words = {"ishigami", "--case", "plain,noisy", "--seeds", "1..6",
                                      "--out",    out};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(sweep(words).status, 0);
    const std::string page = read(out + "/report.html");
    const std::string begin = "id=\"metric-1\" class=\"metric\" data-name=\"";
    const std::size_t at = page.find(begin) + begin.size();
    return page.substr(at, page.find('"', at) - at);
  };
  EXPECT_EQ(first({}), "y_1");
  const std::string second = "positive_x_second_1";
  EXPECT_EQ(first({"--metrics", second}), second);
  EXPECT_EQ(first({"--goal", second + "=max"}), second);
  EXPECT_EQ(first({"--goal", "y_1=min", "--goal", second + "=max"}), "y_1");  // not by the alphabet
}

// All that differs stands in one place.
TEST_F(Sweep, AKilledStudyLeavesTheSamePage) {
  const std::vector<std::string> study = {"ishigami", "--vary",      "x.first=lin(-3,3,40)",
                                          "--case",   "plain,noisy", "--seeds",
                                          "1..3",     "--set",       "trouble.takes_s=0.003"};
  std::vector<std::string> whole = study, killed = study;
  whole.insert(whole.end(), {"--out", "whole", "--jobs", "1"});
  killed.insert(killed.end(), {"--out", "elsewhere/killed", "--jobs", "2"});
  ASSERT_EQ(sweep(whole).status, 0);
  run_and_kill(killed, 4, 0.6, 2);
  const auto without_machine = [&](const std::string& folder) {
    std::string page = read(folder + "/report.html");
    const std::size_t begin = page.find("<!-- this machine"), end = page.find("<!-- end of this");
    EXPECT_LT(begin, end);
    EXPECT_NE(page.substr(begin, end - begin).find(folder), std::string::npos);
    page.erase(begin, end - begin);
    EXPECT_EQ(page.find(folder), std::string::npos);
    return page;
  };
  EXPECT_EQ(without_machine("whole"), without_machine("elsewhere/killed"));
}

// A slip of the pen costs no study.
TEST_F(Sweep, AMisspeltMetricIsFoundByTheFirstRuns) {
  for (const auto& [option, value] : {std::pair{"--goal", "y_2=max"}, {"--metrics", "y_2"}}) {
    const ProgramResult result = sweep({"ishigami", "--case", "plain,noisy", "--seeds", "1..9",
                                        option, value, "--out", "misspelt"});
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("have no such metric (did you mean y_1?)"), std::string::npos)
        << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "misspelt"));
  }
}

TEST_F(Sweep, RowsOfFewerWorldsAreMarked) {
  write("study.toml", R"toml(
scenario = "ishigami"
[vary]
"x.first" = [0, 0.5, 2]
[compare]
"trouble.fails_above" = [10, 1, 9]
baseline = "trouble.fails_above = 10"
)toml");
  const ProgramResult result = sweep({"study.toml", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("2 *"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("3 *"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\n* of fewer blocks than 3: "), std::string::npos) << result.out;
}

TEST_F(Sweep, TasksOfAnySchedulerTogetherAreTheStudy) {
  const std::vector<std::string> study = {"ishigami", "--vary", "x.first=lin(0,1,25)"};
  std::vector<std::string> arguments = study;
  arguments.insert(arguments.end(), {"--out", "whole"});
  ASSERT_EQ(sweep(arguments).status, 0);
  arguments = study;
  arguments.insert(arguments.end(), {"--out", "tasks", "--print-tasks", "--tasks", "4"});
  const ProgramResult tasks = sweep(arguments);
  ASSERT_EQ(tasks.status, 0) << tasks.err;
  EXPECT_EQ(std::count(tasks.out.begin(), tasks.out.end(), '\n'), 4);
  write("tasks.sh", tasks.out);
  ASSERT_EQ(std::system(("sh -e " + (folder_ / "tasks.sh").string()).c_str()), 0);
  ASSERT_EQ(sweep({"tasks"}).status, 0);
  EXPECT_EQ(read("whole/results.csv"), read("tasks/results.csv"));
}

TEST_F(Sweep, ADryRunCountsAndLeavesNothing) {
  const ProgramResult result =
      sweep({"ishigami", "--vary", "x.first=lin(0,1,1000)", "--seeds", "1..10", "--set",
             "trouble.takes_s=0.01", "--jobs", "2", "--dry-run", "--out", "s"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("10000 runs: 1000 samples, 10 seeds, 1 candidate"), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("about 5"), std::string::npos) << result.out;  // 50 s and a little
  EXPECT_FALSE(fs::exists(folder_ / "s"));
}

TEST_F(Sweep, AnInterruptionSaysHowToGoOn) {
  const std::vector<std::string> study = {
      "ishigami", "--vary", "x.first=lin(0,1,200)", "--set", "trouble.takes_s=0.05", "--out", "s"};
  const ProgramResult result = sweep(study, 1.0, SIGINT);
  EXPECT_EQ(result.status, 130);
  EXPECT_NE(result.err.find("of 200 points are done; the same command goes on"), std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "s/results.csv"));
  ASSERT_EQ(sweep({"s", "--collect"}).status, 0);
  EXPECT_LT(results("s").size(), 201U);
}

TEST_F(Sweep, NonsenseIsOneLineAndStatus2) {
  const auto study = [&](const std::string& text) {
    write("bad.toml", "scenario = \"ishigami\"\n" + text);
    return sweep({"bad.toml", "--out", "s"});
  };
  const auto vary = [&](const std::string& text) { return study("[vary]\n" + text); };
  expect_refused(study("[objective]\ny_1 = { goal = \"min\" }\n"),
                 "bad.toml:2: objective: is of a tuning: breakwater tune");
  expect_refused(study("sample = 3\n"), "bad.toml:2: sample: unknown key (did you mean samples?)");
  expect_refused(vary("\"x.frist\" = [1]\n"),
                 "bad.toml:3: vary.x.frist: unknown key (did you mean x.first?)");
  expect_refused(vary("\"x.first\" = [1, \"two\"]\n"),
                 "bad.toml:3: vary.x.first: must be a number");
  expect_refused(vary("\"y.noise\" = [1, -1]\n"), "bad.toml:3: vary.y.noise: must");
  expect_refused(vary("\"x.first\" = []\n"), "bad.toml:3: vary.x.first: has no values");
  expect_refused(vary("\"x.first\" = \"lin(2,1,4)\"\n"), "bad.toml:3: vary.x.first: ");
  expect_refused(vary("\"x.first\" = \"log(0,1,4)\"\n"), "bad.toml:3: vary.x.first: ");
  expect_refused(
      study("method = \"lhs\"\nsamples = 4\n[vary]\n\"x.first\" = { uniform = [1, 0] }\n"),
      "bad.toml:5: vary.x.first: ");
  expect_refused(
      study("method = \"lhs\"\nsamples = 4\n[vary]\n\"x.first\" = { log_uniform = [0, 1] }\n"),
      "bad.toml:5: vary.x.first: ");
  expect_refused(vary("\"x.first\" = { uniform = [0, 1] }\n"), "needs a method that draws");
  expect_refused(vary("\"run.seed\" = [1, 2]\n"), "say seeds instead");
  expect_refused(study("[compare]\n\"run.seed\" = [1, 2]\n"), "say seeds instead");
  expect_refused(vary("\"x.first\" = [1, 2, 1]\n"), "a value is there twice");
  expect_refused(study("method = \"list\"\n[vary]\n\"x.first\" = [1, 2]\n\"x.second\" = [1]\n"),
                 "a list needs as many of each");
  expect_refused(study("method = \"sobol\"\n[vary]\n\"x.first\" = [1, 2]\n"),
                 "samples: is missing");
  expect_refused(study("seeds = { first = 1, cuont = 3 }\n"), "(did you mean count?)");
  expect_refused(study("seeds = [1, 1]\n"), "one is there twice");
  expect_refused(study("[compare]\ncase = [\"plain\", \"nosy\"]\n"), "(did you mean noisy?)");
  expect_refused(study("[compare]\ncase = [\"plain\", \"noisy\"]\nbaseline = \"other\"\n"),
                 "compare.baseline: \"other\" is not among what is compared");
  const std::string compare = "[compare]\ncase = [\"plain\", \"noisy\"]\n";
  expect_refused(
      study(compare + "goal = { y_1 = \"mni\" }\n"),
      "bad.toml:4: compare.goal.y_1: must be one of min, max, is \"mni\" (did you mean min?)");
  expect_refused(study(compare + "goal = \"min\"\n"), "goal: must be a table");
  expect_refused(study(compare + "metrics = []\n"), "bad.toml:4: compare.metrics: is empty");
  expect_refused(sweep({"ishigami", "--goal", "y_1=least"}),
                 "--goal: y_1: must be one of min, max");
  const std::string many = " = \"lin(0,1,10000)\"\n";
  expect_refused(vary("\"x.first\"" + many + "\"x.second\"" + many + "\"x.third\"" + many),
                 "1e+12 points are more than 10000000");
  expect_refused(sweep({"ishigami", "--vary", "x.first"}), "must be of the form KEY=VALUE");
  expect_refused(sweep({"ishigami", "--vary", "x.first=1,,2"}), "a value is missing");
  expect_refused(sweep({"ishigami", "--vary", "x.first=1", "--vary", "x.first=2"}),
                 "--vary: x.first: is given twice");
  expect_refused(sweep({"ishigami", "--vary", "x.first=1", "--set", "x.first=2"}),
                 "--vary: x.first: is set and varied");
  expect_refused(sweep({"ishigami", "--seeds", "5..1"}), "--seeds: 5..1: must be");
  expect_refused(sweep({"ishigam"}), "(did you mean ishigami?)");
  expect_refused(sweep({"nothing.toml"}), "there is no such file");
  EXPECT_FALSE(fs::exists(folder_ / "s"));
  EXPECT_FALSE(fs::exists(folder_ / "studies"));
}

TEST_F(Sweep, GoesOnWithNothingElse) {
  ASSERT_EQ(sweep({"ishigami", "--vary", "x.first=1,2", "--out", "s"}).status, 0);
  expect_refused(sweep({"ishigami", "--vary", "x.first=1,3", "--out", "s"}),
                 "holds another study: here it is `\"x.first\" = [1, 3]`");
  expect_refused(sweep({"s", "--vary", "x.first=1,3"}), "is a study's folder");
  // Another program: what it did not make itself it does not go on with.
  write("made_by.sh", "sed -i 's/^program = .*/program = \"0123456789abcdef\"/' s/study.toml");
  ASSERT_EQ(std::system(("cd " + folder_.string() + " && sh made_by.sh").c_str()), 0);
  expect_refused(sweep({"s"}), "its results are of another program");
  ASSERT_EQ(sweep({"s", "--rerun"}).status, 0);
  ASSERT_EQ(sweep({"s"}).status, 0);
  // Somebody's own folder.
  fs::create_directory(folder_ / "mine");
  write("mine/thesis.tex", "text");
  expect_refused(sweep({"ishigami", "--out", "mine"}), "holds something that is not a study");
  expect_refused(sweep({"mine"}), "has no study.toml");
  EXPECT_EQ(read("mine/thesis.tex"), "text");
}

TEST_F(Sweep, BeginsAnewWithoutAUsersOwnFiles) {
  const std::vector<std::string> study = {"ishigami", "--vary", "x.first=1,2", "--out", "s"};
  ASSERT_EQ(sweep(study).status, 0);
  write("s/notes.txt", "mine");
  ASSERT_EQ(sweep({"s", "--rerun"}).status, 0);
  EXPECT_EQ(read("s/notes.txt"), "mine");
  EXPECT_EQ(results("s").size(), 3U);
  EXPECT_EQ(sweep({"s", "--rerun", "--replay", results("s")[1][0]}).status, 2);
  EXPECT_EQ(results("s").size(), 3U);
  // A study file that lies where its author keeps other things is no study's folder.
  fs::create_directory(folder_ / "exp");
  write("exp/study.toml", "scenario = \"ishigami\"\ncase = \"plain\"\nseeds = [1]\n");
  write("exp/thesis.tex", "text");
  expect_refused(sweep({"exp/study.toml", "--out", "exp"}), "was not left by a study");
  expect_refused(sweep({"exp/study.toml", "--out", "exp", "--rerun"}), "was not left by a study");
  EXPECT_EQ(read("exp/thesis.tex"), "text");
}

TEST_F(Sweep, AFailureStopsProcessesOfTheirOwnToo) {
  const ProgramResult stopped = sweep(
      {"ishigami", "--vary", "x.first=lin(0,3,300)", "--set", "trouble.fails_above=0.5", "--set",
       "trouble.takes_s=0.01", "--isolate", "--jobs", "2", "--on-failure", "stop", "--out", "s"});
  EXPECT_EQ(stopped.status, 3) << stopped.err;
  EXPECT_NE(stopped.err.find("x_1 is too large"), std::string::npos) << stopped.err;
  EXPECT_LT(results("s").size(), 200U);
}

TEST_F(Sweep, ACrashHasThePointsOwnKey) {
  ASSERT_EQ(sweep({"ishigami", "--set", "x.first=3", "--set", "trouble.crashes_above=2",
                   "--isolate", "--out", "s"})
                .status,
            0);
  const ProgramResult config = run({ISHIGAMI_LAB, "run", "ishigami", "--set", "x.first=3", "--set",
                                    "trouble.crashes_above=2", "--print-config"});
  EXPECT_EQ(results("s").at(1).at(0), point_key(config.out, {}));
}

TEST_F(Sweep, APointThatIsKilledFromOutsideIsLeftUndone) {
  const std::vector<std::string> study = {"ishigami",
                                          "--vary",
                                          "x.first=lin(0,3,31)",
                                          "--set",
                                          "trouble.killed_above=2.85",
                                          "--isolate",
                                          "--out",
                                          "s"};
  const ProgramResult killed = sweep(study);
  EXPECT_EQ(killed.status, 2);
  EXPECT_NE(killed.err.find("is left undone: its process was ended by signal 9"), std::string::npos)
      << killed.err;
  EXPECT_NE(killed.err.find("29 of 31 points are done"), std::string::npos) << killed.err;
  EXPECT_EQ(results("s").size(), 30U);
  EXPECT_EQ(sweep(study).status, 2);
  // A scheduler's task too; not where its own points are done.
  const ProgramResult task = sweep({"s", "--isolate", "--points", "20-30"});
  EXPECT_EQ(task.status, 2);
  EXPECT_NE(task.err.find("the others were left undone"), std::string::npos) << task.err;
  EXPECT_EQ(sweep({"s", "--isolate", "--points", "0-28"}).status, 0);
}

TEST_F(Sweep, AnElementOfAnArrayIsAKey) {
  const auto swept = [&](const std::string& out, const std::vector<std::string>& options) {
    std::vector<std::string> words = {
        "breakwater", "sweep", "arm_wall_contact", "--duration", "0.005", "--out", out};
    words.insert(words.end(), options.begin(), options.end());
    return run(words);
  };
  ASSERT_EQ(swept("elements", {"--vary", "controller.t_ref_s[3]=0.7,0.9", "--vary",
                               "observer.poles_rad_s[2][1]=-41,-51"})
                .status,
            0);
  ASSERT_EQ(swept("arrays", {"--vary", "controller.t_ref_s=[1,1,0.7],[1,1,0.9]", "--vary",
                             "observer.poles_rad_s=[[-40,-43,-46],[-41,-44,-47],[-42,-45,-48]],"
                             "[[-40,-43,-46],[-51,-44,-47],[-42,-45,-48]]"})
                .status,
            0);
  const auto elements = results("elements");
  EXPECT_EQ(elements[0][3], "controller.t_ref_s[3]");
  EXPECT_EQ(elements[0][4], "observer.poles_rad_s[2][1]");
  ASSERT_EQ(elements.size(), 5U);
  EXPECT_EQ(elements[3][3], "0.9");
  EXPECT_EQ(elements[3][4], "-41");
  // Points of the same keys, and so the same runs, in the same order.
  for (std::size_t i = 1; i < elements.size(); ++i) {
    EXPECT_EQ(lines("arrays/results.csv")[i].find(elements[i][0] + ","), 0U);
    EXPECT_NE(lines("arrays/results.csv")[i].find("," + elements[i][6]), std::string::npos);
  }
  // The study's own file says the same, and a study file spells it likewise.
  EXPECT_EQ(run({"breakwater", "sweep", "elements", "--quiet"}).status, 0);
  EXPECT_NE(read("elements/study.toml").find("\"controller.t_ref_s[3]\" = [0.7, 0.9]\n"),
            std::string::npos);

  const auto refused = [&](const std::vector<std::string>& options, const std::string& message) {
    const ProgramResult result = swept("refused", options);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.err, message + "\n");
    EXPECT_FALSE(fs::exists(folder_ / "refused"));
  };
  refused({"--vary", "controller.t_ref_s[4]=1,2"},
          "--vary: controller.t_ref_s[4]: controller.t_ref_s has 3 elements");
  refused({"--vary", "wall.distance_m[1]=1,2"},
          "--vary: wall.distance_m[1]: wall.distance_m is no array");
  refused({"--vary", "controller.t_ref_s[1]=1,-2"},
          "--vary: controller.t_ref_s[1]: must be positive, is -2");
  refused({"--vary", "controller.t_ref_s=[1,1,1],[1,-2,1]"},
          "--vary: controller.t_ref_s[2]: must be positive, is -2");
  refused({"--vary", "controller.t_ref_s[1]=1,2", "--set", "controller.t_ref_s=[1,1,1]"},
          "--vary: controller.t_ref_s[1]: controller.t_ref_s is given too: give the array, or "
          "elements of it");
  EXPECT_EQ(swept("vain", {"--case", "hpfc-2N", "--vary", "controller.t_ref_s[1]=1,2"}).err,
            "sweep: warning: --vary: controller.t_ref_s[1]: has an effect only where "
            "controller.name is proposed or tlsc\n");
}

TEST_F(Sweep, AReplayIsTheRunThatItWasOrSaysSo) {
  ASSERT_EQ(sweep({"ishigami", "--vary", "x.first=1,2", "--out", "s"}).status, 0);
  const std::string key = results("s").at(1).at(0);
  const ProgramResult same = sweep({"s", "--replay", key.substr(0, 8)});
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_TRUE(fs::exists(folder_ / "s/runs" / key / "log.h5"));
  // As if another machine had made them.
  PointResult other = ShardIndex(folder_ / "s/shards", 2).read(0);
  fs::remove_all(folder_ / "s/shards");
  fs::create_directory(folder_ / "s/shards");
  other.state_hash = "0123456789abcdef";
  Shard(folder_ / "s/shards").add(other);
  const ProgramResult differs = sweep({"s", "--replay", key});
  EXPECT_EQ(differs.status, 3);
  EXPECT_NE(differs.err.find("is not the run of results.csv"), std::string::npos) << differs.err;
}

TEST_F(Sweep, AReplayOfWhatIsRefusedHasNoFolder) {
  ASSERT_EQ(run({"breakwater", "sweep", "motor_estimation", "--vary", "metrics.from_s=0.1,0.5",
                 "--vary", "metrics.to_s=1.0,0.3", "--duration", "0.01", "--out", "s"})
                .status,
            0);
  std::string key;
  for (const auto& row : results("s")) {
    if (std::find(row.begin(), row.end(), "refused") != row.end()) key = row[0];
  }
  ASSERT_FALSE(key.empty());
  const ProgramResult replayed = run({"breakwater", "sweep", "s", "--replay", key});
  EXPECT_EQ(replayed.status, 3);
  EXPECT_EQ(replayed.out, "");
  EXPECT_NE(replayed.err.find("is refused, and has no folder"), std::string::npos) << replayed.err;
}

TEST_F(Sweep, ASeedIsExact) {
  ASSERT_EQ(
      sweep({"ishigami", "--set", "run.seed=9007199254740993", "--sqlite", "--out", "s"}).status,
      0);
  EXPECT_EQ(results("s").at(1).at(2), "9007199254740993");
  write("look.py",
        "import sqlite3\nprint(sqlite3.connect('s/results.sqlite').execute("
        "'SELECT seed FROM results').fetchone()[0])\n");
  EXPECT_EQ(run({"/usr/bin/python3", "look.py"}).out, "9007199254740993\n");
}

TEST_F(Sweep, WhatIsInVainIsWarnedOf) {
  const auto warnings = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--out", "s"});
    const ProgramResult result = sweep(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    fs::remove_all(folder_ / "s");
    return result.err + result.out;
  };
  const auto expect = [&](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const std::vector<std::string> draws = {
      "ishigami", "--method", "sobol", "--vary", "x.first=uniform(0,1)", "--samples"};
  std::vector<std::string> odd = draws, even = draws;
  odd.push_back("100");
  even.push_back("64");
  expect(warnings(odd),
         "sweep: warning: samples: Sobol' points are even for a power of two: 64 or");
  EXPECT_EQ(warnings(even).find("warning"), std::string::npos);
  // Seeds without noise, and with it.
  const std::string unseeded = "the 3 of each sample gave the same run";
  expect(warnings({"ishigami", "--seeds", "1..3"}), unseeded);
  expect(warnings({"ishigami", "--seeds", "1..3", "--dry-run"}),
         "seeds: 1 and 2 give the same run");
  EXPECT_EQ(warnings({"ishigami", "--seeds", "1..3", "--case", "noisy"}).find("same run"),
            std::string::npos);
  // Metrics that some runs lack.
  expect(warnings({"ishigami", "--vary", "x.second=-1,1"}),
         "positive_x_second_1 is missing: in 1 of 2 complete runs of plain");
  expect(warnings({"ishigami", "--metrics", "y_2", "--case", "plain, noisy", "--dry-run"}),
         "compare.metrics: y_2: none of these runs has it (did you mean y_1?)");
  // A user who says --duration knows that it is shorter.
  EXPECT_EQ(warnings({"ishigami", "--duration", "0.5", "--dry-run"}).find("warning"),
            std::string::npos);
  // A key that the chosen estimator does not use, and one that another candidate does.
  const auto motor = [&](const std::string& cases) {
    const ProgramResult result = run({"breakwater", "sweep", "motor_estimation", "--case", cases,
                                      "--vary", "observer.poles_rad_s=[-10,-20,-30],[-11,-20,-30]",
                                      "--duration", "0.01", "--out", "s"});
    fs::remove_all(folder_ / "s");
    return result.err;
  };
  expect(motor("stf"), "sweep: warning: --vary: observer.");
  EXPECT_EQ(motor("stf,idob").find("warning"), std::string::npos);
}

TEST_F(Sweep, WarningsAreSaidToThoseWhoWantQuietToo) {
  const auto said = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--quiet", "--out", "s"});
    const ProgramResult result = sweep(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out, "");
    fs::remove_all(folder_ / "s");
    return result.err;
  };
  EXPECT_EQ(said({"ishigami", "--vary", "x.second=1,2"}), "");
  EXPECT_EQ(said({"ishigami", "--vary", "x.second=-1,1"}),
            "sweep: warning: positive_x_second_1 is missing: in 1 of 2 complete runs of plain\n");
  EXPECT_EQ(said({"ishigami", "--seeds", "1..3"}),
            "sweep: warning: seeds: the 3 of each sample gave the same run: without noise they "
            "change nothing\n");
  const std::string even =
      said({"ishigami", "--method", "sobol", "--vary", "x.first=uniform(0,1)", "--samples", "3"});
  EXPECT_TRUE(even.starts_with("sweep: warning: samples: Sobol' points")) << even;
}

TEST_F(Sweep, AMisspeltDistributionIsNamed) {
  write("bad.toml",
        "scenario = \"ishigami\"\nmethod = \"lhs\"\nsamples = 4\n[vary]\n"
        "\"x.first\" = { unifrom = [0, 1] }\n");
  expect_refused(sweep({"bad.toml"}),
                 "bad.toml:5: vary.x.first: there is no distribution unifrom (did you mean");
  expect_refused(sweep({"ishigami", "--vary", "x.first=unifrom(0,1)"}),
                 "--vary: x.first: unifrom(0,1): there is no unifrom(): there are uniform, "
                 "log_uniform, normal, lin, log (did you mean uniform?)");
}

TEST_F(Sweep, BlanksAroundValuesAreNoneOfThem) {
  for (const char* seeds : {"1, 2", "1 .. 2", " 1..2 "}) {
    ASSERT_EQ(sweep({"ishigami", "--case", "plain, noisy", "--vary", "x.first= 1 , 2", "--seeds",
                     seeds, "--out", "s"})
                  .status,
              0);
    EXPECT_EQ(results("s").size(), 9U);
  }
  ASSERT_EQ(run({"breakwater", "sweep", "motor_estimation", "--vary", "observer.name=idob, stf",
                 "--duration", "0.01", "--out", "words"})
                .status,
            0);
  EXPECT_EQ(results("words").size(), 3U);
}

TEST_F(Sweep, ADryRunOfOneRunSaysSo) {
  const ProgramResult result = sweep({"ishigami", "--dry-run"});
  EXPECT_TRUE(result.out.starts_with("1 run: 1 sample, 1 seed, 1 candidate\n")) << result.out;
}

// 100 000 points of other lengths, of which the mean is 2 (first: 0.5, mean: 1).
TEST_F(Sweep, ADryRunDoesNotLookAtEveryPoint) {
  const ProgramResult result = sweep({"ishigami", "--vary", "x.first=lin(0,1,100)", "--vary",
                                      "run.duration_s=lin(0.5,1.5,1000)", "--set",
                                      "trouble.takes_s=0.36", "--jobs", "2", "--dry-run"});
  EXPECT_NE(result.out.find("about 10."), std::string::npos) << result.out;  // 10 h and a little
  EXPECT_LT(result.seconds, 20.0);
}

TEST_F(Sweep, WhatIsToGoIsWeighedByCandidate) {
  ASSERT_EQ(
      sweep({"ishigami", "--case", "plain,noisy", "--vary", "x.first=1,2", "--out", "s"}).status,
      0);
  const fs::path shards = folder_ / "s/shards";
  std::vector<PointResult> points;
  for (std::size_t i = 0; i < 3; ++i) points.push_back(ShardIndex(shards, 4).read(i));
  fs::remove_all(shards);
  fs::create_directory(shards);
  for (PointResult& point : points) {
    point.cost_s = point.number % 2 == 0 ? 1.0 : 50.0;
    Shard(shards).add(point);
  }
  const ProgramResult status = sweep({"s", "--status"});
  EXPECT_NE(status.out.find("50.0 s of processor time to go"), std::string::npos) << status.out;
  // One candidate is not begun, and a point of the other ran twice.
  fs::remove_all(shards);
  fs::create_directory(shards);
  for (const std::size_t i : {0, 0, 2}) Shard(shards).add(points.at(i));
  const ProgramResult twice = sweep({"s", "--status"});
  EXPECT_NE(twice.out.find("2.0 s of processor time to go"), std::string::npos) << twice.out;
}

TEST_F(Sweep, SubmissionsThatCannotBeReadAreNotNone) {
  fs::create_directory(folder_ / "s");
  write("s/slurm", "no folder");
  EXPECT_THROW(queued(StudyFolder(folder_ / "s", kSweep), 1), std::invalid_argument);
}

TEST_F(Sweep, TwoStudiesAreNotBegunInOneFolder) {
  const ScenarioFile file(testing::source_file("tests/study/ishigami/ishigami.toml"), "ishigami");
  const StudyFolder study(folder_ / "s", kSweep);
  study.make("a = 1\n", file);
  EXPECT_NE(read("s/study.toml").find(file_hash(file.file())), std::string::npos);
  EXPECT_NO_THROW(study.make("a = 1\n", file));  // by another process at the same time
  EXPECT_NO_THROW(study.make("a = 1\n\n[slurm]\naccount = \"mine\"\n", file));
  EXPECT_THROW(study.make("a = 2\n", file), std::invalid_argument);
  study.make_anew("a = 2\n", file);
  EXPECT_NE(read("s/study.toml").find("a = 2\n"), std::string::npos);
}

TEST_F(Sweep, TwoSweepsOfOneStudyAreWarnedOf) {
  const std::vector<std::string> study = {
      ISHIGAMI_LAB,          "sweep",  "ishigami", "--vary", "x.first=lin(0,1,400)",  "--set",
      "trouble.takes_s=0.1", "--jobs", "1",        "--out",  (folder_ / "s").string()};
  ReadProgram first(study, true);
  ASSERT_TRUE(wait_for_a_result());
  ReadProgram second(study, true);
  std::string said;
  while (said.find("points may be run twice") == std::string::npos) {
    const auto line = second.next();
    if (!line) break;
    said += *line + "\n";
  }
  EXPECT_NE(said.find("is at this study too"), std::string::npos) << said;
  for (ReadProgram* program : {&first, &second}) {
    program->interrupt();
    while (program->next()) continue;
  }
}

// Each of its processes, of one point, would be content with what it reads itself.
TEST_F(Sweep, AModelThatChangesBetweenProcessesEndsTheStudy) {
  fs::copy_file(testing::source_file("models/motor.xml"), folder_ / "own.xml");
  ReadProgram study(
      {(testing::bin_folder() / "breakwater").string(), "sweep", "motor_estimation", "--set",
       "model.mjcf=" + (folder_ / "own.xml").string(), "--seeds", "1..7", "--duration", "0.01",
       "--isolate", "--jobs", "1", "--out", (folder_ / "s").string()},
      true);
  ASSERT_TRUE(wait_for_a_result());
  std::ofstream(folder_ / "own.xml", std::ios::app) << "<!-- changed -->\n";
  std::string said;
  while (const auto line = study.next()) said += *line + "\n";
  EXPECT_EQ(WEXITSTATUS(study.wait()), 2);
  EXPECT_NE(said.find("own.xml has changed since"), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(folder_ / "s/results.csv"));
  // Nothing of the other version is among the results.
  fs::copy_file(testing::source_file("models/motor.xml"), folder_ / "own.xml",
                fs::copy_options::overwrite_existing);
  const ProgramResult again = run({"breakwater", "sweep", "s"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(results("s").size(), 8U);
}

TEST_F(Sweep, ModelsThatChangedAreNotGoneOnWith) {
  fs::copy_file(testing::source_file("models/motor.xml"), folder_ / "own.xml");
  const std::vector<std::string> study = {
      "breakwater", "sweep", "motor_estimation", "--set", "model.mjcf=own.xml",
      "--seeds",    "1..2",  "--duration",       "0.01",  "--out",
      "s"};
  const ProgramResult first = run(study);
  ASSERT_EQ(first.status, 0) << first.err;
  std::ofstream(folder_ / "own.xml", std::ios::app) << "<!-- changed -->\n";
  expect_refused(run(study), "own.xml has changed since");
  // Shards of both versions, of nodes that do not see the same file, say.
  ModelHashes models = ShardIndex(folder_ / "s/shards", 2).models();
  models.begin()->second = "0123456789abcdef";
  Shard(folder_ / "s/shards").add(models);
  expect_refused(run(study), "some results are of another version of");
  expect_refused(run({"breakwater", "sweep", "s", "--collect"}), "some results are of another");
}

}  // namespace
}  // namespace breakwater
