#include <breakwater/study/plan.h>

#include <gtest/gtest.h>

#include <set>

#include <breakwater/study/sweep.h>

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

TEST(Points, AreSortedWithoutRepetition) {
  EXPECT_EQ(parse_points("7,2-4,3", 8), (std::vector<std::size_t>{2, 3, 4, 7}));
  EXPECT_EQ(print_points({2, 3, 4, 7}), "2-4,7");
  for (const char* text : {"", "8", "4-2", "1,", "1-", "x"}) {
    EXPECT_THROW(parse_points(text, 8), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace breakwater::plan_test
