#include <breakwater/statistics/signed_rank.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr std::size_t kMostExact = 200;

// P(W₊ ≤ w) for w = 0 … n (n + 1)/2.
std::vector<double> distribution_of_sum(std::size_t n) {
  std::vector<double> probability(1 + n * (n + 1) / 2);
  probability[0] = 1.0;
  std::size_t largest = 0;
  for (std::size_t rank = 1; rank <= n; ++rank) {
    largest += rank;
    for (std::size_t s = largest + 1; s-- > 0;) {
      probability[s] = 0.5 * (probability[s] + (s >= rank ? probability[s - rank] : 0.0));
    }
  }
  std::partial_sum(probability.begin(), probability.end(), probability.begin());
  return probability;
}

// Finite doubles as integers in the same order, and back.
std::int64_t place_of(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits < 0 ? std::numeric_limits<std::int64_t>::min() - bits : bits;
}

double value_at(std::int64_t place) {
  return std::bit_cast<double>(place < 0 ? std::numeric_limits<std::int64_t>::min() - place
                                         : place);
}

}  // namespace

SignedRank::SignedRank(std::vector<double> differences, double zero)
    : sorted_(std::move(differences)), zero_(zero) {
  std::sort(sorted_.begin(), sorted_.end());
  if (size() <= kMostExact) cdf_ = distribution_of_sum(size());
}

std::size_t SignedRank::at_most(double value) const {
  std::size_t count = 0, end = size();
  for (std::size_t i = 0; i < end; ++i) {
    while (end > i && std::midpoint(sorted_[i], sorted_[end - 1]) > value) --end;
    count += end - i;
  }
  return count;
}

double SignedRank::last_below_zero() const {
  return std::nextafter(-zero_, std::numeric_limits<double>::lowest());
}

double SignedRank::average(std::size_t k) const {
  std::int64_t low = place_of(sorted_.front()), high = place_of(sorted_.back());
  while (low < high) {
    const std::int64_t middle = std::midpoint(low, high);  // below `high`
    if (at_most(value_at(middle)) >= k) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  const double value = value_at(low);
  return std::abs(value) <= zero_ ? 0.0 : value;
}

double SignedRank::cdf(std::size_t w) const {
  if (!cdf_.empty()) return cdf_[w];
  const auto n = static_cast<double>(size());
  const double mean = 0.25 * n * (n + 1.0), variance = mean * (2.0 * n + 1.0) / 6.0;
  return normal_cdf((static_cast<double>(w) + 0.5 - mean) / std::sqrt(variance));
}

double SignedRank::p() const {
  const std::size_t below = at_most(last_below_zero());
  return std::min(1.0, 2.0 * cdf(std::min(at_most(zero_), averages() - below)));
}

double SignedRank::pseudo_median() const {
  const std::size_t half = (averages() + 1) / 2;
  if (averages() % 2 == 1) return average(half);
  return std::midpoint(average(half), average(half + 1));
}

std::optional<ConfidenceInterval> SignedRank::interval(double alpha) const {
  std::size_t k = 0, end = averages() / 2 + 1;  // 2 P(W₊ ≤ w) ≤ alpha for the k values w < k
  while (k < end) {
    const std::size_t middle = std::midpoint(k, end);
    if (2.0 * cdf(middle) <= alpha) {
      k = middle + 1;
    } else {
      end = middle;
    }
  }
  if (k == 0) return std::nullopt;
  return ConfidenceInterval{average(k), average(averages() + 1 - k)};
}

double SignedRank::share_above() const {
  // The averages of a difference with itself do not count.
  const auto own_at_most = [&](double value) {
    return std::upper_bound(sorted_.begin(), sorted_.end(), value) - sorted_.begin();
  };
  const auto pairs_at_most = [&](double value) {
    return static_cast<double>(at_most(value)) - static_cast<double>(own_at_most(value));
  };
  const double all = static_cast<double>(averages() - size());
  if (all == 0.0) return 0.5;
  return 1.0 - 0.5 * (pairs_at_most(last_below_zero()) + pairs_at_most(zero_)) / all;
}

std::optional<std::size_t> differences_needed(double share_above, double alpha) {
  constexpr double kMost = 1e6, kPower = 0.8;
  const double z = normal_quantile(1.0 - 0.5 * alpha) + normal_quantile(kPower);
  const double distance = share_above - 0.5;
  const double n = z * z / (3.0 * distance * distance);
  if (!(n <= kMost)) return std::nullopt;
  return static_cast<std::size_t>(
      std::ceil(std::max(n, 1.0 - math::log(alpha) / std::numbers::ln2)));
}

}  // namespace breakwater
