#include <breakwater/recorded/innovation_statistics.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

constexpr double kExplained = 15.1;  // 99.99 % quantile of chi-square with one degree of freedom
constexpr double kQuantile = 3.09;   // 99.9 % quantile of the standard normal distribution

// The 99.9 % quantile of the mean of n independent normalised squares, by Wilson and Hilferty's
// approximation of chi-square.
double largest_mean(double n) {
  const double share = 2.0 / (9.0 * n);
  const double root = 1.0 - share + kQuantile * std::sqrt(share);
  return root * root * root;
}

}  // namespace

void InnovationStatistics::add(double innovation, double instant_error) {
  ++count_;
  const double square = innovation * innovation;
  const double R = variance_ + instant_error * instant_error;
  squares_ += square;
  if (R > 0.0) normalised_ += std::min(square / R, kExplained);
  if (square > kExplained * R) ++unexplained_;
  if (has_last_) products_ += innovation * last_;
  last_ = innovation;
  has_last_ = true;
}

std::optional<double> InnovationStatistics::rms() const {
  if (count_ == 0) return std::nullopt;
  return std::sqrt(squares_ / static_cast<double>(count_));
}

std::optional<double> InnovationStatistics::normalised_square() const {
  if (count_ == 0 || variance_ == 0.0) return std::nullopt;
  return normalised_ / static_cast<double>(count_);
}

std::optional<double> InnovationStatistics::unexplained_share() const {
  if (count_ == 0 || variance_ == 0.0) return std::nullopt;
  return static_cast<double>(unexplained_) / static_cast<double>(count_);
}

std::optional<double> InnovationStatistics::correlation() const {
  if (squares_ == 0.0) return std::nullopt;
  return products_ / squares_;
}

std::optional<std::string> doubt_of(const Recording& recording) {
  // A prediction with an error as large as that of the code doubles the mean from 1 to 2.
  // Transients of a correct estimator may be 7 % of the rows, which add 1 at 15.1 each.
  constexpr double kPrediction = 2.0;
  constexpr double kTransients = 1.0;
  constexpr double kCorrelated = 0.5;
  const auto count = recording.metric("sample_count");
  const auto square = recording.metric("normalised_innovation_squared");
  const auto beyond = recording.metric("unexplained_share");
  const auto correlation = recording.metric("innovation_correlation_1");
  if (!count || !square || !beyond || !correlation) return std::nullopt;
  // The number of independent squares for a geometric correlation; at least one in 200.
  const double memory = std::min(*correlation * *correlation, 0.99);
  const double n = *count * (1.0 - memory) / (1.0 + memory);
  const double largest = kPrediction * largest_mean(n) + kTransients;
  if (*square <= largest) return std::nullopt;
  return fmt::format(
      "the model does not explain the data: the squared innovations are {:.3g} times the variance "
      "that encoder and noise explain (expected: at most {:.3g} times). {:.0f} % of them are above "
      "15.1 times. The correlation of successive innovations is {:.2f}. Check {}",
      *square, largest, 100.0 * *beyond, *correlation,
      *correlation > kCorrelated
          ? "inertia, friction, scales and signs, and whether the observer is fast enough for the "
            "disturbance"
          : "the times (csv.time_std_s), encoder.quantum, noise.std, scales and signs");
}

}  // namespace breakwater
