// The thesis' six estimators over ten seeds: which of them hold station (Table 3.5 and 3.4.3.2).
#include "regression/run_case.h"

namespace breakwater::quadrotor_pattern_study {

struct Outcome {
  int converged = 0;
  double median_tracking_m = 0.0;
};

Outcome over_seeds(const char* name, std::vector<std::string> sets) {
  constexpr int kSeeds = 10;
  Outcome outcome;
  std::vector<double> tracking;
  sets.emplace_back();
  for (int seed = 1; seed <= kSeeds; ++seed) {
    sets.back() = "run.seed=" + std::to_string(seed);
    const Recording run = testing::run_case("quadrotor_waves", name, sets);
    const bool converged = !run.failure && run.metric("converged") == 1.0;
    outcome.converged += converged ? 1 : 0;
    tracking.push_back(run.metric("tracking_rmse_m").value_or(1e9));
  }
  std::sort(tracking.begin(), tracking.end());
  outcome.median_tracking_m = 0.5 * (tracking[4] + tracking[5]);
  return outcome;
}

TEST(QuadrotorPattern, ConsistentReadingIsTheThesis) {
  const std::vector<std::string> sets = {"reading=consistent"};
  const Outcome a = over_seeds("ukf-second", sets), c = over_seeds("ukf-zero", sets);
  EXPECT_GE(a.converged, 9);
  EXPECT_GE(c.converged, 9);
  EXPECT_LT(c.median_tracking_m, a.median_tracking_m);
  EXPECT_LT(a.median_tracking_m, 0.1);
  for (const char* name : {"ekf-second", "ekf-zero", "ukf-none", "ekf-none"}) {
    EXPECT_LE(over_seeds(name, sets).converged, 1) << name;
  }
  EXPECT_NEAR(over_seeds("ekf-second-same-q", sets).median_tracking_m, a.median_tracking_m,
              0.1 * a.median_tracking_m);
  EXPECT_NEAR(over_seeds("ekf-zero-same-q", sets).median_tracking_m, c.median_tracking_m,
              0.1 * c.median_tracking_m);
}

// Two of ten miss the limit of 0.5 m on an axis by a few centimetres.
TEST(QuadrotorPattern, LiteralReadingTurnsItOver) {
  const std::vector<std::string> sets = {"reading=literal"};
  for (const char* name : {"ukf-second", "ukf-zero", "ekf-second", "ekf-zero", "ekf-none"}) {
    EXPECT_EQ(over_seeds(name, sets).converged, 0) << name;
  }
  const Outcome e = over_seeds("ukf-none", sets);
  EXPECT_GE(e.converged, 8);
  EXPECT_LT(e.median_tracking_m, 0.3);
}

TEST(QuadrotorPattern, AllConvergeInStillWater) {
  const std::vector<std::string> sets = {"reading=consistent", "wave.significant_height_m=0"};
  for (const char* name :
       {"ukf-second", "ekf-second", "ukf-zero", "ekf-zero", "ukf-none", "ekf-none"}) {
    EXPECT_EQ(over_seeds(name, sets).converged, 10) << name;
  }
}

}  // namespace breakwater::quadrotor_pattern_study
