// The shipped study files and the tables in docs/studies made from them.
#include <atomic>

#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/program/program.h>
#include <breakwater/search/tuning_plan.h>
#include <breakwater/study/sweep.h>
#include "support.h"

namespace breakwater::shipped_studies_test {
namespace fs = std::filesystem;

enum class Use { sweep, tune };

std::vector<std::string> shipped(Use use) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(testing::source_file("studies"))) {
    if (entry.path().extension() != ".toml") continue;
    // Each process of these tests asks. Reading the files as TOML takes longer than most of them.
    const bool is_tuning = has(testing::text_of(entry.path()), "\nbudget");
    if (is_tuning != (use == Use::tune)) continue;
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Study study_of(const std::string& name) {
  const std::string file = testing::source_file("studies/" + name + ".toml");
  return read_study(parse_toml_file(file), file);
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) all.push_back(cell);
  return all;
}

class EachShippedStudy : public ::testing::TestWithParam<std::string> {
 protected:
  const Catalogue catalogue_ = standard_catalogue();
};

TEST_P(EachShippedStudy, CanRun) {
  Study study = study_of(GetParam());
  Sweep(catalogue_, study).check();

  // A very short run of a point at the beginning, in the middle and at the end.
  const std::string duration = "run.duration_s";
  for (VariedKey& key : study.vary) {
    if (key.key == duration) std::fill(key.values.begin(), key.values.end(), "0.05");
  }
  study.sets.push_back(duration + "=0.05");
  const Sweep brief(catalogue_, study);
  const std::size_t last = brief.plan().size() - 1;
  std::atomic<bool> stop = false;
  for (const std::size_t point : {std::size_t{0}, last / 2, last}) {
    const PointResult result = run_point(point, brief, {.stop = &stop});
    EXPECT_EQ(result.status, PointStatus::complete) << point << ": " << result.reason;
    EXPECT_EQ(result.state_hash.size(), 16U);
  }
}

// docs/studies/NAME.csv, if it exists, is the results.csv of this study.
TEST_P(EachShippedStudy, ItsTableIsFromThisStudy) {
  const fs::path file = testing::source_file("docs/studies/" + GetParam() + ".csv");
  if (!fs::exists(file)) GTEST_SKIP() << "no table of it is kept";
  const Sweep sweep(catalogue_, study_of(GetParam()));
  const Plan& plan = sweep.plan();
  std::ifstream table(file);
  std::string line;
  std::getline(table, line);
  const std::vector<std::string> header = cells(line);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  std::size_t point = 0;
  for (; std::getline(table, line); ++point) {
    ASSERT_LT(point, plan.size());
    const std::vector<std::string> row = cells(line);
    const StudyPoint expected = plan.point(point);
    EXPECT_EQ(row.at(column("case")), plan.candidates()[expected.candidate].case_name);
    if (expected.seed) {
      EXPECT_EQ(row.at(column("seed")), std::to_string(*expected.seed));
    }
    for (std::size_t i = 0; i < expected.values.size(); ++i) {
      EXPECT_EQ(row.at(column(plan.study().vary[i].key)), plain_text(expected.values[i])) << line;
    }
  }
  EXPECT_EQ(point, plan.size());
}

class EachShippedTuning : public ::testing::TestWithParam<std::string> {};

TEST_P(EachShippedTuning, CanRunAndUsesAllItsKeys) {
  const std::string file = testing::source_file("studies/" + GetParam() + ".toml");
  const Catalogue catalogue = standard_catalogue();
  const TuningPlan plan(catalogue, read_tuning(parse_toml_file(file), file));
  for (const std::string& warning : plan.check()) {
    // All controllers of published-impact-tuning.toml meet its conditions; only one is told a
    // place.
    EXPECT_NE(warning.find("world.controller.wall_error_m: has an effect only"), warning.npos)
        << warning;
  }
  // The results of NAME-tuning.toml are tested in the conditions of NAME.toml.
  EXPECT_EQ(plan.tuning().validation.has_value(), !GetParam().ends_with("-tuning"));
}

std::string test_name(const ::testing::TestParamInfo<std::string>& param) {
  std::string name = param.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Studies, EachShippedStudy, ::testing::ValuesIn(shipped(Use::sweep)),
                         test_name);
INSTANTIATE_TEST_SUITE_P(Studies, EachShippedTuning, ::testing::ValuesIn(shipped(Use::tune)),
                         test_name);

}  // namespace breakwater::shipped_studies_test
