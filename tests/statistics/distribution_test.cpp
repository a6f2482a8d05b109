#include <breakwater/statistics/distribution.h>

#include <bit>
#include <cmath>
#include <limits>
#include <sstream>

#include "python.h"

namespace breakwater::distribution_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Arguments up to both tails, as far as those of 2⁵² Sobol' points.
std::vector<double> arguments() {
  std::vector<double> all;
  for (int i = 1; i < 400; ++i) all.push_back(i / 400.0);
  for (int k = 9; k <= 53; ++k) {
    all.push_back(std::ldexp(1.0, -k));
    all.push_back(1.0 - std::ldexp(1.0, -k));
  }
  return all;
}

struct Named {
  DistributionKind kind;
  std::string name;
  double first, second;
};

TEST(Distribution, QuantilesMatchSciPy) {
  const std::vector<Named> distributions = {
      {DistributionKind::uniform, "uniform", 0.06, 0.12},
      {DistributionKind::uniform, "uniform", -3.0, 1e6},
      {DistributionKind::log_uniform, "log_uniform", 500.0, 5000.0},
      {DistributionKind::log_uniform, "log_uniform", 1e-9, 1e3},
      {DistributionKind::normal, "normal", 0.0, 1.0},
      {DistributionKind::normal, "normal", 12.0, 0.25}};
  const std::vector<double> u = arguments();
  std::ostringstream input;
  input.precision(17);
  for (const Named& one : distributions) {
    input << "quantile " << one.name << ' ' << one.first << ' ' << one.second << ' ' << u.size();
    for (const double share : u) input << ' ' << share;
    input << '\n';
  }
  const std::vector<double> scipy = testing::run_python("study/scipy_stats.py", input.str());
  ASSERT_EQ(scipy.size(), distributions.size() * u.size());
  std::size_t at = 0;
  for (const Named& one : distributions) {
    const Distribution distribution(one.kind, one.first, one.second);
    for (const double share : u) {
      const double truth = scipy[at++];
      const double scale = std::abs(one.kind == DistributionKind::log_uniform ? truth : one.first) +
                           std::abs(truth - one.first);
      EXPECT_NEAR(distribution.quantile(share), truth, 2e-15 * scale) << one.name << ' ' << share;
    }
  }
}

TEST(Distribution, ValuesStayWithinTheRange) {
  for (const DistributionKind kind : {DistributionKind::uniform, DistributionKind::log_uniform}) {
    for (const auto& [a, b] :
         {std::pair(0.1, 0.7), std::pair(3.0, 3.0000000000000004), std::pair(1e-300, 1e-3)}) {
      const Distribution distribution(kind, a, b);
      for (const double u : arguments()) {
        EXPECT_GE(distribution.quantile(u), a);
        EXPECT_LE(distribution.quantile(u), b);
      }
    }
  }
}

std::string reason(DistributionKind kind, double first, double second) {
  return complaint_of([&] { const Distribution made(kind, first, second); });
}

TEST(Distribution, RefusesInvalidArguments) {
  using enum DistributionKind;
  EXPECT_EQ(reason(uniform, 0.12, 0.06), "the range [0.12, 0.06] is upside down");
  EXPECT_EQ(reason(log_uniform, 2.0, 1.0), "the range [2, 1] is upside down");
  EXPECT_EQ(reason(uniform, 1.0, 1.0), "the range [1, 1] is empty");
  EXPECT_EQ(reason(log_uniform, 0.0, 1.0), "a logarithmic range must be positive, and begins at 0");
  EXPECT_EQ(reason(log_uniform, -1.0, 1.0),
            "a logarithmic range must be positive, and begins at -1");
  EXPECT_EQ(reason(normal, 1.0, 0.0), "the standard deviation must be positive, not 0");
  EXPECT_EQ(reason(normal, 1.0, -2.0), "the standard deviation must be positive, not -2");
  for (const double bad : {kNaN, kInf, -kInf}) {
    for (const DistributionKind kind : {uniform, log_uniform, normal}) {
      EXPECT_EQ(reason(kind, bad, 1.0), "must be two finite numbers");
      EXPECT_EQ(reason(kind, 1.0, bad), "must be two finite numbers");
    }
  }
  EXPECT_EQ(reason(uniform, -1e308, 1e308), "the range [-1e+308, 1e+308] is too wide");
  EXPECT_EQ(reason(log_uniform, 1e-200, 1e200), "the range [1e-200, 1e+200] is too wide");
  const Distribution standard(normal, 0.0, 1.0);
  for (const double u : {0.0, 1.0, -0.1, kNaN}) {
    EXPECT_THROW(standard.quantile(u), std::invalid_argument) << u;
  }
}

// On every processor: a study identifies a point by the hash of its configuration.
TEST(Distribution, BitsAreTheSameEverywhere) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const DistributionKind kind :
       {DistributionKind::uniform, DistributionKind::log_uniform, DistributionKind::normal}) {
    const Distribution distribution(kind, 0.3, 7.0);
    for (const double u : arguments()) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(distribution.quantile(u))) * 1099511628211ULL;
    }
  }
  EXPECT_EQ(hash, 0x52fcba5fbe8d7c4cULL) << std::hex << hash;
}

}  // namespace
}  // namespace breakwater::distribution_test
