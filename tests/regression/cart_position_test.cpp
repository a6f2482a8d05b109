// Position control of a cart with friction: the figures of 4.2.5.

#include <cmath>

#include "regression/run_case.h"

namespace breakwater::cart_position_test {
namespace {

Recording run(const std::string& case_name, const std::vector<std::string>& sets = {}) {
  Recording recording = testing::run_case("cart_position", case_name, sets);
  EXPECT_FALSE(recording.failure) << case_name;
  return recording;
}

double error_m(const std::string& case_name) {
  return std::abs(run(case_name).metric("steady_state_error_m").value_or(NAN));
}

double noise_N(const std::string& case_name) {
  return run(case_name).metric("rms_highpass_disturbance_N").value_or(NAN);
}

TEST(CartPosition, ForgettingRemovesTheOffsetOfTheKfd) {
  EXPECT_GT(error_m("kfd"), 5e-4);
  for (const char* name : {"mdob", "idob", "gamma-1.05", "gamma-1.10", "gamma-1.20"}) {
    EXPECT_LT(error_m(name), 1e-4) << name;
  }
  EXPECT_LT(error_m("order1-gamma"), error_m("order1"));
  EXPECT_LT(error_m("order2-gamma"), error_m("order2"));
}

TEST(CartPosition, TheFactorDecidesTheNoise) {
  const double kfd = noise_N("kfd");
  const double gamma_1_05 = noise_N("gamma-1.05");
  EXPECT_LT(kfd, gamma_1_05);
  EXPECT_LT(gamma_1_05, noise_N("gamma-1.10"));
  EXPECT_LT(noise_N("gamma-1.10"), noise_N("gamma-1.20"));
  EXPECT_LT(gamma_1_05, noise_N("mdob"));
  EXPECT_LT(gamma_1_05, noise_N("order1-gamma"));
}

// The same position response as the MDOB, with less noise.
TEST(CartPosition, Gamma105SettlesLikeTheMdob) {
  const double mdob = *run("mdob").metric("settling_time_s");
  EXPECT_NEAR(*run("gamma-1.05").metric("settling_time_s"), mdob, 0.1 * mdob);
}

TEST(CartPosition, WithoutCancellationFrictionStopsTheCartEarly) {
  // An almost inactive observer: K_p e = F_C at standstill, and the cart stops earlier.
  const Recording idle = run("mdob", {"observer.low_pass_cutoff_rad_s=1e-6"});
  const double error = *idle.metric("steady_state_error_m");
  EXPECT_GT(error, 1e-3);
  EXPECT_LE(error, 0.3 / 10.0 + 0.04 / 10.0);
}

TEST(CartPosition, RefusesAHighPassAboveTheSamplingRate) {
  EXPECT_THROW(testing::run_case("cart_position", "kfd", {"control.period_s=1e-2"}),
               std::invalid_argument);
}

}  // namespace
}  // namespace breakwater::cart_position_test
