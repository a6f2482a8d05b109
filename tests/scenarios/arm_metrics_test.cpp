#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "arm_push/push_metrics.h"
#include "arm_wall_contact/wall_contact_metrics.h"

namespace breakwater {
namespace {

std::optional<double> value(const std::vector<Metric>& metrics, const std::string& name) {
  for (const Metric& metric : metrics) {
    if (metric.name == name) return metric.value;
  }
  return std::nullopt;
}

// Steps of 10 ms, samples of 20 ms, the switch at 1 s. Contact from 1.50 to 1.60 s with 3 N (raw
// peak of 4 N at 1.55 s). Then contact from 1.80 to 1.85 s with 2 N, and from 2 s with 1 N.
constexpr double kStep = 0.01;

double force_at(int k) {
  if (k >= 150 && k < 160) return k == 155 ? 4.0 : 3.0;
  if (k >= 180 && k < 185) return 2.0;
  return k >= 200 ? 1.0 : 0.0;
}

WallContactMetrics wall_history(int steps) {
  WallContactMetrics metrics({.force_from_s = 1.0,
                              .reference_N = 1.5,
                              .error_from_s = 2.5,
                              .error_to_s = 3.0,
                              .step_s = kStep,
                              .period_s = 2 * kStep,
                              .start_pose = TipPose(0.45, 0.1, 0.2)});
  for (int k = 0; k < steps; ++k) {
    const double t = k * kStep;
    // Larger values before the switch, which must not count.
    const bool before = k < 100;
    const double filtered = before ? 99.0 : (k % 2 == 0 ? 1.0 : 1.2);
    if (metrics.after_step(t, before ? 99.0 : force_at(k), filtered, 0.001 * k)) {
      metrics.set_impact_mass(0.5 * k);
    }
    if (k % 2 != 0) continue;
    const TipPose tip = before     ? TipPose(9, 9, 9)
                        : k == 120 ? TipPose(0.45, 0.1 - 0.03, 0.2 + 0.05)
                                   : TipPose(0.60, 0.1 + 0.02, 0.2 - 0.04);
    metrics.after_sample(t, force_at(k), tip, k % 50 == 0);
  }
  return metrics;
}

TEST(WallContactMetrics, AreRightForAHistoryWithTwoBounces) {
  const auto m = wall_history(400).metrics(4.0);
  EXPECT_NEAR(*value(m, "free_motion_time_s"), 0.5, 1e-12);
  EXPECT_EQ(*value(m, "peak_force_raw_N"), 4.0);
  EXPECT_EQ(*value(m, "peak_force_filtered_N"), 1.2);
  EXPECT_EQ(*value(m, "impact_velocity_m_s"), 0.150);
  EXPECT_EQ(*value(m, "impact_mass_kg"), 75.0);  // at step 150 only
  EXPECT_EQ(*value(m, "bounce_count"), 2.0);
  // 1.5 to 1.7 s: nine steps of 3 N and one of 4 N.
  EXPECT_NEAR(*value(m, "contact_impulse_Ns"), 0.31, 1e-12);
  // 25 errors of 0.5 N and 25 of 0.3 N.
  EXPECT_NEAR(*value(m, "mean_force_error_N"), 0.4, 1e-12);
  EXPECT_NEAR(*value(m, "std_force_error_N"), 0.1 * std::sqrt(50.0 / 49.0), 1e-12);
  // Only sample 250 of 250, 252, …, 298.
  EXPECT_NEAR(*value(m, "saturated_share"), 1.0 / 25.0, 1e-12);
  // Samples 100, 150, …, 350: six of 20 ms.
  EXPECT_NEAR(*value(m, "saturated_time_s"), 0.12, 1e-12);
  EXPECT_NEAR(*value(m, "max_y_error_m"), 0.03, 1e-12);
  EXPECT_NEAR(*value(m, "max_posture_error_rad"), 0.05, 1e-12);
}

TEST(WallContactMetrics, AreAbsentWhereTheyDoNotApply) {
  EXPECT_TRUE(wall_history(100).metrics(1.0).empty());
  const auto untouched = wall_history(150).metrics(1.5);
  EXPECT_FALSE(value(untouched, "peak_force_raw_N"));
  EXPECT_FALSE(value(untouched, "bounce_count"));
  EXPECT_TRUE(value(untouched, "saturated_time_s"));
  const auto brief = wall_history(160).metrics(1.6);
  EXPECT_TRUE(value(brief, "peak_force_raw_N"));
  EXPECT_FALSE(value(brief, "contact_impulse_Ns"));
  EXPECT_FALSE(value(wall_history(299).metrics(2.99), "mean_force_error_N"));
  EXPECT_TRUE(value(wall_history(300).metrics(3.0), "mean_force_error_N"));
}

// A hundred samples in the window. The force repeats every four samples and halves in the middle.
std::vector<Metric> late_history(const std::array<double, 4>& force_N) {
  WallContactMetrics metrics({.force_from_s = 0.0,
                              .reference_N = 1.5,
                              .error_from_s = 1.0,
                              .error_to_s = 2.0,
                              .step_s = kStep,
                              .period_s = kStep,
                              .start_pose = TipPose::Zero()});
  for (int k = 0; k < 250; ++k) {
    const bool in_window = k >= 100 && k < 200;
    const double force = force_N[static_cast<std::size_t>(k % 4)] * (k < 150 ? 2.0 : 1.0);
    metrics.after_step(k * kStep, force, force, 0.1);
    metrics.after_sample(k * kStep, in_window ? force : 50.0 * (k % 2), TipPose::Zero(), false);
  }
  return metrics.metrics(2.5);
}

TEST(WallContactMetrics, AreRightForTheLateForce) {
  const auto bounces = late_history({0.0, 0.0, 2.0, 3.0});
  EXPECT_EQ(*value(bounces, "late_bounce_count"), 25.0);
  EXPECT_EQ(*value(bounces, "force_frequency_Hz"), 25.0);
  EXPECT_NEAR(*value(bounces, "force_decay_ratio"), 0.5, 1e-12);
  const auto swings = late_history({0.5, 0.5, 2.0, 3.0});
  EXPECT_EQ(*value(swings, "late_bounce_count"), 0.0);
  EXPECT_EQ(*value(swings, "force_frequency_Hz"), 25.0);
  const auto rests = late_history({1.0, 1.0, 1.0, 1.0});
  EXPECT_EQ(*value(rests, "force_frequency_Hz"), 0.0);
  EXPECT_FALSE(value(rests, "force_decay_ratio"));  // no oscillation in the first fifth
  EXPECT_FALSE(value(late_history({0.0, 0.0, 0.0, 0.0}), "late_bounce_count"));
}

// Two joints, samples of 0.1 s, gripped at 1 s, released at 2 s.
std::vector<Metric> push_history(int samples) {
  PushMetrics metrics({.grip_s = 1.0,
                       .release_s = 2.0,
                       .start_angles_rad = {0.5, -0.5},
                       .start_pose = TipPose(0.4, 0.0, 0.0),
                       .settled_within_m = 0.01,
                       .period_s = 0.1});
  for (int k = 0; k < samples; ++k) {
    const double t = 0.1 * k;
    Eigen::Vector2d q(0.5, -0.5), dq(0, 0);
    TipPose tip(0.4, 0.0, 0.0);
    if (k < 10) {
      tip << 9, 9, 9;  // before the window
      dq << 9, 9;
    } else if (k < 20) {
      q << 1.5, -1.0;  // joint 1 is pushed up by 1 rad, joint 2 down by 0.5 rad
      dq << 5, 5;
      tip << 0.1, -0.2, 1.0;
    } else if (k < 25) {
      q << 0.5 - 0.02, -0.5 + 0.03;  // beyond the start by 0.02 and 0.03
      dq << -2, 1;
      tip << 0.39, 0.03, -0.25;  // y and φ are beyond their start
    } else {
      q << (k < 28 ? 0.6 : 0.55), -0.5;  // no overshoot yet; joint 1 turns back
      tip << 0.4 + 0.003, 0.004, 0.5;
    }
    metrics.after_sample(t, q, dq, tip, k < 20 ? -0.1 * k : 0.0, k % 5 == 0);
  }
  return metrics.metrics();
}

TEST(PushMetrics, AreRightForAHistory) {
  const auto m = push_history(31);
  EXPECT_NEAR(*value(m, "max_push_rad"), 1.9, 1e-12);
  EXPECT_NEAR(*value(m, "overshoot_rad"), 0.03, 1e-12);
  EXPECT_NEAR(*value(m, "x_overshoot_m"), 0.003, 1e-12);
  EXPECT_NEAR(*value(m, "y_overshoot_m"), 0.03, 1e-12);
  EXPECT_NEAR(*value(m, "posture_overshoot_rad"), 0.25, 1e-12);
  EXPECT_EQ(*value(m, "reversal_count"), 1.0);
  EXPECT_NEAR(*value(m, "settling_time_s"), 0.5, 1e-12);
  EXPECT_NEAR(*value(m, "saturated_time_s"), 0.5, 1e-12);  // 10, 15, …, 30
  EXPECT_NEAR(*value(m, "tip_error_m"), 0.005, 1e-12);
  EXPECT_EQ(*value(m, "peak_speed_rad_s"), 2.0);
}

// The tip returns but a joint does not. It never passes its start, so this is no success.
TEST(PushMetrics, AnotherPostureCountsAsOvershoot) {
  PushMetrics metrics({.grip_s = 0.0,
                       .release_s = 1.0,
                       .start_angles_rad = {0.5, -0.5},
                       .start_pose = TipPose(0.4, 0.0, 0.0),
                       .settled_within_m = 0.01,
                       .period_s = 0.1});
  const TipPose start(0.4, 0.0, 0.0);
  for (int k = 0; k < 20; ++k) {
    metrics.after_sample(0.1 * k, Eigen::Vector2d(0.5 + 0.1 * k, -0.5), Eigen::Vector2d(1.0, 0.0),
                         k < 15 ? TipPose(9, 9, 9) : start, 0.0, false);
  }
  EXPECT_NEAR(*value(metrics.metrics(), "overshoot_rad"), 1.9, 1e-12);
}

TEST(PushMetrics, AreAbsentWhereTheyDoNotApply) {
  EXPECT_TRUE(push_history(10).empty());
  EXPECT_EQ(push_history(20).size(), 1U);
  EXPECT_FALSE(value(push_history(24), "settling_time_s"));
}

}  // namespace
}  // namespace breakwater
