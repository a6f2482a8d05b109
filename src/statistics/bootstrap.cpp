#include <breakwater/statistics/bootstrap.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include <breakwater/statistics/distribution.h>

namespace breakwater {

double sample_mean(std::vector<double>& values) {
  // The order of summation is fixed, so the bits do not depend on the input's order.
  std::sort(values.begin(), values.end());
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<double> bootstrap_replicates(const std::vector<double>& values,
                                         const Statistic& statistic,
                                         const BootstrapSettings& settings) {
  std::mt19937_64 draw(settings.seed);
  const auto size = static_cast<std::uint64_t>(values.size());
  std::vector<double> replicates, sample(values.size());
  for (int r = 0; r < settings.replicates; ++r) {
    // The numbers of std::uniform_int_distribution depend on the library.
    for (double& value : sample) value = values[static_cast<std::size_t>(draw() % size)];
    replicates.push_back(statistic(sample));
  }
  return replicates;
}

std::optional<ConfidenceInterval> bca_interval(const std::vector<double>& values,
                                               const Statistic& statistic,
                                               std::vector<double> replicates, double level) {
  if (values.size() < 2 || replicates.empty()) return std::nullopt;
  std::vector<double> sample = values;
  const double theta = statistic(sample);
  std::sort(replicates.begin(), replicates.end());
  const auto [low, high] = std::equal_range(replicates.begin(), replicates.end(), theta);
  const double below =
      0.5 * static_cast<double>((low - replicates.begin()) + (high - replicates.begin()));
  const double share = below / static_cast<double>(replicates.size());
  if (!(share > 0.0 && share < 1.0)) return std::nullopt;
  const double z0 = normal_quantile(share);

  std::vector<double> without(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    sample = values;
    sample.erase(sample.begin() + static_cast<std::ptrdiff_t>(i));
    without[i] = statistic(sample);
  }
  const double centre =
      std::accumulate(without.begin(), without.end(), 0.0) / static_cast<double>(without.size());
  double largest = 0.0;
  for (const double one : without) largest = std::max(largest, std::abs(centre - one));
  // The acceleration has no unit. A power of two keeps its bits and its powers finite.
  const double unit = math::power_of_two_scale(largest);
  double squares = 0.0, cubes = 0.0;
  for (const double one : without) {
    const double d = unit * (centre - one);
    squares += d * d;
    cubes += d * d * d;
  }
  const double a = squares > 0.0 ? cubes / (6.0 * squares * std::sqrt(squares)) : 0.0;

  const double z = normal_quantile(0.5 * (1.0 + level));
  const auto end = [&](double side) {
    const double shifted = z0 + side;
    return quantile(replicates, normal_cdf(z0 + shifted / (1.0 - a * shifted)));
  };
  return ConfidenceInterval{end(-z), end(z)};
}

}  // namespace breakwater
