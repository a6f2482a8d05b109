// Reproductions that are killed, altered or of other models, and paired comparisons.
#include <csignal>
#include <nlohmann/json.hpp>

#include <breakwater/record/file_hash.h>
#include <breakwater/study/shards.h>
#include "cli/program.h"

namespace breakwater::report_cli_test {
namespace fs = std::filesystem;

using testing::ProgramResult;

class Reports : public testing::ProgramTest {
 protected:
  Reports() { write("tiny.toml", data("experiments.toml")); }

  static std::string data(const std::string& name) {
    return testing::text_of(testing::source_file("tests/cli/data/" + name));
  }
  ProgramResult reproduce(const std::string& out, const testing::Moment& when = nullptr) {
    return run("breakwater reproduce --experiments tiny.toml --out " + out, when, SIGKILL);
  }
  // Makes a run of the motor in folder NAME.
  void motor(const std::string& name, const std::string& options) {
    ran("motor_estimation --quiet --out '" + name + "' " + options);
  }
};

TEST_F(Reports, AKilledReproductionContinuesToTheSamePage) {
  const ProgramResult whole = done(reproduce("whole"));
  EXPECT_TRUE(
      has(whole.out, "2 reproduced, 0 within the class, 0 not reproduced, 1 held, 0 did not hold"));
  EXPECT_TRUE(has(whole.out, "report: whole/report.html"));
  const std::string page = read("whole/report.html");
  EXPECT_TRUE(has(page, "Permission is hereby granted")) << "dygraphs' licence";

  std::size_t kills = 0;
  for (const std::size_t count : {1, 6, 12}) {
    kills += reproduce("killed", has_results("killed", count)).status == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GE(kills, 1U);
  const std::size_t before = results_in_shards("killed").size();
  done(reproduce("killed"));
  EXPECT_GT(before, 0U);
  EXPECT_EQ(read("killed/report.html"), read("whole/report.html"));
  // No run occurs twice.
  EXPECT_EQ(results_by_key(folder_ / "killed/shards").size(), 22U);
  EXPECT_LE(results_in_shards("killed").size(), 22 + 2 * kills)
      << "only what was cut off may be repeated";
  // No incomplete file remains.
  for (const auto& entry : fs::directory_iterator(folder_ / "killed/runs")) {
    EXPECT_TRUE(fs::exists(entry.path() / "manifest.json")) << entry.path();
  }

  EXPECT_TRUE(has(reproduce("killed").err, "22 runs, 22 of them there already"));
}

TEST_F(Reports, AnAlteredMeasurementFlipsItsVerdict) {
  done(reproduce("out"));
  EXPECT_TRUE(lacks(read("out/report.html"), "class=\"verdict off\""));
  const std::string hash = state_hash("out/runs/one-kfd");
  std::vector<std::string> lines = results_in_shards("out");
  std::erase_if(lines, [&](const std::string& line) { return !has(line, hash); });
  const std::string name = "\trmse_velocity_rad_s=";
  std::string altered_line = lines.at(0).substr(17);
  const std::size_t value = altered_line.find(name) + name.size();
  altered_line.replace(value, altered_line.find('\t', value) - value, "0.9");
  write("out/shards/later.shard", text_hash(altered_line) + '\t' + altered_line + '\n');
  EXPECT_TRUE(
      has(reproduce("out").out, "1 reproduced, 0 within the class, 1 not reproduced, 1 held"));
  EXPECT_TRUE(has(read("out/report.html"), "class=\"verdict off\""));
}

// Six seeds of two cases: the row agrees with metrics.json, pair by pair. If all six have the same
// sign, the probability is 2/64.
TEST_F(Reports, CompareOfSetsOfRunsIsPairedBySeed) {
  std::string words =
      "breakwater compare --paired --metric rmse_velocity_rad_s --goal rmse_velocity_rad_s=min "
      "--out compared";
  std::vector<double> differences;
  for (int seed = 1; seed <= 6; ++seed) {
    double values[2];
    int i = 0;
    for (const std::string name : {"kfd", "stf"}) {
      const std::string folder = name + std::to_string(seed);
      motor(folder, "--case " + name + " --seed " + std::to_string(seed) +
                        " --duration 11 --set noise.std_rad=0.01");
      words += " " + folder;
      values[i++] = json(folder + "/metrics.json").at("rmse_velocity_rad_s");
    }
    differences.push_back(values[1] - values[0]);
    ASSERT_LT(differences.back(), 0.0);
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_TRUE(has(ran(words).out, "better"));
  const auto row = [&](std::size_t line) {
    std::vector<std::string> cells;
    std::istringstream stream(lines("compared/comparison.csv").at(line));
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  const std::vector<std::string> names = row(0), cells = row(1);
  const auto cell = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return cells.at(static_cast<std::size_t>(found - names.begin()));
  };
  EXPECT_EQ(cell("candidate") + cell("reference") + cell("pairs"), "stfkfd6");
  std::vector<double> averages;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i; j < differences.size(); ++j) {
      averages.push_back(0.5 * (differences[i] + differences[j]));
    }
  }
  EXPECT_DOUBLE_EQ(std::stod(cell("difference")), testing::median(averages));
  EXPECT_DOUBLE_EQ(std::stod(cell("p")), 2.0 / 64.0);
  EXPECT_EQ(cell("verdict"), "better");

  // In the reverse order it is worse. A seed that one case lacks makes no pair.
  ran(testing::replaced(words, " kfd6", "") + " --baseline stf");
  const std::string reversed = read("compared/comparison.csv");
  EXPECT_TRUE(lacks(reversed, "kfd,stf,6"));
  EXPECT_TRUE(has(reversed, "kfd,stf,5"));
  expect_refusals("breakwater compare --paired ",
                  {{"kfd1 kfd2", "--paired: all runs are of one case: there is nothing to compare"},
                   {"kfd1 stf2", "--paired: no seed is common to all cases"},
                   {"kfd1 stf1 --baseline st", "--baseline: st: no run has it (did you mean stf?)"},
                   {"kfd1 stf1 --goal rmse_velocity=min", "--goal: rmse_velocity: no run has it"},
                   {"kfd1 kfd1 stf1", "kfd1: kfd with seed 1 is there twice"}});

  // Other test conditions are named, within a case and between the cases.
  const std::string usual = " --seed 7 --set noise.std_rad=0.01 --case ";
  motor("kfd7", usual + "kfd --duration 12");
  motor("stf7", usual + "stf --duration 11");
  const std::string pair = "breakwater compare --paired kfd1 stf1 kfd7 stf7 --quiet";
  EXPECT_EQ(ran(pair).err,
            "compare: --paired: the runs differ in more than case and seed: run.duration_s (11; "
            "12)\n");
  EXPECT_EQ(ran("breakwater compare --paired kfd7 stf7 --quiet").err, ran(pair).err);
}

}  // namespace breakwater::report_cli_test
