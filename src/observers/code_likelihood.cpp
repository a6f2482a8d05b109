#include <breakwater/observers/code_likelihood.h>

#include <breakwater/math/functions.h>
#include <breakwater/math/mills_ratio.h>

namespace breakwater {
namespace {

double density(double z) {
  return math::exp(-0.5 * z * z) / math::kRootTwoPi;
}

}  // namespace

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

double CodeInterval::log_mass() const {
  const double scale = lower_ >= 0.0 ? -0.5 * lower_ * lower_ - math::kLogRootTwoPi : 0.0;
  return math::log(mass_) + scale;
}

double CodeInterval::outside() const {
  return lower_ >= 0.0 ? 1.0 - density(lower_) * mass_ : outside_;
}

CodeInterval::Moments CodeInterval::moments() const {
  const double mean = (lower_weight_ - upper_weight_) / mass_;
  const double variance =
      1.0 + (lower_ * lower_weight_ - upper_ * upper_weight_) / mass_ - mean * mean;
  return {sign_ * mean, variance};
}

}  // namespace breakwater
