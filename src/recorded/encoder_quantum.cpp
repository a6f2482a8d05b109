#include <breakwater/recorded/encoder_quantum.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace breakwater {
namespace {

constexpr double kLoose = 0.2;   // in counts, while the first guess is refined
constexpr double kTight = 0.05;  // in counts, at the end

// Whether the sorted differences are multiples of about `quantum`, which they then refine.
bool explains(const std::vector<double>& differences, double& quantum) {
  double products = 0.0;
  double squares = 0.0;
  for (const double d : differences) {
    const double n = std::round(d / quantum);
    if (n < 1.0 || std::abs(d - n * quantum) > kLoose * quantum) return false;
    products += n * d;
    squares += n * n;
    quantum = products / squares;
  }
  return std::all_of(differences.begin(), differences.end(), [&](double d) {
    return std::abs(d - std::round(d / quantum) * quantum) <= kTight * quantum;
  });
}

// Guesses of a count, the largest first: gaps between the sorted differences, and the least one.
std::vector<double> guesses_of(const std::vector<double>& differences) {
  std::vector<double> guesses = {differences.front()};
  for (std::size_t k = 1; k < differences.size(); ++k) {
    const double gap = differences[k] - differences[k - 1];
    if (gap > 0.0 && gap < guesses.front()) guesses.push_back(gap);
  }
  std::sort(guesses.begin(), guesses.end(), std::greater<>());
  // Digits that are rounded make the same gap several times.
  guesses.erase(
      std::unique(guesses.begin(), guesses.end(), [](double a, double b) { return b > 0.999 * a; }),
      guesses.end());
  return guesses;
}

}  // namespace

double encoder_quantum(std::span<const double> positions) {
  std::vector<double> differences;
  double largest = 0.0;
  for (std::size_t k = 1; k < positions.size(); ++k) {
    differences.push_back(std::abs(positions[k] - positions[k - 1]));
    largest = std::max(largest, std::abs(positions[k]));
  }
  std::erase_if(differences, [&](double d) { return d <= 1e-12 * largest; });
  if (differences.empty()) return 0.0;
  std::sort(differences.begin(), differences.end());
  for (double quantum : guesses_of(differences)) {
    if (!explains(differences, quantum)) continue;
    double n = 0.0, n_sum = 0.0, n_squares = 0.0, y_sum = 0.0, products = 0.0;
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const double y = positions[k] - positions.front();
      if (k > 0) n += std::round((positions[k] - positions[k - 1]) / quantum);
      n_sum += n;
      n_squares += n * n;
      y_sum += y;
      products += n * y;
    }
    const auto rows = static_cast<double>(positions.size());
    return (rows * products - n_sum * y_sum) / (rows * n_squares - n_sum * n_sum);
  }
  return 0.0;
}

}  // namespace breakwater
