#include <breakwater/study/study_comparison.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "support.h"

namespace breakwater::study_comparison_test {
namespace {

// An ineffective key, an effective one, and effective seeds: two of eight samples differ.
Plan plan(WorldUnit worlds = WorldUnit::samples) {
  Study study;
  study.scenario = "any";
  study.cases = {"a", "b"};
  study.vary = {{.key = "idle", .values = {"1", "2", "3", "4"}},
                {.key = "busy", .values = {"10", "20"}}};
  study.seeds = {1, 2, 3};
  study.metrics = {"y"};
  study.worlds = worlds;
  return Plan(study);
}

using Choice = std::function<bool(const StudyPoint&)>;

// The results of all points except `missing`. Case b crashes at `crashes`.
PairedResults results_of(const Plan& plan, const Choice& crashes, const Choice& missing) {
  const testing::TemporaryPath folder{"study_comparison"};
  std::filesystem::create_directories(folder);
  {
    Shard shard(folder);
    for (std::size_t number = 0; number < plan.size(); ++number) {
      const StudyPoint point = plan.point(number);
      if (missing(point)) continue;
      PointResult result;
      result.number = number;
      result.key = std::to_string(number);
      if (point.candidate == 1 && crashes(point)) {
        result.status = PointStatus::crashed;
        result.reason = "signal 6";
      } else {
        const double y = std::stod(point.values[1]) + static_cast<double>(*point.seed);
        result.state_hash = fmt::format("{:016x}", static_cast<int>(y));
        result.metrics = {{"y", static_cast<double>(point.candidate) + y}};
      }
      shard.add(result);
    }
  }
  return paired_results(plan, ShardIndex(folder, plan.size()));
}

bool never(const StudyPoint&) {
  return false;
}

// A crash leaves no hash. Other runs must show whether two values of a key give the same run.
TEST(StudyComparison, ACrashMakesNoBlockOfAKeyWithoutEffect) {
  struct Row {
    const char* crashes;
    Choice where;
    std::size_t blocks_of_b, blocks;
  };
  for (const Row& row : {
           Row{"never", never, 2, 2},
           Row{"at a seed", [](const auto& point) { return point.seed == 2; }, 2, 2},
           Row{"at a value", [](const auto& point) { return point.values[1] == "10"; }, 2, 2},
           Row{"always", [](const auto&) { return true; }, 1, 2},
           // The key is effective here, and nobody knows which crashed runs are equal.
           Row{"at some values", [](const auto& point) { return point.values[0] >= "3"; }, 6, 6},
       }) {
    const CandidateComparison comparison = compare_candidates(results_of(plan(), row.where, never));
    EXPECT_EQ(comparison.reached, (std::vector<std::size_t>{2, row.blocks_of_b})) << row.crashes;
    EXPECT_EQ(comparison.blocks, row.blocks) << row.crashes;
  }
}

// A sample with a missing run would look different from its repeats.
TEST(StudyComparison, AHalfFinishedSampleMakesNoBlock) {
  const Choice missing = [](const StudyPoint& point) {
    return point.values == std::vector<std::string>{"4", "20"} && point.seed == 3;
  };
  const PairedResults results = results_of(plan(), never, missing);
  EXPECT_EQ(results.samples.size(), 7 * 3);
  EXPECT_EQ(compare_candidates(results).blocks, 2U);
  // If each seed is a block, the finished seeds count.
  const PairedResults of_seeds = results_of(plan(WorldUnit::seeds), never, missing);
  EXPECT_EQ(of_seeds.samples.size(), 8 * 3 - 1);
  EXPECT_EQ(compare_candidates(of_seeds).blocks, 6U);
}

}  // namespace
}  // namespace breakwater::study_comparison_test
