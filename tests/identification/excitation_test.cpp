#include <breakwater/identification/excitation.h>
#include <breakwater/identification/friction_axis.h>

#include <algorithm>
#include <cmath>

#include "support.h"

namespace breakwater::excitation_test {
namespace {

TEST(Excitation, TheDesignHasSmallerIntervalsThanAChirpAndBinarySequences) {
  const ExcitationLimits limits{.torque = 5.0, .speed = 20.0, .duration_s = 5.0, .period_s = 2e-3};
  const AxisValues axis = guessed_axis(limits, 0.0);
  const std::vector<double> inputs = designed_excitation(limits, axis, 60);
  ASSERT_EQ(inputs.size(), 2500U);
  const std::vector<double> designed = expected_std(inputs, limits, axis);
  std::vector<std::vector<double>> others = {chirp(limits, axis)};
  for (const double clock_s : {0.02, 0.05, 0.1}) {
    others.push_back(binary_sequence(limits, axis, clock_s));
  }
  for (const std::vector<double>& other : others) {
    ASSERT_EQ(other.size(), inputs.size());
    const std::vector<double> std = expected_std(other, limits, axis);
    for (std::size_t i = 0; i < std.size(); ++i) EXPECT_LT(designed[i], std[i]) << i;
  }
  EXPECT_LT(worst_ratio(inputs, limits, axis), 1.0);
  EXPECT_EQ(designed_excitation(limits, axis, 60), inputs);
}

TEST(Excitation, TheLimitsAreKept) {
  const ExcitationLimits limits{.torque = 5.0, .speed = 20.0, .duration_s = 2.0, .period_s = 2e-3};
  const AxisValues axis = guessed_axis(limits, 0.02);
  for (const std::vector<double>& inputs :
       {designed_excitation(limits, axis, 6), chirp(limits, axis),
        binary_sequence(limits, axis, 0.1)}) {
    AxisStretch stretch;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      EXPECT_LE(std::abs(inputs[k]), limits.torque);
      stretch.times_s.push_back(static_cast<double>(k) * limits.period_s);
    }
    stretch.input_times_s = stretch.times_s;
    stretch.inputs = inputs;
    std::vector<double> q(inputs.size());
    move_axis(axis, {}, stretch, q);
    for (std::size_t k = 1; k < q.size(); ++k) {
      EXPECT_LE(std::abs(q[k] - q[k - 1]) / limits.period_s, limits.speed * (1.0 + 1e-9));
    }
  }
}

}  // namespace
}  // namespace breakwater::excitation_test
