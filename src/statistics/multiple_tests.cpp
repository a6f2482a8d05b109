#include <breakwater/statistics/multiple_tests.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include <breakwater/statistics/signed_rank.h>

namespace breakwater {
namespace {

// P(Q ≤ q) by the trapezoidal rule. The integrand and its derivatives decay so fast that the rule
// is exact except for rounding.
double normal_range_cdf(std::size_t k, double q) {
  constexpr double kEnd = 9.0, kStep = 1.0 / 16.0;
  double sum = 0.0;
  for (double z = -kEnd; z <= kEnd + q; z += kStep) {
    const double density = math::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    const double inside = normal_cdf(z) - normal_cdf(z - q);
    sum += density * (inside > 0.0 ? math::pow(inside, static_cast<double>(k - 1)) : 0.0);
  }
  return static_cast<double>(k) * sum * kStep;
}

}  // namespace

std::vector<double> holm(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double times = static_cast<double>(p.size() - i);
    largest = std::max(largest, std::min(1.0, times * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

Eigen::VectorXd average_ranks(const Eigen::MatrixXd& values) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.cols());
  std::vector<double> row(static_cast<std::size_t>(values.cols()));
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index k = 0; k < values.cols(); ++k)
      row[static_cast<std::size_t>(k)] = values(i, k);
    const std::vector<double> ranks = mid_ranks(row);
    for (Eigen::Index k = 0; k < values.cols(); ++k) sum(k) += ranks[static_cast<std::size_t>(k)];
  }
  return sum / static_cast<double>(values.rows());
}

double normal_range_quantile(std::size_t k, double alpha) {
  double lower = 0.0, upper = 40.0;
  while (upper - lower > 1e-10) {
    const double middle = 0.5 * (lower + upper);
    (1.0 - normal_range_cdf(k, middle) > alpha ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

double critical_difference(std::size_t candidates, std::size_t worlds, double alpha) {
  const auto k = static_cast<double>(candidates), n = static_cast<double>(worlds);
  return normal_range_quantile(candidates, alpha) / std::numbers::sqrt2 *
         std::sqrt(k * (k + 1.0) / (6.0 * n));
}

}  // namespace breakwater
