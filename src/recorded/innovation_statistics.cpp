#include <breakwater/recorded/innovation_statistics.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

constexpr double kExplained = 15.1;  // chi-square of one degree of freedom: all but 1e-4
constexpr double kQuantile = 3.09;   // of a standard normal: all but 1e-3

// Up to where the mean of n independent squares lies, all but one time in a thousand: chi-square by
// Wilson and Hilferty.
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
  // A prediction that knows the position no better than the code does makes 2 of the 1; transients
  // of an estimator that is right may be some 7 % of the rows, which at 15.1 each are 1 more.
  constexpr double kPrediction = 2.0;
  constexpr double kTransients = 1.0;
  constexpr double kCorrelated = 0.5;
  const auto count = recording.metric("sample_count");
  const auto square = recording.metric("normalised_innovation_squared");
  const auto beyond = recording.metric("unexplained_share");
  const auto correlation = recording.metric("innovation_correlation_1");
  if (!count || !square || !beyond || !correlation) return std::nullopt;
  // So many of the squares count as independent, if each remembers the last one alone, but for
  // one in 200 at the least.
  const double memory = std::min(*correlation * *correlation, 0.99);
  const double n = *count * (1.0 - memory) / (1.0 + memory);
  const double largest = kPrediction * largest_mean(n) + kTransients;
  if (*square <= largest) return std::nullopt;
  return fmt::format(
      "the model does not explain the data: innovations squared are {:.3g} times what encoder and "
      "noise explain, at most {:.3g} are expected; {:.0f} % of them are beyond all chance, and one "
      "correlates with the next by {:.2f}: {}",
      *square, largest, 100.0 * *beyond, *correlation,
      *correlation > kCorrelated
          ? "inertia, friction, a scale or a sign is wrong, or the observer slow for this "
            "disturbance"
          : "the times are off (csv.time_std_s), encoder.quantum or noise.std is too small, or a "
            "scale or a sign is wrong");
}

}  // namespace breakwater
