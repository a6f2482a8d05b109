
#include <cmath>
#include <numeric>

#include "regression/run_case.h"

namespace breakwater {
namespace {

using testing::run_case;
using Values = std::vector<double>;

Values of(const Recording& run, const std::string& signal) {
  return run.track("control").values(signal);
}

// The values from one time to another, both included.
Values between(const Recording& run, const Values& values, double from_s, double to_s) {
  const Values times = run.track("control").times();
  Values part;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (times[i] >= from_s && times[i] <= to_s) part.push_back(values[i]);
  }
  return part;
}

Values difference(Values a, const Values& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

double mean(const Values& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms(const Values& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

double largest_size(const Values& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

TEST(MetricsFromLogs, RawVelocityOfTheMotorIsTheRawDifference) {
  const Recording run = run_case("motor_estimation", "mdob", {"encoder.bits=8"});
  const Values angle = of(run, "position_measured_rad");
  const Values times = run.track("control").times();
  Values raw(angle.size(), 0.0);
  for (std::size_t i = 1; i < raw.size(); ++i) {
    raw[i] = (angle[i] - angle[i - 1]) / (times[i] - times[i - 1]);
  }
  EXPECT_LT(largest_size(difference(raw, of(run, "velocity_raw_rad_s"))), 1e-6);
  const Values error = difference(raw, of(run, "velocity_true_rad_s"));
  EXPECT_NEAR(*run.metric("rmse_raw_velocity_rad_s"), rms(between(run, error, 5.0, 10.0)), 1e-9);
}

// From the disturbance on. The torque is the applied one, not the commanded one.
TEST(MetricsFromLogs, AngleAndTorqueOfTheMotorCountFromTheDisturbance) {
  const Recording run = run_case("motor_estimation", "idob",
                                 {"encoder.bits=8", "drive.limit_Nm=10.5", "disturbance.start_s=2",
                                  "disturbance.kind=two_sines"});
  const auto since = [&](const char* signal) {
    return rms(between(run, of(run, signal), 2.0 - 1e-9, 10.0 + 1e-9));
  };
  EXPECT_NEAR(*run.metric("rms_position_rad"), since("position_true_rad"), 1e-12);
  EXPECT_NEAR(*run.metric("rms_torque_Nm"), since("applied_Nm"), 1e-9);
  EXPECT_LT(*run.metric("rms_torque_Nm"), since("command_Nm") - 0.01);
  // A shorter run has neither.
  EXPECT_FALSE(
      run_case("motor_estimation", "idob", {"run.duration_s=0.5"}).metric("rms_torque_Nm"));
}

TEST(MetricsFromLogs, LateForceAtTheWallMatchesTheContactForce) {
  const Recording run = run_case(
      "arm_wall_contact", "proposed-2N",
      {"contact.stiffness_N_m=5000", "metrics.from_s=31", "metrics.to_s=33", "run.duration_s=33"});
  const Values force = of(run, "force_true_N");
  const auto window = [&](double from_s, double to_s) {
    return between(run, force, from_s - 1e-6, to_s - 1e-6);  // without the end
  };
  const Values late = window(31.0, 33.0);
  int onsets = 0, rises = 0;
  for (std::size_t i = 1; i < late.size(); ++i) {
    onsets += late[i] > 0.0 && late[i - 1] <= 0.0 ? 1 : 0;
    rises += late[i] > 2.0 && late[i - 1] <= 2.0 ? 1 : 0;
  }
  EXPECT_GT(onsets, 1);
  EXPECT_EQ(*run.metric("late_bounce_count"), onsets);
  EXPECT_EQ(*run.metric("force_frequency_Hz"), rises / 2.0);
  const auto spread = [&](double from_s, double to_s) {
    const Values part = window(from_s, to_s);
    return rms(difference(part, Values(part.size(), mean(part))));
  };
  EXPECT_NEAR(*run.metric("force_decay_ratio"), spread(32.6, 33.0) / spread(31.0, 31.4), 1e-9);
}

TEST(MetricsFromLogs, LagOfARampIsItsMeanErrorOverItsSlope) {
  const Recording run = run_case("cart_estimation", "order1", {"disturbance.kind=ramp"});
  const Values late = difference(of(run, "d_true_N"), of(run, "d_hat_N"));
  const double slope = of(run, "d_true_N").back() - of(run, "d_true_N").rbegin()[1];
  const double period_s = run.track("control").times()[1];
  EXPECT_NEAR(*run.metric("disturbance_lag_s"),
              mean(between(run, late, 40.0, 50.0)) / (slope / period_s), 1e-9);
}

// d shifted by the lag fits d̂, except for a gain, better than with a smaller or larger shift.
TEST(MetricsFromLogs, LagOfASineIsTheDelayThatFitsBest) {
  const Recording run = run_case("cart_estimation", "order2", {"disturbance.kind=sine"});
  const double lag_s = *run.metric("disturbance_lag_s");
  const double period_s = run.track("control").times()[1];
  const Values truth = of(run, "d_true_N"), estimate = of(run, "d_hat_N");
  const auto misfit = [&](double delay_s) {
    const auto shift = static_cast<std::ptrdiff_t>(std::lround(delay_s / period_s));
    double of_estimate = 0.0, of_truth = 0.0, of_both = 0.0;
    for (auto i = static_cast<std::ptrdiff_t>(20.0 / period_s);
         i < static_cast<std::ptrdiff_t>(truth.size()); ++i) {
      if (i - shift < 0 || i - shift >= static_cast<std::ptrdiff_t>(truth.size())) continue;
      const double here = estimate[static_cast<std::size_t>(i)];
      const double there = truth[static_cast<std::size_t>(i - shift)];
      of_estimate += here * here;
      of_truth += there * there;
      of_both += here * there;
    }
    return of_estimate - of_both * of_both / of_truth;  // with the best gain
  };
  for (const double off_s : {-1.0, 1.0}) EXPECT_LT(misfit(lag_s), misfit(lag_s + off_s));
}

TEST(MetricsFromLogs, AStepHasNoLag) {
  EXPECT_FALSE(run_case("cart_estimation", "order1").metric("disturbance_lag_s"));
}

TEST(MetricsFromLogs, TheRiseOfAnEstimateEndsAtItsLevel) {
  const auto first = [](const Recording& run, double level) {
    const Values estimate = of(run, "d_hat_N");
    std::size_t i = 0;
    while (std::abs(estimate[i]) < level) ++i;
    return run.track("control").times()[i];
  };
  const Recording friction = run_case("cart_position", "mdob", {"run.duration_s=10"});
  EXPECT_NEAR(*friction.metric("estimate_rise_time_s"),
              first(friction, 0.3 * (1.0 - std::exp(-1.0))), 1e-9);
  EXPECT_FALSE(run_case("cart_position", "mdob", {"plant.coulomb_friction_N=0"})
                   .metric("estimate_rise_time_s"));
  const Recording step = run_case("cart_estimation", "gamma-1.20");
  EXPECT_NEAR(*step.metric("reach_time_99pct_s"), first(step, 0.99 * 5.0) - 25.0, 1e-9);
}

TEST(MetricsFromLogs, NoiseIsMeasuredAboutItsMean) {
  const Recording run =
      run_case("cart_estimation", "gamma-1.02", {"metrics.from_s=20", "metrics.to_s=40"});
  Values noise = between(run, of(run, "d_hat_noise_N"), 20.0, 40.0);
  const double middle = mean(noise);
  for (double& value : noise) value -= middle;
  EXPECT_NEAR(*run.metric("max_noise_deviation_N"), largest_size(noise), 1e-12);
}

TEST(MetricsFromLogs, MatchForTheOffsetFreeCart) {
  const Recording run = run_case("cart_offset_free", "proposed",
                                 {"noise.enabled=true", "metrics.from_s=30", "metrics.to_s=40"});
  const Values position = of(run, "position_true_m");
  Values late = between(run, position, 30.0, 40.0);
  const double middle = mean(late);
  for (double& value : late) value -= middle;
  const auto n = static_cast<double>(late.size());
  EXPECT_NEAR(*run.metric("std_position_m"), rms(late) * std::sqrt(n / (n - 1.0)), 1e-12);
  EXPECT_NEAR(*run.metric("rms_position_estimate_error_m"),
              rms(difference(of(run, "position_hat_m"), position)), 1e-12);
  EXPECT_NEAR(*run.metric("max_early_disturbance_estimate_N"),
              largest_size(between(run, of(run, "d_hat_N"), 5.0, 9.9999)), 1e-12);
}

TEST(MetricsFromLogs, MatchForTheConstrainedCart) {
  const Recording run = run_case("cart_constrained", "proposed-idob");
  const Values estimate = of(run, "velocity_hat_m_s");
  double travel = 0.0;
  for (std::size_t i = 1; i < estimate.size(); ++i)
    travel += std::abs(estimate[i] - estimate[i - 1]);
  EXPECT_GT(travel, 0.0);
  EXPECT_NEAR(*run.metric("velocity_estimate_travel_m_s"), travel, 1e-12);
  EXPECT_NEAR(*run.metric("rms_velocity_estimate_error_m_s"),
              rms(difference(estimate, of(run, "velocity_true_m_s"))), 1e-12);
}

}  // namespace
}  // namespace breakwater
