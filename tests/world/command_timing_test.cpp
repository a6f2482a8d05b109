#include <breakwater/world/command_timing.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

namespace breakwater {
namespace {

constexpr double kTick_s = 1e-3;

// The output over each step where sample k sends k + 1.
std::vector<double> outputs(const CommandDelays& delays, int steps, int steps_per_sample = 1,
                            std::uint64_t seed = 1) {
  CommandTiming timing(delays, seed, kTick_s, steps_per_sample, 1);
  std::vector<double> result;
  for (int step = 0; step < steps; ++step) {
    if (step % steps_per_sample == 0) {
      const double command = step / steps_per_sample + 1;
      timing.send(step / steps_per_sample, {&command, 1});
    }
    double output = -1.0;
    timing.receive(step, {&output, 1});
    result.push_back(output);
  }
  return result;
}

TEST(CommandTiming, DelaysByWholeSteps) {
  for (const int late : {0, 1, 3, 17}) {
    const std::vector<double> found = outputs({.delay_s = late * kTick_s}, 60, 4);
    for (int step = 0; step < 60; ++step) {
      ASSERT_EQ(found[static_cast<std::size_t>(step)], step < late ? 0 : (step - late) / 4 + 1);
    }
  }
}

TEST(CommandTiming, APartOfAStepGivesTheMeanOverTheStep) {
  // 2.25 steps: in step 2 + 4 k the new command has 0.75 of the step.
  const std::vector<double> found = outputs({.delay_s = 2.25 * kTick_s}, 20, 4);
  for (std::size_t step = 0; step < 20; ++step) {
    const double before = step < 3 ? 0.0 : std::floor((static_cast<double>(step) - 3) / 4) + 1;
    const double mean = step % 4 == 2 ? before + 0.75 : before;
    EXPECT_NEAR(found[step], mean, 1e-12) << step;
  }
}

TEST(CommandTiming, JitterIsUniformAndOfTheSeed) {
  // One sample in 10 steps: the mean over these steps shows the delay.
  const double jitter_s = 8e-3;
  const int samples = 20000;
  const std::vector<double> found = outputs({.jitter_s = jitter_s}, 10 * samples, 10);
  double sum = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    double output = 0.0;
    for (std::size_t i = 0; i < 10; ++i) output += found[10 * k + i];
    const double delay = (10.0 * static_cast<double>(k + 1) - output) * kTick_s;
    ASSERT_GT(delay, 0.0);
    ASSERT_LT(delay, jitter_s);
    sum += delay;
    squares += delay * delay;
  }
  const double mean = sum / samples, variance = squares / samples - mean * mean;
  // Four standard errors.
  EXPECT_NEAR(mean, jitter_s / 2.0, 4.0 * jitter_s / std::sqrt(12.0 * samples));
  EXPECT_NEAR(variance, jitter_s * jitter_s / 12.0,
              4.0 * jitter_s * jitter_s / std::sqrt(180.0 * samples));
  EXPECT_EQ(outputs({.jitter_s = jitter_s}, 100, 10, 7),
            outputs({.jitter_s = jitter_s}, 100, 10, 7));
  EXPECT_NE(outputs({.jitter_s = jitter_s}, 100, 10, 7),
            outputs({.jitter_s = jitter_s}, 100, 10, 8));
}

TEST(CommandTiming, RepeatsTheDelaysOfATable) {
  const std::vector<double> found = outputs({.jitters_s = {0.0, 2e-3, 1e-3}}, 24, 4);
  for (std::size_t step = 0; step < 24; ++step) {
    const std::size_t k = step / 4;
    const std::size_t late = std::vector<std::size_t>{0, 2, 1}[k % 3];
    EXPECT_EQ(found[step], static_cast<double>(step % 4 < late ? k : k + 1)) << step;
  }
}

TEST(CommandTiming, AnOvertakenCommandIsLost) {
  // Command 1 would arrive at step 6, command 2 at step 1.
  EXPECT_EQ(outputs({.jitters_s = {6e-3, 0.0, 0.0}}, 4), (std::vector<double>{0, 2, 3, 3}));
}

TEST(CommandTiming, HoldsTheLastCommandWhereOneIsDropped) {
  const double probability = 0.3;
  const int samples = 20000;
  const std::vector<double> found = outputs({.drop_probability = probability}, samples);
  int dropped = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    const double before = k == 0 ? 0.0 : found[k - 1];
    const bool is_new = found[k] == static_cast<double>(k + 1);
    ASSERT_TRUE(is_new || found[k] == before);
    dropped += is_new ? 0 : 1;
  }
  EXPECT_NEAR(dropped / double(samples), probability,
              4.0 * std::sqrt(probability * (1.0 - probability) / samples));
}

TEST(CommandTiming, RefusesWhatIsNoDelay) {
  const std::vector<CommandDelays> wrong = {{.delay_s = -1.0},          {.delay_s = std::nan("")},
                                            {.delay_s = 2e3},           {.jitter_s = -1.0},
                                            {.jitters_s = {0.0, -1.0}}, {.drop_probability = 1.0},
                                            {.drop_probability = -0.1}, {.jitter_s = HUGE_VAL}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_THROW(CommandTiming(wrong[i], 1, kTick_s, 1, 1), std::invalid_argument) << i;
  }
}

}  // namespace
}  // namespace breakwater
