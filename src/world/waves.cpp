#include <breakwater/world/waves.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>
#include <breakwater/world/noise.h>

namespace breakwater {
namespace {

// The band of a realisation, divided by ω_p: 1 % of the waves' energy is outside.
constexpr double kLowest = 0.5;
constexpr double kHighest = 3.0;

constexpr double kWidthBelowPeak = 0.07;
constexpr double kWidthAbovePeak = 0.09;
constexpr int kMostComponents = 1000;

}  // namespace

double wave_number(double omega_rad_s, double water_depth_m, double gravity_m_s2) {
  const double deep = omega_rad_s * omega_rad_s / gravity_m_s2;
  if (water_depth_m == 0.0) return deep;
  // Newton's method on x tanh x = y, x = k h. The start is exact in both limits.
  const double y = deep * water_depth_m;
  double x = y / std::sqrt(math::tanh(y));
  for (int i = 0; i < 20; ++i) {
    const double t = math::tanh(x);
    const double change = (x * t - y) / (t + x * (1.0 - t * t));
    x -= change;
    if (std::abs(change) <= 1e-15 * x) break;
  }
  return x / water_depth_m;
}

SampledSpectrum acceleration_spectrum(const SeaState& sea, double depth_m, double lowest,
                                      double highest, int intervals) {
  refuse_unless(depth_m >= 0.0, "waves: the depth must be 0 or more");
  const JonswapSpectrum spectrum(sea);
  const double step = (highest - lowest) * spectrum.peak_rad_s() / intervals;
  SampledSpectrum sampled;
  for (int i = 0; i < intervals; ++i) {
    const double omega = lowest * spectrum.peak_rad_s() + step * (i + 0.5);
    const double k = wave_number(omega, sea.water_depth_m, sea.gravity_m_s2);
    double decay = math::exp(-k * depth_m);
    if (sea.water_depth_m > 0.0) {
      decay *= (1.0 - math::exp(-2.0 * k * (sea.water_depth_m - depth_m))) /
               (1.0 - math::exp(-2.0 * k * sea.water_depth_m));
    }
    sampled.omega_rad_s.push_back(omega);
    sampled.density.push_back(math::pow(omega, 4.0) * decay * decay * spectrum.density(omega));
  }
  return sampled;
}

double mean_acceleration_frequency(const SeaState& sea, double depth_m) {
  SeaState unit = sea;  // the mean is independent of the height
  unit.significant_height_m = 1.0;
  const SampledSpectrum spectrum = acceleration_spectrum(unit, depth_m, kLowest, kHighest, 1000);
  double moment = 0.0, area = 0.0;
  for (std::size_t i = 0; i < spectrum.density.size(); ++i) {
    moment += spectrum.omega_rad_s[i] * spectrum.density[i];
    area += spectrum.density[i];
  }
  return moment / area;
}

Waves::Waves(const SeaState& sea, double slope_low_pass_s)
    : cos_heading_(math::cos(sea.heading_rad)),
      sin_heading_(math::sin(sea.heading_rad)),
      depth_m_(sea.water_depth_m),
      slope_low_pass_s_(slope_low_pass_s) {
  check(sea);
  refuse_unless(slope_low_pass_s >= 0.0, "waves: the low-pass's time constant must be 0 or more");
  if (sea.significant_height_m == 0.0) return;  // still water
  const JonswapSpectrum spectrum(sea);
  const Noise frequencies(sea.seed, "wave frequencies");
  const Noise phases(sea.seed, "wave phases");
  const double width = (kHighest - kLowest) * spectrum.peak_rad_s() / sea.components;
  double variance = 0.0;
  for (int i = 0; i < sea.components; ++i) {
    const auto draw = static_cast<std::uint64_t>(i);
    const double from = kLowest * spectrum.peak_rad_s() + width * i;
    const double share = spectrum.variance(from, from + width);
    const double omega = from + width * frequencies.uniform(draw);
    components_.push_back({std::sqrt(2.0 * share), omega,
                           wave_number(omega, sea.water_depth_m, sea.gravity_m_s2),
                           2.0 * std::numbers::pi * phases.uniform(draw)});
    variance += share;
  }
  const double scale = sea.significant_height_m / (4.0 * std::sqrt(variance));
  for (Component& component : components_) component.amplitude_m *= scale;
}

Waves::Waves(std::vector<Component> components, double heading_rad, double water_depth_m)
    : cos_heading_(math::cos(heading_rad)),
      sin_heading_(math::sin(heading_rad)),
      depth_m_(water_depth_m),
      slope_low_pass_s_(0.0),
      components_(std::move(components)) {}

double Waves::elevation(double time_s, double x_m, double y_m) const {
  const double along = x_m * cos_heading_ + y_m * sin_heading_;
  double sum = 0.0;
  for (const Component& c : components_) {
    sum += c.amplitude_m *
           math::cos(c.wave_number_rad_m * along - c.omega_rad_s * time_s + c.phase_rad);
  }
  return sum;
}

WaterMotion Waves::at(double time_s, const Eigen::Ref<const Eigen::Vector3d>& position_m) const {
  const double along = position_m.x() * cos_heading_ + position_m.y() * sin_heading_;
  double z = std::min(position_m.z(), 0.0);
  if (depth_m_ > 0.0) z = std::max(z, -depth_m_);
  double u = 0.0, w = 0.0, du = 0.0, dw = 0.0, slope = 0.0;
  for (const Component& c : components_) {
    const double k = c.wave_number_rad_m;
    const double omega = c.omega_rad_s;
    const double theta = k * along - omega * time_s + c.phase_rad;
    const auto [sine, cosine] = math::sincos(theta);
    // cosh k(z+h)/sinh kh, sinh k(z+h)/sinh kh and cosh k(z+h)/cosh kh without large numbers.
    const double down = math::exp(k * z);
    double horizontal = down, vertical = down, pressure = down;
    if (depth_m_ > 0.0) {
      const double up = math::exp(-k * (z + 2.0 * depth_m_));
      const double round_trip = math::exp(-2.0 * k * depth_m_);
      horizontal = (down + up) / (1.0 - round_trip);
      vertical = (down - up) / (1.0 - round_trip);
      pressure = (down + up) / (1.0 + round_trip);
    }
    const double speed = c.amplitude_m * omega;
    u += speed * horizontal * cosine;
    w += speed * vertical * sine;
    du += speed * omega * horizontal * sine;
    dw -= speed * omega * vertical * cosine;
    // −a k sin θ after 1/(τ s + 1): gain 1/√(1 + (ωτ)²), lag atan ωτ.
    const double lag = omega * slope_low_pass_s_;
    slope -= c.amplitude_m * k * pressure * (sine + lag * cosine) / (1.0 + lag * lag);
  }
  WaterMotion motion;
  motion.velocity << u * cos_heading_, u * sin_heading_, w;
  motion.acceleration << du * cos_heading_, du * sin_heading_, dw;
  motion.slope << slope * cos_heading_, slope * sin_heading_;
  return motion;
}

ChangingSea::ChangingSea(const SeaState& sea, double slope_low_pass_s, const Change& change)
    : change_(change), first_(sea, slope_low_pass_s) {
  if (change.at_s > 0.0) {
    SeaState other = sea;
    other.peak_period_s = change.period_s;
    second_.emplace(other, slope_low_pass_s);
  }
}

double ChangingSea::changed(double time_s) const {
  if (!second_) return 0.0;
  return std::clamp((time_s - change_.at_s) / change_.within_s, 0.0, 1.0);
}

WaterMotion ChangingSea::water(double time_s, const Eigen::Vector3d& position) const {
  const double share = changed(time_s);
  WaterMotion motion = share < 1.0 ? first_.at(time_s, position) : WaterMotion{};
  if (share > 0.0) {
    const WaterMotion other = second_->at(time_s, position);
    motion.velocity += share * (other.velocity - motion.velocity);
    motion.acceleration += share * (other.acceleration - motion.acceleration);
    motion.slope += share * (other.slope - motion.slope);
    if (share == 1.0) motion = other;
  }
  return motion;
}

double ChangingSea::elevation(double time_s, double x_m, double y_m) const {
  const double share = changed(time_s);
  double eta = (1.0 - share) * first_.elevation(time_s, x_m, y_m);
  if (share > 0.0) eta += share * second_->elevation(time_s, x_m, y_m);
  return eta;
}

std::vector<std::array<double, 9>> ChangingSea::plane_waves() const {
  std::vector<std::array<double, 9>> all;
  const auto add = [&](const Waves& waves, double before, double after) {
    for (const Waves::Component& c : waves.components()) {
      const Eigen::Vector2d k = c.wave_number_rad_m * waves.direction();
      all.push_back({c.amplitude_m, k.x(), k.y(), c.omega_rad_s, c.phase_rad, before, after,
                     change_.at_s, change_.at_s + change_.within_s});
    }
  };
  add(first_, 1.0, second_ ? 0.0 : 1.0);
  if (second_) add(*second_, 0.0, 1.0);
  return all;
}

void check(const SeaState& sea) {
  refuse_unless(is_not_negative(sea.significant_height_m),
                "sea: the significant height must be 0 or more");
  refuse_unless(is_positive(sea.peak_period_s), "sea: the peak period must be positive");
  refuse_unless(std::isfinite(sea.gamma) && sea.gamma >= 1.0, "sea: gamma must be 1 or more");
  refuse_unless(std::isfinite(sea.heading_rad), "sea: the heading must be finite");
  refuse_unless(is_not_negative(sea.water_depth_m),
                "sea: the water's depth must be positive, or 0 for deep water");
  refuse_unless(sea.gravity_m_s2 > 0.0, "sea: gravity must be positive");
  refuse_unless(sea.components >= 1 && sea.components <= kMostComponents,
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
