#include <breakwater/world/jonswap.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr double kWidthBelowPeak = 0.07;
constexpr double kWidthAbovePeak = 0.09;
constexpr int kMostComponents = 1000;

}  // namespace

void check(const SeaState& sea) {
  const auto require = [](bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
  };
  require(std::isfinite(sea.significant_height_m) && sea.significant_height_m >= 0.0,
          "sea: the significant height must be 0 or more");
  require(std::isfinite(sea.peak_period_s) && sea.peak_period_s > 0.0,
          "sea: the peak period must be positive");
  require(std::isfinite(sea.gamma) && sea.gamma >= 1.0, "sea: gamma must be 1 or more");
  require(std::isfinite(sea.heading_rad), "sea: the heading must be finite");
  require(std::isfinite(sea.water_depth_m) && sea.water_depth_m >= 0.0,
          "sea: the water's depth must be positive, or 0 for deep water");
  require(sea.gravity_m_s2 > 0.0, "sea: gravity must be positive");
  require(sea.components >= 1 && sea.components <= kMostComponents,
          "sea: needs 1 to 1000 components");
}

JonswapSpectrum::JonswapSpectrum(const SeaState& sea)
    : peak_rad_s_(2.0 * std::numbers::pi / sea.peak_period_s), gamma_(sea.gamma) {
  check(sea);
  const double m0 = variance(0.1 * peak_rad_s_, 100.0 * peak_rad_s_);
  scale_ = sea.significant_height_m * sea.significant_height_m / (16.0 * m0);
}

double JonswapSpectrum::density(double omega_rad_s) const {
  if (omega_rad_s <= 0.0) return 0.0;
  const double ratio = peak_rad_s_ / omega_rad_s;
  const double width = omega_rad_s <= peak_rad_s_ ? kWidthBelowPeak : kWidthAbovePeak;
  const double offset = (omega_rad_s - peak_rad_s_) / (width * peak_rad_s_);
  return scale_ * math::pow(omega_rad_s, -5.0) * math::exp(-1.25 * math::pow(ratio, 4.0)) *
         math::pow(gamma_, math::exp(-0.5 * offset * offset));
}

// Trapezoidal rule in ln ω. ω_p is a node, because σ changes there.
double JonswapSpectrum::variance(double from_rad_s, double to_rad_s) const {
  const auto integrate = [this](double from, double to) {
    constexpr int kIntervals = 2000;
    if (!(to > from)) return 0.0;
    const double step = math::log(to / from) / kIntervals;
    double sum = 0.0;
    for (int i = 0; i <= kIntervals; ++i) {
      const double omega = from * math::exp(step * i);
      sum += (i == 0 || i == kIntervals ? 0.5 : 1.0) * omega * density(omega);
    }
    return sum * step;
  };
  const double split = std::fmin(std::fmax(peak_rad_s_, from_rad_s), to_rad_s);
  return integrate(from_rad_s, split) + integrate(split, to_rad_s);
}

}  // namespace breakwater
