#include <breakwater/statistics/signed_rank.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <breakwater/math/error_function.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostExact = 200;

// P(S = s) for the sum S of the ranks whose fair coin shows heads.
std::vector<double> distribution_of_sum(const std::vector<std::size_t>& ranks) {
  std::vector<double> probability(1 + std::accumulate(ranks.begin(), ranks.end(), std::size_t{0}));
  probability[0] = 1.0;
  std::size_t largest = 0;
  for (const std::size_t rank : ranks) {
    largest += rank;
    for (std::size_t s = largest + 1; s-- > 0;) {
      probability[s] = 0.5 * (probability[s] + (s >= rank ? probability[s - rank] : 0.0));
    }
  }
  return probability;
}

}  // namespace

std::vector<double> mid_ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k) {
      ranks[order[k]] = 0.5 * static_cast<double>(i + 1 + end);
    }
    i = end;
  }
  return ranks;
}

SignedRank signed_rank_test(const std::vector<double>& differences) {
  std::vector<double> sizes;
  for (const double d : differences) sizes.push_back(std::abs(d));
  const std::vector<double> ranks = mid_ranks(sizes);
  SignedRank test;
  std::vector<std::size_t> doubled;  // doubled mid-ranks are integers
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    if (differences[i] == 0.0) continue;
    if (differences[i] > 0.0) test.statistic += ranks[i];
    sum += ranks[i];
    squares += ranks[i] * ranks[i];
    doubled.push_back(static_cast<std::size_t>(2.0 * ranks[i]));
  }
  test.nonzero = doubled.size();
  if (test.nonzero == 0) return test;
  if (test.nonzero > kMostExact) {
    test.is_exact = false;
    const double distance = std::abs(test.statistic - 0.5 * sum);
    const double z = std::max(0.0, distance - 0.5) / std::sqrt(0.25 * squares);
    test.p = std::min(1.0, 2.0 * normal_cdf(-z));
    return test;
  }
  const std::vector<double> probability = distribution_of_sum(doubled);
  const auto w = static_cast<std::ptrdiff_t>(2.0 * test.statistic);
  const double at_most = std::accumulate(probability.begin(), probability.begin() + w + 1, 0.0);
  const double at_least = std::accumulate(probability.begin() + w, probability.end(), 0.0);
  test.p = std::min(1.0, 2.0 * std::min(at_most, at_least));
  return test;
}

}  // namespace breakwater
