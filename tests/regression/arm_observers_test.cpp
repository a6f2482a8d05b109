// The arm with each estimator of an axis, chosen by name only.
#include <gtest/gtest.h>

#include <cmath>

#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::run_case;

const std::vector<std::string> kShort = {
    "run.duration_s=20", "force.from_s=12",      "wall.solid_from_s=10", "metrics.from_s=16",
    "metrics.to_s=20",   "record.fine_from_s=0", "record.fine_to_s=0"};

// With the fastest ones the force bounces around the reference.
TEST(ArmObservers, EachHoldsTheContact) {
  const std::pair<const char*, double> spreads_N[] = {
      {"idob", 0.2}, {"kfd", 0.5}, {"fakfd", 0.5}, {"vfakfd", 0.2},
      {"qvff", 0.2}, {"stf", 3.0}, {"qbank", 3.0}};
  for (const auto& [name, spread_N] : spreads_N) {
    std::vector<std::string> sets = kShort;
    sets.push_back("observer.name=" + std::string(name));
    const Recording run = run_case("arm_wall_contact", "proposed-2N", sets);
    ASSERT_FALSE(run.failure) << name << ": " << run.failure->reason;
    EXPECT_NEAR(run.metric("mean_force_error_N").value_or(9.0), 0.0, 0.25 * spread_N) << name;
    EXPECT_LT(run.metric("std_force_error_N").value_or(9.0), spread_N) << name;
    EXPECT_NEAR(run.metric("free_motion_time_s").value_or(9.0), 0.52, 0.04) << name;
    EXPECT_GT(run.track("control").values("innovation").size(), 0U) << name;
  }
}

TEST(ArmObservers, EachRecoversFromAPush) {
  for (const char* name : {"kfd", "stf", "qvff", "qbank"}) {
    const Recording run =
        run_case("arm_push", "proposed-link1", {"observer.name=" + std::string(name)});
    ASSERT_FALSE(run.failure) << name << ": " << run.failure->reason;
    EXPECT_LT(run.metric("tip_error_m").value_or(9.0), 0.01) << name;
  }
}

// One row of poles per joint, or one for all.
TEST(ArmObservers, OneRowOfPolesIsForEachJoint) {
  const auto hash = [&](const std::string& poles) {
    return run_case("arm_push", "proposed-link1",
                    {"run.duration_s=1", "observer.poles_rad_s=" + poles})
        .state_hash;
  };
  EXPECT_EQ(hash("[-40, -43, -46]"), hash("[[-40, -43, -46], [-40, -43, -46], [-40, -43, -46]]"));
  EXPECT_NE(hash("[-40, -43, -46]"), hash("[-60, -63, -66]"));
  EXPECT_THROW(hash("[[-40, -43, -46], [-40, -43, -46]]"), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
