// Tables 4.4, 4.5 and 4.7, and the 250 s of 4.2.1.1.

#include <cmath>

#include "regression/run_case.h"

namespace breakwater::cart_estimation_test {
namespace {

using Sets = std::vector<std::string>;

Recording run(const std::string& case_name, const Sets& sets = {}) {
  Recording recording = testing::run_case("cart_estimation", case_name, sets);
  EXPECT_FALSE(recording.failure) << case_name;
  return recording;
}

double metric(const std::string& case_name, const Sets& sets, const std::string& name) {
  return run(case_name, sets).metric(name).value_or(NAN);
}

// "P": at the end the estimate follows the disturbance within 5 %. For the high sine "P" means that
// the filter ignores it as noise: the error is the disturbance itself.
TEST(CartEstimation, AllVerdictsOfTable44) {
  struct Verdicts {
    const char* kind;
    bool positive[3];
  };
  for (const Verdicts& row :
       {Verdicts{"step", {false, false, false}}, Verdicts{"ramp", {false, true, true}},
        Verdicts{"sine", {false, false, true}}}) {
    for (int order = 0; order < 3; ++order) {
      const double error =
          metric("order" + std::to_string(order), {"disturbance.kind=" + std::string(row.kind)},
                 "relative_rmse_disturbance");
      EXPECT_EQ(error < 0.05, row.positive[order])
          << row.kind << " order " << order << " " << error;
    }
  }
  for (const char* name : {"order0", "order1", "order2"}) {
    EXPECT_NEAR(metric(name, {"disturbance.kind=high_sine"}, "relative_rmse_disturbance"), 1.0,
                0.01);
  }
}

// Medians over seeds 1 to 5.
double over_seeds(const std::string& case_name, const std::string& form, const std::string& name) {
  std::vector<double> values;
  for (int seed = 1; seed <= 5; ++seed) {
    values.push_back(metric(
        case_name, {"run.seed=" + std::to_string(seed), "observer.covariance_form=" + form}, name));
  }
  return testing::median(values);
}

// Medians over 20 other seeds of the same loop in NumPy, without the engine.
TEST(CartEstimation, ResponseAndNoiseOfTable45ByEquation45AsPrinted) {
  struct Row {
    const char* case_name;
    const char* form;
    double reach_s;
    double noise_N;
  };
  for (const Row& row :
       {Row{"gamma-1.02", "printed", 19.9, 0.0052}, Row{"gamma-1.05", "printed", 6.05, 0.0140},
        Row{"gamma-1.20", "printed", 1.0, 0.0893}, Row{"gamma-1.02", "left", 20.35, 0.0051},
        Row{"gamma-1.05", "left", 6.5, 0.0131}, Row{"gamma-1.20", "left", 1.1, 0.071},
        Row{"gamma-1.02", "symmetric", 22.15, 0.0048}, Row{"gamma-1.05", "symmetric", 8.25, 0.0112},
        Row{"gamma-1.20", "symmetric", 1.6, 0.0449}}) {
    EXPECT_NEAR(over_seeds(row.case_name, row.form, "reach_time_99pct_s"), row.reach_s, 0.25)
        << row.case_name << ' ' << row.form;
    EXPECT_NEAR(over_seeds(row.case_name, row.form, "max_noise_deviation_N"), row.noise_N,
                0.2 * row.noise_N)
        << row.case_name << ' ' << row.form;
  }
  // This is the default.
  EXPECT_EQ(metric("gamma-1.05", {}, "reach_time_99pct_s"),
            metric("gamma-1.05", {"observer.covariance_form=printed"}, "reach_time_99pct_s"));
}

TEST(CartEstimation, SettlingAndNoiseOfTable45BySymmetricForm) {
  const auto symmetric = [](const std::string& case_name, const std::string& name) {
    return over_seeds(case_name, "symmetric", name);
  };
  EXPECT_NEAR(metric("order0", {"run.duration_s=700"}, "settling_time_5pct_s"), 459.0, 10.0);
  const double slow = symmetric("gamma-1.02", "settling_time_5pct_s");
  const double medium = symmetric("gamma-1.05", "settling_time_5pct_s");
  const double fast = symmetric("gamma-1.20", "settling_time_5pct_s");
  EXPECT_NEAR(slow, 14.5, 1.0);
  EXPECT_GT(medium, 4.0);
  EXPECT_LT(medium, 6.5);
  EXPECT_NEAR(fast, 2.9, 0.5);
  EXPECT_NEAR(symmetric("gamma-1.05", "max_noise_N"), 0.0156, 0.25 * 0.0156);
  EXPECT_NEAR(symmetric("gamma-1.20", "max_noise_N"), 0.058, 0.25 * 0.058);
  EXPECT_NEAR(symmetric("gamma-1.02", "rms_noise_N"), 0.003, 0.25 * 0.003);
}

TEST(CartEstimation, OrderingsOfTable47) {
  // Step: γ settles. The conventional and second-order filters do not. Second order with γ
  // overshoots.
  EXPECT_FALSE(run("order0").metric("settling_time_5pct_s"));
  EXPECT_FALSE(run("order2").metric("settling_time_5pct_s"));
  const double diagonal = metric("gamma-diag", {}, "settling_time_5pct_s");
  EXPECT_LT(diagonal, metric("gamma-scalar", {}, "settling_time_5pct_s"));
  EXPECT_LT(diagonal, metric("order2-gamma-scalar", {}, "settling_time_5pct_s"));
  const auto peak = [](const std::string& name) {
    const auto values = run(name).track("control").values("d_hat_N");
    return *std::max_element(values.begin(), values.end());
  };
  EXPECT_GT(peak("order2-gamma-scalar"), 1.3 * 5.0);
  EXPECT_GT(peak("order2-gamma-diag"), 1.3 * 5.0);
  EXPECT_LT(peak("gamma-diag"), 1.3 * 5.0);

  // Ramp and sine: the conventional filter lags far, γ a little, the second-order filters hardly.
  for (const char* kind : {"ramp", "sine"}) {
    const Sets sets = {"disturbance.kind=" + std::string(kind)};
    const char* error = "relative_rmse_disturbance";
    const double conventional = metric("order0", sets, error);
    const double gamma = metric("gamma-diag", sets, error);
    const double order2 = metric("order2", sets, error);
    const double both = metric("order2-gamma-diag", sets, error);
    EXPECT_LT(gamma, 0.7 * conventional) << kind;
    EXPECT_LT(order2, 0.5 * gamma) << kind;
    EXPECT_LT(both, 0.5 * gamma) << kind;
  }
}

// The thesis states that the scalar factor is noisier. These runs do not show it.
TEST(CartEstimation, TheScalarFactorHasNoMoreNoise) {
  EXPECT_LT(metric("gamma-scalar", {}, "rms_noise_N"), metric("gamma-diag", {}, "rms_noise_N"));
}

// 4.2.1.1: "it takes 250 s". The filter averages from the start, so a step at t_step leaves an
// error of d·t_step/t, 4 % at 250 s.
TEST(CartEstimation, TheKfdAverages) {
  const auto rest_at = [](int time_s) {
    return metric(
        "order0",
        {"disturbance.step_N=0.5", "disturbance.step_start_s=10",
         "observer.initial_covariance=[1e-6, 1e-6, 1e-2]", "noise.std_m=0", "noise.input_std_N=0",
         "run.duration_s=500", "metrics.from_s=" + std::to_string(time_s - 1),
         "metrics.to_s=" + std::to_string(time_s)},
        "relative_rmse_disturbance");
  };
  EXPECT_NEAR(rest_at(250), 0.04, 0.0015);
  EXPECT_NEAR(rest_at(500), 0.02, 0.001);
}

}  // namespace
}  // namespace breakwater::cart_estimation_test
