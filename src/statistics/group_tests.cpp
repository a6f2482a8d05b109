#include <breakwater/statistics/group_tests.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr double kOfLargest =
    1e-12;  // relative to the largest value; a smaller variation is rounding

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Σ (x − mean)²; exactly 0 if all values are equal.
double squares_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (values.empty() || *low == *high) return 0.0;
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum;
}

// The variation within the groups, over all groups.
struct Within {
  double squares = 0.0;
  std::size_t degrees = 0;
};

Within within(const Groups& groups) {
  Within sum;
  for (const std::vector<double>& group : groups) {
    sum.squares += squares_of(group);
    if (!group.empty()) sum.degrees += group.size() - 1;
  }
  return sum;
}

}  // namespace

double student_t_cdf(double t, std::size_t degrees) {
  const double root = std::sqrt(static_cast<double>(degrees));
  const double size = std::hypot(t, root);
  const double sine = std::isinf(t) ? std::copysign(1.0, t) : t / size;
  const double cosine = std::isinf(t) ? 0.0 : root / size;
  const bool is_odd = degrees % 2 == 1;
  // Σ of the powers cosᵏ θ with k = 0, 2, … (odd ν: 1, 3, …) up to ν − 2.
  double term = is_odd ? cosine : 1.0, sum = 0.0;
  for (std::size_t k = is_odd ? 1 : 0; k + 2 <= degrees; k += 2) {
    sum += term;
    const auto power = static_cast<double>(k);
    term *= (power + 1.0) / (power + 2.0) * cosine * cosine;
  }
  double inside = sine * sum;  // P(|T| ≤ |t|), with the sign of t
  if (is_odd) inside = 2.0 / std::numbers::pi * (math::atan2(t, root) + inside);
  return std::clamp(0.5 * (1.0 + inside), 0.0, 1.0);
}

std::optional<double> share_between(const Groups& groups) {
  std::vector<double> all;
  double squared_sizes = 0.0, count = 0.0;
  for (const std::vector<double>& group : groups) {
    if (group.empty()) continue;
    all.insert(all.end(), group.begin(), group.end());
    squared_sizes += static_cast<double>(group.size() * group.size());
    count += 1.0;
  }
  const Within inside = within(groups);
  if (count < 2.0 || inside.degrees == 0) return std::nullopt;
  const auto n = static_cast<double>(all.size());
  const double each = (n - squared_sizes / n) / (count - 1.0);
  const double mean_square = inside.squares / static_cast<double>(inside.degrees);
  const double of_groups = (squares_of(all) - inside.squares) / (count - 1.0);
  const double between = std::max(0.0, (of_groups - mean_square) / each);
  const double dust =
      kOfLargest * std::abs(*std::max_element(all.begin(), all.end(), [](double a, double b) {
        return std::abs(a) < std::abs(b);
      }));
  if (!(std::sqrt(between + mean_square) > dust)) return std::nullopt;
  return between / (between + mean_square);
}

double sign_turn_p(const Groups& groups) {
  const Within all = within(groups);
  if (all.degrees == 0) return 1.0;
  const double pooled = all.squares / static_cast<double>(all.degrees);
  double below = 1.0, above = 1.0, counted = 0.0;
  for (const std::vector<double>& group : groups) {
    if (group.size() < 2) continue;
    counted += 1.0;
    const double mean = mean_of(group);
    if (mean == 0.0) continue;
    const auto n = static_cast<double>(group.size());
    const double variance = std::max(squares_of(group) / (n - 1.0), pooled);
    const double t = mean * std::sqrt(n) / std::sqrt(variance);  // ±∞ without variation
    below = std::min(below, student_t_cdf(t, group.size() - 1));
    above = std::min(above, student_t_cdf(-t, group.size() - 1));
  }
  return counted < 2.0 ? 1.0 : std::min(1.0, counted * std::max(below, above));
}

}  // namespace breakwater
