#include <breakwater/study/plan.h>

#include <cmath>
#include <numeric>
#include <set>

#include <breakwater/study/sweep.h>
#include "support.h"

namespace breakwater::plan_test {
namespace {

Study study(Method method) {
  Study study;
  study.scenario = "any";
  study.cases = {"a", "b"};
  study.method = method;
  study.vary = {{.key = "from", .values = {"1", "3", "5"}},
                {.key = "to", .values = {"2", "4", "6"}}};
  return study;
}

std::set<std::vector<std::string>> probed(const Plan& plan) {
  std::set<std::vector<std::string>> values;
  for (const StudyPoint& probe : plan.probes()) values.insert(probe.values);
  return values;
}

// A value in a list may be valid only with its neighbours: 3 … 4, but not 3 … 2.
TEST(Plan, ProbesOfAListAreItsSamples) {
  const std::set<std::vector<std::string>> samples = {{"1", "2"}, {"3", "4"}, {"5", "6"}};
  const Plan list(study(Method::list));
  EXPECT_EQ(probed(list), samples);
  EXPECT_EQ(list.probes().size(), 2U + 2U);  // each case and each further sample
}

TEST(Plan, ProbesOfAGridHaveEachValueOnce) {
  const std::set<std::vector<std::string>> around_the_first = {
      {"1", "2"}, {"3", "2"}, {"5", "2"}, {"1", "4"}, {"1", "6"}};
  EXPECT_EQ(probed(Plan(study(Method::grid))), around_the_first);
}

bool are_same(const StudyPoint& a, const StudyPoint& b) {
  return a.sample == b.sample && a.candidate == b.candidate && a.seed == b.seed &&
         a.values == b.values && a.sets == b.sets;
}

Study any_study(testing::Random& random) {
  const auto whole = [&](double least, double most) {
    return static_cast<std::size_t>(std::floor(random.uniform(least, most + 1.0)));
  };
  Study study;
  study.scenario = "any";
  study.method = static_cast<Method>(whole(0, 5));
  study.sampling_seed = whole(0, 1e6);
  study.samples = whole(1, 40);
  const bool is_listed = study.method == Method::grid || study.method == Method::list;
  const std::size_t values = whole(1, 5);
  for (std::size_t k = whole(1, 4); k > 0; --k) {
    VariedKey key{.key = "key" + std::to_string(k)};
    if (is_listed || (study.method != Method::saltelli && whole(0, 1) == 0)) {
      for (std::size_t i = 0; i < values; ++i) key.values.push_back(std::to_string(i));
    } else {
      key.distribution.emplace(DistributionKind::uniform, 0.0, random.uniform(1.0, 9.0));
    }
    study.vary.push_back(key);
  }
  for (std::size_t k = whole(1, 3); k > 0; --k) study.cases.push_back("case" + std::to_string(k));
  if (whole(0, 1) == 0) study.compare = {{.key = "c", .values = {"1", "2"}}};
  for (std::size_t k = whole(0, 3); k > 0; --k) study.seeds.push_back(k);
  return study;
}

// In any order, and in a plan of its own as another process has it.
TEST(PlanProperty, PointsDoNotDependOnTheirOrder) {
  const int count = testing::property_count(2000);
  testing::Random random(403);
  int points = 0, studies = 0;
  for (; points < count; ++studies) {
    const Study study = any_study(random);
    const Plan plan(study);
    std::vector<StudyPoint> in_order;
    for (std::size_t i = 0; i < plan.size(); ++i) in_order.push_back(plan.point(i));
    std::vector<std::size_t> order(plan.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(static_cast<unsigned>(studies)));
    const Plan other(study);
    for (const std::size_t i : order) {
      ASSERT_TRUE(are_same(other.point(i), in_order[i])) << studies << ": " << i;
      ++points;
    }
  }
  std::printf("%d points of %d studies\n", points, studies);
}

TEST(Points, AreSortedWithoutRepetition) {
  EXPECT_EQ(parse_points("7,2-4,3", 8), (std::vector<std::size_t>{2, 3, 4, 7}));
  EXPECT_EQ(print_points({2, 3, 4, 7}), "2-4,7");
  for (const char* text : {"", "8", "4-2", "1,", "1-", "x"}) {
    EXPECT_THROW(parse_points(text, 8), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace breakwater::plan_test
