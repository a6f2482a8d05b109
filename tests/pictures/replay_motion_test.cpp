// The data of a replay's page: its times, and compressed numbers.
#include <breakwater/pictures/replay_data.h>

#include "support.h"

namespace breakwater::replay_motion_test {

// As the page reads a channel of `count` values that begins at `at`, which moves behind it.
std::vector<double> read_channel(std::span<const std::uint8_t> bytes, std::size_t& at,
                                 std::size_t count, double unit) {
  std::vector<double> values;
  std::int64_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t word = 0;
    std::uint8_t byte = 128U;
    for (unsigned shift = 0; (byte & 128U) != 0; shift += 7) {
      if (at >= bytes.size() || shift > 63) throw std::invalid_argument("a channel is cut off");
      byte = bytes[at++];
      word |= static_cast<std::uint64_t>(byte & 127U) << shift;
    }
    last += static_cast<std::int64_t>(word >> 1U) ^ -static_cast<std::int64_t>(word & 1U);
    values.push_back(static_cast<double>(last) * unit);
  }
  return values;
}

TEST(MotionCodec, NumbersRoundTripWithinAUnit) {
  testing::Random random(3);
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) values.push_back(random.uniform(-2.0, 2.0) * std::pow(10.0, i % 7));
  std::vector<std::uint8_t> bytes;
  append_channel(values, 1e-3, bytes);
  std::size_t at = 0;
  const std::vector<double> back = read_channel(bytes, at, values.size(), 1e-3);
  EXPECT_EQ(at, bytes.size());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(back[i], values[i], 0.51e-3);
}

// By hand: 3, −1 and 200 units have the differences 3, −4, 201, in zigzag code 6, 7, 402 = 3·128 +
// 18.
TEST(MotionCodec, HasTheBytesOfItsDescription) {
  std::vector<std::uint8_t> bytes;
  append_channel(std::vector{0.3, -0.1, 20.0}, 0.1, bytes);
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{6, 7, 128 + 18, 3}));
}

TEST(MotionCodec, RepeatsTheLastValueForNanAndRefusesATruncatedChannel) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::uint8_t> bytes;
  append_channel(std::vector{1.0, nan, 1.0 / 0.0, 2.0}, 0.5, bytes);
  std::size_t at = 0;
  EXPECT_EQ(read_channel(bytes, at, 4, 0.5), (std::vector{1.0, 1.0, 1.0, 2.0}));
  at = 0;
  EXPECT_THROW(read_channel(bytes, at, 5, 0.5), std::invalid_argument);
}

std::vector<double> log_times(double end_s, double step_s) {
  std::vector<double> times;
  for (int i = 0; i <= std::lround(end_s / step_s); ++i) times.push_back(i * step_s);
  return times;
}

TEST(ReplayTimes, AreSixtyPerSecondAlsoInSlowMotion) {
  const std::vector<TimeSpan> spans = replay_times(log_times(100.0, 0.001), {29.9, 31.5, 0.1});
  const std::vector<double> times = times_of(spans);
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_NEAR(times.back(), 100.0, 1e-9);
  double inside = 0.0;
  double outside = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    ASSERT_GT(times[i], times[i - 1]);
    double& largest = times[i] > 29.9 && times[i] < 31.5 ? inside : outside;
    largest = std::max(largest, times[i] - times[i - 1]);
  }
  EXPECT_NEAR(outside, 1.0 / 60.0, 1e-4);
  EXPECT_NEAR(inside, 0.1 / 60.0, 1e-5);
}

TEST(ReplayTimes, AreLimitedByTheLogAndThePage) {
  const auto coarse = times_of(replay_times(log_times(10.0, 0.1), {2.0, 4.0, 0.01}));
  EXPECT_EQ(coarse.size(), 101U);
  const auto many = times_of(replay_times(log_times(1e5, 0.5), {0.0, 1e5, 1.0}));
  EXPECT_LE(many.size(), 40001U);
  EXPECT_NEAR(many.back(), 1e5, 1e-6);
}

}  // namespace breakwater::replay_motion_test
