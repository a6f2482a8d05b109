// The quadrotor under waves: which estimator holds station under which reading of the thesis.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "regression/run_case.h"

namespace breakwater::quadrotor_waves_test {
namespace {

using testing::completed_run;
using testing::run_case;

double metric(const Recording& run, const char* name) {
  const auto value = run.metric(name);
  EXPECT_TRUE(value) << name;
  return value.value_or(NAN);
}

bool converges(const char* name, const std::vector<std::string>& sets) {
  const Recording run = run_case("quadrotor_waves", name, sets);
  return !run.failure && metric(run, "converged") == 1.0;
}

// Thesis 3.4.3.2: only (a) and (c) converge. quadrotor_pattern_test has ten seeds.
TEST(QuadrotorWaves, ConsistentReadingHasTheThesisPattern) {
  const std::vector<std::string> sets = {"reading=consistent"};
  const Recording a = run_case("quadrotor_waves", "ukf-second", sets);
  const Recording c = run_case("quadrotor_waves", "ukf-zero", sets);
  EXPECT_EQ(metric(a, "converged"), 1.0);
  EXPECT_EQ(metric(c, "converged"), 1.0);
  EXPECT_LT(metric(a, "tracking_rmse_m"), 0.1);
  EXPECT_LT(metric(c, "tracking_rmse_m"), metric(a, "tracking_rmse_m"));
  for (const char* name : {"ekf-second", "ekf-zero", "ukf-none", "ekf-none"}) {
    EXPECT_FALSE(converges(name, sets)) << name;
  }
}

TEST(QuadrotorWaves, AllSixConvergeInStillWater) {
  const std::vector<std::string> sets = {"reading=consistent", "wave.significant_height_m=0"};
  for (const char* name :
       {"ukf-second", "ekf-second", "ukf-zero", "ekf-zero", "ukf-none", "ekf-none"}) {
    EXPECT_TRUE(converges(name, sets)) << name;
  }
}

// The literal reading gives the opposite: the process noise of the proposed filter is too large.
TEST(QuadrotorWaves, LiteralReadingTurnsThePatternOver) {
  const std::vector<std::string> sets = {"reading=literal"};
  EXPECT_FALSE(converges("ukf-second", sets));
  EXPECT_FALSE(converges("ukf-zero", sets));
  EXPECT_TRUE(converges("ukf-none", sets));
}

// The process noise is the reason, not the transform: an EKF with the UKF's Q is as good.
TEST(QuadrotorWaves, AnEkfWithTheSameNoiseIsAsGood) {
  const auto tracking = [](const char* name) {
    return metric(run_case("quadrotor_waves", name, {"reading=consistent"}), "tracking_rmse_m");
  };
  const double ukf = tracking("ukf-zero");
  EXPECT_NEAR(tracking("ekf-zero-same-q"), ukf, 0.1 * ukf);
}

// Medians over seeds that were not used for tuning.
class Medians {
 public:
  Medians(const char* name, const std::vector<std::string>& sea) {
    for (const int seed : {101, 102, 103}) {
      std::vector<std::string> sets = sea;
      sets.push_back("run.seed=" + std::to_string(seed));
      runs_.push_back(run_case("quadrotor_waves", name, sets));
    }
  }
  double of(const char* what) const {
    std::vector<double> values;
    for (const Recording& run : runs_) values.push_back(metric(run, what));
    std::sort(values.begin(), values.end());
    return values[1];
  }
  double worst(const char* what) const {
    double value = 0.0;
    for (const Recording& run : runs_) value = std::max(value, metric(run, what));
    return value;
  }

 private:
  std::vector<Recording> runs_;
};

TEST(QuadrotorWaves, ResonatorHoldsStation) {
  const Medians resonator("resonator", {});
  EXPECT_LE(resonator.of("tracking_rmse_m"), 0.085);
  EXPECT_LE(resonator.worst("saturated_fraction"), 0.03);
  EXPECT_LE(resonator.of("vertical_force_rmse_N"),
            0.6 * resonator.of("vertical_force_rmse_of_zero_N"));
  for (const char* name : {"ukf-second-tuned", "ukf-zero-tuned"}) {
    const Medians rival(name, {});
    for (const char* what :
         {"tracking_rmse_m", "vertical_force_rmse_N", "horizontal_force_rmse_N", "thrust_rms_N"}) {
      EXPECT_LT(resonator.of(what), rival.of(what)) << name << " " << what;
    }
  }
}

// NEES of [ζ, ζ̇] should be 12. With one resonator the filter is overconfident in a sea of 2 m or
// more.
TEST(QuadrotorWaves, SpectrumIsConsistent) {
  const Medians spectrum("spectrum", {}), resonator("resonator", {});  // in a sea of 2 m
  const Medians low("spectrum", {"wave.significant_height_m=0.5"});
  const Medians high("spectrum", {"wave.significant_height_m=3"});
  for (const Medians* sea : {&low, &spectrum, &high}) {
    EXPECT_GT(sea->of("nees_mean"), 9.0);
    EXPECT_LT(sea->of("nees_mean"), 15.0);
    EXPECT_EQ(sea->of("converged"), 1.0);
  }
  for (const char* what : {"tracking_rmse_m", "vertical_force_rmse_N", "horizontal_force_rmse_N"}) {
    EXPECT_LT(spectrum.of(what), resonator.of(what)) << what;
  }
}

// The peak period changes from 8 s to 11 s at 40 s.
TEST(QuadrotorWaves, EstimatedFrequencyFollowsTheSea) {
  const Medians run("resonator",
                    {"run.duration_s=160", "wave.change_at_s=40", "wave.change_to_period_s=11",
                     "estimator.wave_frequency=estimated"});
  EXPECT_LE(run.worst("tracking_rmse_m"), 0.085);
  EXPECT_LE(run.of("vertical_force_rmse_N"), 0.7 * run.of("vertical_force_rmse_of_zero_N"));
}

// No forecast is better than the true future.
TEST(QuadrotorWaves, TheToldFutureIsTheFloorOfAllForecasts) {
  const std::vector<std::string> sets = {"run.duration_s=60", "metrics.window_s=30"};
  const auto tracking = [&](const char* name) {
    const Recording run = run_case("quadrotor_waves", name, sets);
    EXPECT_EQ(metric(run, "converged"), 1.0) << name;
    return metric(run, "tracking_rmse_m");
  };
  const double floor_m = tracking("mpc-told");
  EXPECT_LT(floor_m, 0.06);
  for (const char* name : {"mpc-held", "mpc-forecast", "mpc-autoregressive", "mpc-upstream"}) {
    EXPECT_LE(floor_m, tracking(name)) << name;
  }
}

TEST(QuadrotorWaves, IsReproducible) {
  const std::vector<std::string> sets = {"run.duration_s=5", "metrics.window_s=2"};
  const Recording one = run_case("quadrotor_waves", "resonator", sets);
  EXPECT_EQ(one.state_hash, run_case("quadrotor_waves", "resonator", sets).state_hash);
  EXPECT_NE(one.state_hash,
            run_case("quadrotor_waves", "resonator", {sets[0], sets[1], "run.seed=2"}).state_hash);
}

// A run of an earlier version: C_m alone, and the state hash that it had.
TEST(QuadrotorWaves, OldFilesKeepAVehicleWithoutAddedMass) {
  const ScenarioFile shipped = testing::scenario_file("quadrotor_waves");
  const testing::TemporaryPath path("older.toml");
  const std::string key = "added_mass_coefficient = 0.5 ";
  std::ofstream(path) << testing::replaced(shipped.text(), key, "#");
  const auto older = [&](const std::string& file) {
    return prepare_run(testing::catalogue(), "quadrotor_waves",
                       ScenarioFile(file, "quadrotor_waves"), "resonator",
                       {"run.duration_s=5", "metrics.window_s=2", "wave.inertia_coefficient=1.5"});
  };
  const PreparedRun run = older(path.string());
  EXPECT_EQ(run.scenario->run({}).state_hash, 0x80480e5c71fc68f2U);
  EXPECT_TRUE(lacks(run.config_text, "added_mass_coefficient ="));
  const testing::TemporaryPath again("again.toml");
  std::ofstream(again) << run.config_text;
  EXPECT_EQ(older(again.string()).config_text, run.config_text);
}

// The default C_m follows C_a, and the thesis' plant has neither.
TEST(QuadrotorWaves, AddedMassIsThatOfThePhysicalPlant) {
  const auto hash = [](const std::vector<std::string>& sets) {
    std::vector<std::string> all = {"run.duration_s=1", "metrics.window_s=0.5"};
    all.insert(all.end(), sets.begin(), sets.end());
    return run_case("quadrotor_waves", "resonator", all).state_hash;
  };
  const char* const other = "plant.added_mass_coefficient=0.7";
  EXPECT_EQ(hash({other}), hash({other, "wave.inertia_coefficient=1.7"}));
  EXPECT_NE(hash({other}), hash({}));
  for (const char* reading : {"reading=consistent", "reading=literal"}) {
    EXPECT_EQ(hash({reading, other}), hash({reading}));
  }
}

TEST(QuadrotorWaves, SetsHavePriorityOverTheReading) {
  const PreparedRun run = testing::prepare("quadrotor_waves", "ukf-zero",
                                           {"controller.gains=printed", "reading=literal"});
  EXPECT_TRUE(has(run.config_text, "gains = \"printed\"", "interpretation = \"variance\"",
                  "disturbance = \"zero\""));
}

TEST(QuadrotorWaves, WarnsOfUnstableGains) {
  const auto warnings = [&](const char* gains) {
    return testing::prepare("quadrotor_waves", "resonator", {gains}).scenario->warnings().size();
  };
  EXPECT_EQ(warnings("controller.gains=printed"), 1U);
  EXPECT_EQ(warnings("controller.gains=retuned"), 0U);
}

TEST(QuadrotorWaves, NanEndsTheRunUnlessDropped) {
  const std::vector<std::string> broken = {"run.duration_s=5", "metrics.window_s=2",
                                           "fault.sensor=roll", "fault.at_s=3"};
  const Recording stopped = run_case("quadrotor_waves", "ukf-second", broken);
  ASSERT_TRUE(stopped.failure);
  EXPECT_NEAR(stopped.failure->time_s, 3.0, 0.01);
  std::vector<std::string> dropped = broken;
  dropped.emplace_back("sensor.nan_policy=drop");
  const Recording run = completed_run("quadrotor_waves", "ukf-second", dropped);
  EXPECT_EQ(run.dropped_samples, 1);
}

}  // namespace
}  // namespace breakwater::quadrotor_waves_test
