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

}  // namespace breakwater::report_cli_test
