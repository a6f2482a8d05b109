#include <breakwater/statistics/distribution.h>

#include <fmt/format.h>

#include <array>
#include <stdexcept>

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

namespace {

// c[0] + c[1] x + … + c[7] x⁷.
double polynomial(const std::array<double, 8>& c, double x) {
  double value = c[7];
  for (int i = 6; i >= 0; --i) value = value * x + c[i];
  return value;
}

}  // namespace

Distribution::Distribution(DistributionKind kind, double first, double second)
    : kind_(kind), first_(first), second_(second) {
  if (!std::isfinite(first) || !std::isfinite(second)) {
    throw std::invalid_argument("must be two finite numbers");
  }
  if (kind == DistributionKind::normal) {
    if (second <= 0.0) {
      throw std::invalid_argument(
          fmt::format("the standard deviation must be positive, not {}", second));
    }
    return;
  }
  if (first >= second) {
    throw std::invalid_argument(
        first > second ? fmt::format("the range [{}, {}] is upside down", first, second)
                       : fmt::format("the range [{}, {}] is empty", first, second));
  }
  const bool is_log = kind == DistributionKind::log_uniform;
  if (is_log && first <= 0.0) {
    throw std::invalid_argument(
        fmt::format("a logarithmic range must be positive, and begins at {}", first));
  }
  if (!std::isfinite(is_log ? second / first : second - first)) {
    throw std::invalid_argument(fmt::format("the range [{}, {}] is too wide", first, second));
  }
}

double Distribution::quantile(double u) const {
  if (!(u > 0.0 && u < 1.0)) throw std::invalid_argument("a quantile's u must be in (0, 1)");
  switch (kind_) {
    case DistributionKind::uniform:
      return std::clamp(first_ + (second_ - first_) * u, first_, second_);
    case DistributionKind::log_uniform:
      return std::clamp(first_ * math::pow(second_ / first_, u), first_, second_);
    case DistributionKind::normal:
      return first_ + second_ * normal_quantile(u);
  }
  throw std::logic_error("no such distribution");
}

// Boost uses the C library's logarithm, which differs between processors.
double normal_quantile(double u) {
  const double q = u - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q *
           polynomial({3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3,
                       1.3731693765509461125e4, 4.5921953931549871457e4, 6.7265770927008700853e4,
                       3.3430575583588128105e4, 2.5090809287301226727e3},
                      r) /
           polynomial({1.0, 4.2313330701600911252e1, 6.8718700749205790830e2,
                       5.3941960214247511077e3, 2.1213794301586595867e4, 3.9307895800092710610e4,
                       2.8729085735721942674e4, 5.2264952788528545610e3},
                      r);
  }
  const double tail = std::sqrt(-math::log(q < 0.0 ? u : 1.0 - u));
  double size = 0.0;
  if (tail <= 5.0) {
    const double r = tail - 1.6;
    size =
        polynomial({1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0,
                    3.64784832476320460504e0, 1.27045825245236838258e0, 2.41780725177450611770e-1,
                    2.27238449892691845833e-2, 7.74545014278341407640e-4},
                   r) /
        polynomial({1.0, 2.05319162663775882187e0, 1.67638483018380384940e0,
                    6.89767334985100004550e-1, 1.48103976427480074590e-1, 1.51986665636164571966e-2,
                    5.47593808499534494600e-4, 1.05075007164441684324e-9},
                   r);
  } else {
    const double r = tail - 5.0;
    size =
        polynomial({6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0,
                    2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                    2.71155556874348757815e-5, 2.01033439929228813265e-7},
                   r) /
        polynomial({1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1,
                    1.48753612908506148525e-2, 7.86869131145613259100e-4, 1.84631831751005468180e-5,
                    1.42151175831644588870e-7, 2.04426310338993978564e-15},
                   r);
  }
  return q < 0.0 ? -size : size;
}

}  // namespace breakwater
