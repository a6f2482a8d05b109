#include <breakwater/statistics/binomial.h>

#include <algorithm>

#include <breakwater/math/functions.h>

namespace breakwater {

std::vector<double> binomial_cdf(std::size_t n, double p) {
  const double log_p = math::log(p), log_q = math::log(1.0 - p);
  std::vector<double> cdf(n + 1);
  double log_choose = 0.0;  // logarithm of the binomial coefficient (n, i)
  double sum = 0.0;
  for (std::size_t i = 0; i <= n; ++i) {
    const auto successes = static_cast<double>(i), failures = static_cast<double>(n - i);
    sum += math::exp(log_choose + successes * log_p + failures * log_q);
    cdf[i] = std::min(sum, 1.0);
    log_choose += math::log(failures > 0.0 ? failures : 1.0) - math::log(successes + 1.0);
  }
  cdf[n] = 1.0;
  return cdf;
}

std::optional<ConfidenceInterval> quantile_interval(const std::vector<double>& sorted, double p,
                                                    double level) {
  if (sorted.empty()) return std::nullopt;
  const double tail = 0.5 * (1.0 - level);
  const std::vector<double> cdf = binomial_cdf(sorted.size(), p);
  // l and u count from 1: P(X < l) = cdf[l − 1], P(X ≥ u) = 1 − cdf[u − 1].
  std::size_t l = 0;
  while (l < sorted.size() && cdf[l] <= tail) ++l;
  std::size_t u = sorted.size() + 1;
  while (u > 1 && 1.0 - cdf[u - 2] <= tail) --u;
  if (l < 1 || u > sorted.size()) return std::nullopt;
  return ConfidenceInterval{sorted[l - 1], sorted[u - 1]};
}

ConfidenceInterval share_interval(std::size_t successes, std::size_t n, double level) {
  const double tail = 0.5 * (1.0 - level);
  // The p at which P(X ≤ s) falls to `target`.
  const auto falls_to = [&](std::size_t s, double target) {
    double low = 0.0, high = 1.0;
    while (high - low > 1e-11) {
      const double p = 0.5 * (low + high);
      (binomial_cdf(n, p)[s] > target ? low : high) = p;
    }
    return 0.5 * (low + high);
  };
  return {successes == 0 ? 0.0 : falls_to(successes - 1, 1.0 - tail),
          successes == n ? 1.0 : falls_to(successes, tail)};
}

double mcnemar_exact(std::size_t first, std::size_t second) {
  if (first + second == 0) return 1.0;
  return std::min(1.0, 2.0 * binomial_cdf(first + second, 0.5)[std::min(first, second)]);
}

}  // namespace breakwater
