// Points in the unit cube: the properties of each method, and SciPy's points.
#include <breakwater/study/sampling.h>

#include <bit>

#include "python.h"

namespace breakwater::sampling_test {

using enum SamplingMethod;

const std::vector<SamplingMethod> kMethods = {random, latin_hypercube, sobol, saltelli};

Eigen::MatrixXd points(SamplingMethod method, std::uint64_t n, Eigen::Index d, std::uint64_t seed) {
  const auto sampler = make_sampler(method, n, d, seed);
  Eigen::MatrixXd all(static_cast<Eigen::Index>(sampler->size()), d);
  for (Eigen::Index i = 0; i < all.rows(); ++i) all.row(i) = sampler->point(i).transpose();
  return all;
}

// Whether each of n equal intervals contains exactly one of the n values of a coordinate.
bool hits_each_interval_once(const Eigen::VectorXd& u) {
  std::set<double> intervals;
  for (const double value : u) intervals.insert(std::floor(value * static_cast<double>(u.size())));
  return static_cast<Eigen::Index>(intervals.size()) == u.size() && *intervals.begin() == 0.0 &&
         *intervals.rbegin() == static_cast<double>(u.size() - 1);
}

TEST(Sampling, SobolPointsMatchSciPy) {
  const std::vector<std::pair<Eigen::Index, Eigen::Index>> sizes = {
      {4096, 3}, {1024, 40}, {64, 3667}};
  std::ostringstream input;
  for (const auto& [n, d] : sizes) input << "sobol " << n << ' ' << d << '\n';
  const std::vector<double> scipy = testing::run_python("study/scipy_stats.py", input.str());
  std::size_t at = 0;
  for (const auto& [n, d] : sizes) {
    const SobolSequence sequence(d);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < d; ++j) {
        ASSERT_LT(at, scipy.size());
        const double ours = std::ldexp(static_cast<double>(sequence.coordinate(i, j)), -64);
        ASSERT_EQ(ours, scipy[at++]) << i << ' ' << j;
      }
    }
  }
  EXPECT_EQ(at, scipy.size());
}

// XOR with another point removes the shift of a Sobol' point.
TEST(Sampling, SobolIsTheSequenceWithADigitalShift) {
  const SobolSequence sequence(5);
  const auto bits = [](double u) { return static_cast<std::uint64_t>(std::ldexp(u, 52)); };
  for (const std::uint64_t seed : {1, 2}) {
    const auto sampler = make_sampler(sobol, std::uint64_t{1} << 40, 5, seed);
    const Eigen::VectorXd first = sampler->point(0);
    for (const std::uint64_t i : {1ULL, 2ULL, 77ULL, 123456789ULL, (1ULL << 40) - 1}) {
      const Eigen::VectorXd u = sampler->point(i);
      for (Eigen::Index j = 0; j < 5; ++j) {
        EXPECT_EQ(bits(u(j)) ^ bits(first(j)), sequence.coordinate(i, j) >> 12) << i << ' ' << j;
      }
    }
  }
}

TEST(Sampling, SobolHitsEachIntervalOnce) {
  const Eigen::MatrixXd u = points(sobol, 1024, 7, 3);
  for (Eigen::Index n = 1; n <= 1024; n *= 2) {
    for (Eigen::Index j = 0; j < 7; ++j) {
      EXPECT_TRUE(hits_each_interval_once(u.col(j).head(n))) << n << ' ' << j;
    }
  }
}

TEST(Sampling, LatinHypercubeHitsEachIntervalOnce) {
  for (const std::uint64_t n : {1, 2, 3, 5, 16, 17, 100, 1000, 65537}) {
    const Eigen::MatrixXd u = points(latin_hypercube, n, 4, n);
    for (Eigen::Index j = 0; j < 4; ++j) EXPECT_TRUE(hits_each_interval_once(u.col(j))) << n;
  }
}

// Also for the largest numbers, where the edges of an interval differ by few last digits.
TEST(Sampling, LatinHypercubeOfManyPointsStaysInside) {
  const std::uint64_t n = std::uint64_t{1} << 40;
  const auto sampler = make_sampler(latin_hypercube, n, 2, 1);
  for (std::uint64_t i = 0; i < 100000; ++i) {
    const Eigen::VectorXd u = sampler->point(i);
    EXPECT_TRUE(u.minCoeff() > 0.0 && u.maxCoeff() < 1.0);
    const double place = u(0) * static_cast<double>(n);
    EXPECT_NE(place, std::floor(place));
  }
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// The mean discrepancy is within four standard errors of SciPy's. That of random points is 6.6
// times larger, that of Sobol' points 0.27 times.
TEST(Sampling, DiscrepancyOfLatinHypercubesMatchesSciPy) {
  constexpr int kSets = 200;
  constexpr Eigen::Index kPoints = 64, kDimension = 3;
  std::ostringstream input;
  input.precision(17);
  input << "latin_hypercube " << kPoints << ' ' << kDimension << ' ' << kSets << '\n';
  for (const SamplingMethod method : {latin_hypercube, random, sobol}) {
    for (int seed = 0; seed < kSets; ++seed) {
      input << "discrepancy " << kPoints << ' ' << kDimension << '\n'
            << points(method, kPoints, kDimension, seed) << '\n';
    }
  }
  const std::vector<double> all = testing::run_python("study/scipy_stats.py", input.str());
  ASSERT_EQ(all.size(), 4U * kSets);
  const std::vector<double> scipy(all.begin(), all.begin() + kSets);
  const std::vector<double> ours(all.begin() + kSets, all.begin() + 2 * kSets);
  const std::vector<double> at_random(all.begin() + 2 * kSets, all.begin() + 3 * kSets);
  const std::vector<double> of_sobol(all.begin() + 3 * kSets, all.end());
  const double mean = mean_of(scipy);
  double squares = 0.0;
  for (const double value : scipy) squares += (value - mean) * (value - mean);
  const double standard_error = std::sqrt(squares / kSets / kSets);
  EXPECT_NEAR(mean_of(ours), mean, 4.0 * std::sqrt(2.0) * standard_error);
  EXPECT_GT(mean_of(at_random), 5.0 * mean);
  EXPECT_LT(mean_of(of_sobol), mean / 3.0);
}

// All orders of n intervals are equally frequent: χ² with n! − 1 degrees of freedom, at 0.1 %.
void expect_all_orders(int n, std::size_t orders, double chi_squared_0_1_percent) {
  constexpr int kSets = 48000;
  std::map<std::vector<int>, int> counts;
  for (int seed = 0; seed < kSets; ++seed) {
    const Eigen::MatrixXd u = points(latin_hypercube, n, 1, seed);
    std::vector<int> order;
    for (const double value : u.col(0)) order.push_back(static_cast<int>(n * value));
    ++counts[order];
  }
  ASSERT_EQ(counts.size(), orders);
  const double expected = kSets / static_cast<double>(orders);
  double chi_squared = 0.0;
  for (const auto& [order, count] : counts) chi_squared += std::pow(count - expected, 2);
  EXPECT_LT(chi_squared / expected, chi_squared_0_1_percent) << n;
}

// Four numbers are permuted directly, five as part of sixteen.
TEST(Sampling, AllPermutationsOfLatinHypercubesAreEquallyLikely) {
  expect_all_orders(4, 24, 49.7);
  expect_all_orders(5, 120, 173.6);
}

// Means and correlations are within 4.5/√n.
TEST(Sampling, CoordinatesAreUniformAndUncorrelated) {
  constexpr int n = 10000;
  for (const SamplingMethod method : {random, latin_hypercube, sobol}) {
    Eigen::MatrixXd u = points(method, n, 6, 11);
    EXPECT_GT(u.minCoeff(), 0.0);
    EXPECT_LT(u.maxCoeff(), 1.0);
    u.array() = (u.array() - 0.5) * std::sqrt(12.0);
    const Eigen::MatrixXd covariance = u.transpose() * u / n;
    EXPECT_LT((covariance - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(),
              4.5 / std::sqrt(n));
    EXPECT_LT(u.colwise().mean().cwiseAbs().maxCoeff(), 4.5 / std::sqrt(n));
  }
}

TEST(Sampling, SaltelliDesignSwapsOneCoordinate) {
  constexpr Eigen::Index n = 64, d = 3;
  const Eigen::MatrixXd u = points(saltelli, n, d, 5);
  ASSERT_EQ(u.rows(), n * (d + 2));
  Eigen::MatrixXd both(n, 2 * d);
  for (Eigen::Index row = 0; row < n; ++row) {
    const auto A = u.row(row * (d + 2)), B = u.row(row * (d + 2) + d + 1);
    for (Eigen::Index i = 0; i < d; ++i) {
      const auto AB = u.row(row * (d + 2) + 1 + i);
      for (Eigen::Index j = 0; j < d; ++j) EXPECT_EQ(AB(j), i == j ? B(j) : A(j));
    }
    both.row(row) << A, B;
  }
  for (Eigen::Index j = 0; j < 2 * d; ++j) EXPECT_TRUE(hits_each_interval_once(both.col(j)));
  EXPECT_EQ(both, points(sobol, n, 2 * d, 5));
}

TEST(Sampling, DependsOnTheSeedAndNotOnTheOrder) {
  for (const SamplingMethod method : kMethods) {
    const auto sampler = make_sampler(method, 50, 3, 7);
    const Eigen::VectorXd late = sampler->point(40);
    sampler->point(3);
    EXPECT_EQ(sampler->point(40), late);
    EXPECT_EQ(make_sampler(method, 50, 3, 7)->point(40), late);
    EXPECT_NE(make_sampler(method, 50, 3, 8)->point(40), late);
  }
}

TEST(Sampling, ALargerStudyKeepsTheFirstPoints) {
  for (const SamplingMethod method : {random, sobol, saltelli}) {
    const Eigen::MatrixXd few = points(method, 32, 3, 7), many = points(method, 64, 3, 7);
    EXPECT_EQ(few, many.topRows(few.rows()));
  }
}

TEST(Sampling, RefusesInvalidArguments) {
  for (const SamplingMethod method : kMethods) {
    EXPECT_THROW(make_sampler(method, 0, 3, 1), std::invalid_argument);
    EXPECT_THROW(make_sampler(method, 3, 0, 1), std::invalid_argument);
    EXPECT_THROW(make_sampler(method, ~std::uint64_t{0}, 3, 1), std::invalid_argument);
    EXPECT_THROW(make_sampler(method, 10, 2, 1)->point(40), std::out_of_range);
  }
  EXPECT_THROW(make_sampler(sobol, 8, 3668, 1), std::invalid_argument);
  EXPECT_THROW(make_sampler(saltelli, 8, 1834, 1), std::invalid_argument);
}

// On every processor: a study identifies a point by the hash of its configuration.
TEST(Sampling, BitsAreTheSameEverywhere) {
  const std::map<SamplingMethod, std::uint64_t> golden = {{random, 0xc18e11f0ce77e1ebULL},
                                                          {latin_hypercube, 0xd06a40b0c8b64ed6ULL},
                                                          {sobol, 0xb33ba20fdcdf5943ULL},
                                                          {saltelli, 0xed0ef86c79403819ULL}};
  for (const SamplingMethod method : kMethods) {
    std::uint64_t hash = 14695981039346656037ULL;
    const Eigen::MatrixXd all = points(method, 100, 4, 42);
    for (const double u : all.reshaped()) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(u)) * 1099511628211ULL;
    }
    EXPECT_EQ(hash, golden.at(method)) << std::hex << hash;
  }
}

}  // namespace breakwater::sampling_test
