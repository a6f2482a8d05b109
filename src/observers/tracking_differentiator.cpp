#include <breakwater/observers/tracking_differentiator.h>

#include <cmath>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {

double fhan(double x1, double x2, double r, double h) {
  const double d = r * h * h;
  const double a0 = h * x2;
  const double y = x1 + a0;
  const double a1 = std::sqrt(d * (d + 8.0 * std::abs(y)));
  const double a = std::abs(y) <= d ? a0 + y : a0 + std::copysign(0.5 * (a1 - d), y);
  return std::abs(a) <= d ? -r * a / d : -std::copysign(r, a);
}

TrackingDifferentiator::TrackingDifferentiator(const TrackingDesign& design, double period_s)
    : design_(design), period_s_(period_s), disturbance_(design.inertia, design.cutoff_rad_s) {
  refuse_unless(design.acceleration > 0.0 && design.filter_samples >= 1.0 && period_s > 0.0,
                "tracking differentiator: the acceleration and the sampling period must be "
                "positive, and the samples of the filter at least 1");
  disturbance_.over(period_s);
}

void TrackingDifferentiator::reset(const Vector& x) {
  estimate_ << x(0), x(1), 0.0;
  disturbance_.start(x(1));
  has_begun_ = false;
}

void TrackingDifferentiator::step(const Vector& held_input, const Vector& y) {
  const double velocity = estimate_(1);
  if (is_measured_) {
    estimate_(1) += period_s_ * fhan(estimate_(0) - y(0), velocity, design_.acceleration,
                                     design_.filter_samples * period_s_);
  }
  estimate_(0) += period_s_ * velocity;
  if (has_begun_ && is_measured_) estimate_(2) = disturbance_.update(held_input(0), estimate_(1));
  has_begun_ = true;
}

}  // namespace breakwater
