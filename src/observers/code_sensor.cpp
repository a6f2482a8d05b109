#include <breakwater/observers/code_sensor.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace breakwater {
namespace {

constexpr double kGate = 4.0;  // gate, in standard deviations
constexpr double kLargestInflation = 1e12;
constexpr double kFineQuantum = 0.05;  // a narrower code, in √S, counts as a number
constexpr double kKnownCode = 0.01;    // s²/Δ² below which noise does not hide the code
constexpr double kShortestWay = 1e-6;  // smallest distance from the last edge, in Δ
constexpr double kSmallestOutside = 1e-300;

// E[max(v, 0)] for v ~ N(mean, std²).
double mean_positive(double mean, double std) {
  if (!(std > 0.0)) return std::max(mean, 0.0);
  const double z = mean / std;
  const double density = math::exp(-0.5 * z * z - math::kLogRootTwoPi);
  const double tail = density * math::mills_ratio(std::abs(z));  // beyond |z|
  return std * density + mean * (z > 0.0 ? 1.0 - tail : tail);
}

double density(double z) {
  return math::exp(-0.5 * z * z) / math::kRootTwoPi;
}

}  // namespace

double log_density(double e, double S) {
  return -0.5 * (e * e / S + math::log(S)) - math::kLogRootTwoPi;
}

CodeSensor::CodeSensor(const SensorError& error) {
  check(error, 1);
  quantum_ = error.quantum(0);
  rounding_ = error.rounding;
  const double sigma = error.noise_std(0);
  sensor_variance_ = sigma * sigma + kCodeRounding * kCodeRounding;
  add_noise(0.0);
}

void CodeSensor::add_noise(double std) {
  noise_variance_ = sensor_variance_ + std * std;
  code_is_known_ = quantum_ > 0.0 && noise_variance_ < kKnownCode * quantum_ * quantum_;
}

CodeSensor::Observation CodeSensor::observe(double y) {
  Observation observed{y, code_range(y, quantum_, rounding_),
                       std::numeric_limits<double>::quiet_NaN()};
  if (quantum_ > 0.0 && has_output_) observed.moved = std::round((y - last_output_) / quantum_);
  last_output_ = y;
  has_output_ = true;
  return observed;
}

bool CodeSensor::is_fine(const CodeRange& range, double S) const {
  return !code_is_known_ || range.width() < kFineQuantum * std::sqrt(S);
}

double CodeSensor::log_likelihood(double e, double S, const CodeRange& range) const {
  const double width = range.width();
  if (is_fine(range, S)) {
    return log_density(e + range.middle(), S + width * width / 12.0) +
           (width > 0.0 ? math::log(width) : 0.0);
  }
  const double root = std::sqrt(S);
  return CodeInterval((e + range.lower) / root, (e + range.upper) / root).log_mass();
}

CodeSensor::Consistency CodeSensor::consistency(double position, double variance,
                                                const Observation& observed) const {
  const CodeRange& range = observed.range;
  const double e = observed.y - position;
  const double S = variance + noise_variance_;
  const double excess = std::max({e + range.lower, -(e + range.upper), 0.0});
  if (!(excess > kGate * std::sqrt(S))) return {1.0, INFINITY};
  const double wanted = excess * excess / (kGate * kGate) - noise_variance_;
  return {std::clamp(wanted / variance, 1.0, kLargestInflation), log_likelihood(e, S, range)};
}

CodeSensor::Update CodeSensor::update(const Prediction& predicted, const Observation& observed,
                                      double interval_s) const {
  const CodeRange& range = observed.range;
  const double P = predicted.position_variance;
  const double S = P + noise_variance_;
  double e = observed.y - predicted.position;
  if (is_fine(range, S)) {
    return {S + range.width() * range.width() / 12.0, e + range.middle(), 1.0,
            log_likelihood(e, S, range), true};
  }
  if (std::abs(observed.moved) == 1.0) {
    // The position passed the edge between the two codes within the last period.
    const double way =
        mean_positive(observed.moved * predicted.velocity, std::sqrt(predicted.velocity_variance)) *
        interval_s;
    const double passed = std::clamp(way, kShortestWay * quantum_, quantum_);
    e += observed.moved > 0.0 ? range.lower + 0.5 * passed : range.upper - 0.5 * passed;
    const double R = noise_variance_ + passed * passed / 12.0;
    return {P + R, e, 1.0, log_density(e, P + R) + math::log(passed), false};
  }
  const double root = std::sqrt(S);
  const CodeInterval interval((e + range.lower) / root, (e + range.upper) / root);
  double share = 1.0;
  double found = interval.log_mass();
  if (observed.moved == 0.0) {
    // An unchanged code is informative only on the probability that has left its interval since.
    const double outside = interval.outside();
    share =
        outside < kSmallestOutside ? 0.0 : std::clamp(1.0 - predicted.outside / outside, 0.0, 1.0);
    found = math::log(1.0 - share * outside);
  }
  if (!(share > 0.0)) return {S, 0.0, 0.0, found, false};
  const auto [mean, variance] = interval.moments();
  return {S, share * root * mean, share * std::clamp(1.0 - variance, 0.0, 1.0), found, false};
}

double CodeSensor::outside(double position, double variance, const Observation& observed) const {
  const double after = std::sqrt(variance + noise_variance_);
  const double rest = observed.y - position;
  return CodeInterval((rest + observed.range.lower) / after, (rest + observed.range.upper) / after)
      .outside();
}

CodeInterval::CodeInterval(double alpha, double beta)
    : sign_(alpha + beta < 0.0 ? -1.0 : 1.0),
      lower_(sign_ > 0.0 ? alpha : -beta),
      upper_(sign_ > 0.0 ? beta : -alpha) {
  if (lower_ >= 0.0) {
    lower_weight_ = 1.0;
    upper_weight_ = math::exp(0.5 * (lower_ - upper_) * (lower_ + upper_));
    mass_ = math::mills_ratio(lower_) - upper_weight_ * math::mills_ratio(upper_);
    outside_ = 0.0;
  } else {
    lower_weight_ = density(lower_);
    upper_weight_ = density(upper_);
    outside_ =
        lower_weight_ * math::mills_ratio(-lower_) + upper_weight_ * math::mills_ratio(upper_);
    mass_ = 1.0 - outside_;
  }
}

double CodeInterval::outside() const {
  return lower_ >= 0.0 ? 1.0 - density(lower_) * mass_ : outside_;
}

}  // namespace breakwater
