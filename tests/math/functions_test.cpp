// The elementary functions of math/: accuracy, special arguments and bits.
#include <bit>
#include <cstdint>

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include "support.h"

namespace breakwater::functions_test {

constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr double kHuge = std::numeric_limits<double>::max();

// The error in units in the last place of the true double.
double error_ulp(double value, long double truth) {
  const auto rounded = static_cast<double>(truth);
  if (value == rounded) return 0.0;
  const double gap = std::nextafter(std::abs(rounded), kInfinity) - std::abs(rounded);
  return static_cast<double>(std::abs(static_cast<long double>(value) - truth)) / gap;
}

using Function = double (*)(double);
using Truth = long double (*)(long double);

struct Range {
  double from, to;
};

// Half of the arguments are spread evenly, half evenly in the logarithm. They have both signs if
// the range does.
std::vector<double> arguments(Range range) {
  testing::Random random;
  std::vector<double> all;
  for (int i = 0; i < 20000; ++i) {
    all.push_back(random.uniform(range.from, range.to));
    const double bound = all.back() < 0.0 ? range.from : range.to;
    all.push_back(bound * std::exp2(-random.uniform(0.0, 60.0)));
  }
  return all;
}

double largest_error(Function function, Truth truth, Range range) {
  double largest = 0.0;
  for (const double x : arguments(range)) {
    largest = std::max(largest, error_ulp(function(x), truth(x)));
  }
  return largest;
}

TEST(Math, IsWithinUnitsInTheLastPlace) {
  EXPECT_LT(largest_error(math::sin, std::sin, {-100.0, 100.0}), 1.0);
  EXPECT_LT(largest_error(math::cos, std::cos, {-100.0, 100.0}), 1.0);
  EXPECT_LT(largest_error(math::tan, std::tan, {-100.0, 100.0}), 1.0);
  EXPECT_LT(largest_error(math::sin, std::sin, {-1e18, 1e18}), 1.0);
  EXPECT_LT(largest_error(math::cos, std::cos, {-1e18, 1e18}), 1.0);
  EXPECT_LT(largest_error(math::tan, std::tan, {-1e18, 1e18}), 1.0);
  EXPECT_LT(largest_error(math::asin, std::asin, {-1.0, 1.0}), 1.0);
  EXPECT_LT(largest_error(math::acos, std::acos, {-1.0, 1.0}), 1.0);
  EXPECT_LT(largest_error(math::exp, std::exp, {-745.0, 709.0}), 1.0);
  EXPECT_LT(largest_error(math::expm1, std::expm1, {-40.0, 709.0}), 1.0);
  EXPECT_LT(largest_error(math::log, std::log, {kTiny, 4.0}), 1.0);
  EXPECT_LT(largest_error(math::log, std::log, {kTiny, kHuge}), 1.0);
  EXPECT_LT(largest_error(math::tanh, std::tanh, {-20.0, 20.0}), 2.5);
  EXPECT_LT(largest_error(math::erfc, std::erfc, {-6.0, 26.0}), 4.0);
}

TEST(Math, WithTwoArgumentsIsWithinUnitsInTheLastPlace) {
  testing::Random random;
  double of_atan2 = 0.0, of_pow = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double y = random.uniform(-10.0, 10.0), x = random.uniform(-10.0, 10.0);
    const long double angle = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    of_atan2 = std::max(of_atan2, error_ulp(math::atan2(y, x), angle));
    const double base = std::exp2(random.uniform(-40.0, 40.0));
    const long double power = std::pow(static_cast<long double>(base), static_cast<long double>(x));
    of_pow = std::max(of_pow, error_ulp(math::pow(base, x), power));
  }
  EXPECT_LT(of_atan2, 1.5);
  EXPECT_LT(of_pow, 1.0);
}

TEST(Math, SineAndCosineTogetherEqualTheSeparateFunctions) {
  for (const Range range : {Range{-100.0, 100.0}, Range{0.0, kHuge}}) {
    for (const double x : arguments(range)) {
      const auto [sine, cosine] = math::sincos(x);
      EXPECT_EQ(sine, math::sin(x));
      EXPECT_EQ(cosine, math::cos(x));
    }
  }
}

bool same(double a, double b) {
  return std::isnan(a) ? std::isnan(b)
                       : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Annex F of C99, which glibc follows.
TEST(Math, SpecialArgumentsFollowTheStandard) {
  const std::vector<std::pair<Function, Function>> pairs = {
      {math::sin, std::sin},     {math::cos, std::cos},   {math::tan, std::tan},
      {math::asin, std::asin},   {math::acos, std::acos}, {math::exp, std::exp},
      {math::expm1, std::expm1}, {math::log, std::log},   {math::tanh, std::tanh},
      {math::erfc, std::erfc}};
  const std::vector<double> special = {0.0,        -0.0, 1.0,   -1.0,  kInfinity,
                                       -kInfinity, kNaN, kTiny, -kTiny};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const double x : special) {
      const double ours = pairs[i].first(x), theirs = pairs[i].second(x);
      const bool is_exact = !std::isfinite(theirs) || theirs == 0.0 || std::abs(theirs) == 1.0;
      EXPECT_TRUE(!is_exact || same(ours, theirs)) << i << " of " << x << ": " << ours;
    }
  }
  for (const double y : special) {
    for (const double x : special) {
      EXPECT_TRUE(same(math::atan2(y, x), std::atan2(y, x))) << y << " " << x;
      EXPECT_TRUE(same(math::pow(y, x), std::pow(y, x))) << y << " " << x;
    }
  }
  EXPECT_EQ(math::exp(710.0), kInfinity);
  EXPECT_EQ(math::exp(-746.0), 0.0);
  EXPECT_TRUE(std::isnan(math::asin(1.0000000000000002)));
  for (int n = 0; n <= 60; ++n) EXPECT_EQ(math::pow(2.0, n), std::ldexp(1.0, n));
}

TEST(Math, ComplexExponentialAndLogarithm) {
  const std::complex<double> z = math::exp(std::complex<double>(-0.3, 2.0));
  EXPECT_NEAR(std::abs(z - std::polar(std::exp(-0.3), 2.0)), 0.0, 2e-16);
  const std::complex<double> back = math::log(z);
  EXPECT_NEAR(back.real(), -0.3, 2e-16);
  EXPECT_NEAR(back.imag(), 2.0, 5e-16);
  EXPECT_EQ(math::exp(std::complex<double>(1.0, -0.0)).imag(), 0.0);  // a real pole stays real
  EXPECT_EQ(math::log(std::complex<double>(-1.0, 0.0)).imag(), std::numbers::pi);
}

// The FNV-1a hash of the bits of many values.
std::uint64_t bits_of(Function function, Range range) {
  std::uint64_t hash = 14695981039346656037ULL;
  // Exact operations on integers make the arguments equal everywhere.
  for (int i = 0; i <= 100000; ++i) {
    const double x = range.from + (range.to - range.from) * (i / 131072.0);
    hash = (hash ^ std::bit_cast<std::uint64_t>(function(x))) * 1099511628211ULL;
  }
  return hash;
}

// On every x86-64 processor with every release of musl. Otherwise the goldens of the scenarios
// change.
TEST(Math, BitsAreTheSameEverywhere) {
  const auto atan2 = [](double x) { return math::atan2(x, 0.75); };
  const auto pow = [](double x) { return math::pow(x, -4.7); };
  EXPECT_EQ(bits_of(math::sin, {-64.0, 64.0}), 0x1e37738c432aaeb4ULL);
  EXPECT_EQ(bits_of(math::cos, {-64.0, 64.0}), 0x07236f18aaeb9457ULL);
  EXPECT_EQ(bits_of(math::sin, {0.0, 1e9}), 0xcefe9a6d39ad3dafULL);
  EXPECT_EQ(bits_of(math::tan, {-2.0, 2.0}), 0xb8d82913ebfb2fa8ULL);
  EXPECT_EQ(bits_of(math::asin, {-1.0, 1.0}), 0x84913713dde45500ULL);
  EXPECT_EQ(bits_of(math::acos, {-1.0, 1.0}), 0xb7afd55bcab09befULL);
  EXPECT_EQ(bits_of(atan2, {-4.0, 4.0}), 0x6faa59c483afdd93ULL);
  EXPECT_EQ(bits_of(math::exp, {-32.0, 32.0}), 0xf892fee62bb4d7fbULL);
  EXPECT_EQ(bits_of(math::expm1, {-2.0, 2.0}), 0x1bfeebbbf271d38dULL);
  EXPECT_EQ(bits_of(math::log, {0.0, 16.0}), 0xdb57a104ede782deULL);
  EXPECT_EQ(bits_of(pow, {0.25, 16.0}), 0x657dadc605fecdbcULL);
  EXPECT_EQ(bits_of(math::tanh, {-4.0, 4.0}), 0x9b8693921705070bULL);
}

// Mills' ratio against the C library's erfc in extended precision.

TEST(MillsRatio, MatchesTheNormalTail) {
  for (double x = 0.0; x < 100.0; x += x < 8.0 ? 1.0 / 128.0 : 0.25) {
    const long double z = x;
    const long double truth = std::erfc(z / std::sqrt(2.0L)) * std::exp(z * z / 2.0L) *
                              std::sqrt(std::acos(-1.0L) / 2.0L);
    EXPECT_NEAR(math::mills_ratio(x) / static_cast<double>(truth), 1.0, 2e-15) << x;
  }
}

// 1/x − 1/x³ < (1 − Φ)/φ < 1/x, where erfc underflows.
TEST(MillsRatio, FollowsItsBoundsWhereTheTailUnderflows) {
  for (const double x : {1e3, 1e6, 1e150, 1e300}) {
    EXPECT_LE(math::mills_ratio(x), (1.0 + 1e-15) / x);
    EXPECT_GE(math::mills_ratio(x), (1.0 - 1e-15) * (1.0 - 1.0 / x / x) / x);
  }
  EXPECT_EQ(math::mills_ratio(kInfinity), 0.0);
}

}  // namespace breakwater::functions_test
