#include <breakwater/pages/chart_scale.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <breakwater/math/functions.h>

namespace breakwater {
namespace {

constexpr double kLn10 = 2.302585092994046;

double power_of_ten(int n) {
  return math::pow(10.0, n);
}

std::string tick_label(double value) {
  return fmt::format("{:.6g}", value == 0.0 ? 0.0 : value);
}

}  // namespace

ChartScale::ChartScale(double low, double high, bool is_log, double a, double b)
    : low_(low), high_(high), is_log_(is_log && low > 0.0), a_(a), b_(b) {
  if (high_ - low_ > 1e-12 * std::max(std::abs(low_), std::abs(high_))) return;
  if (is_log_) {
    low_ /= 2.0;
    high_ *= 2.0;
  } else {
    const double half = low_ == 0.0 ? 0.5 : 0.05 * std::abs(low_);
    low_ -= half;
    high_ += half;
  }
}

double ChartScale::operator()(double x) const {
  const double part =
      is_log_ ? math::log(x / low_) / math::log(high_ / low_) : (x - low_) / (high_ - low_);
  return a_ + (b_ - a_) * part;
}

double ChartScale::share(double x) const {
  return std::clamp(((*this)(x)-a_) / (b_ - a_), 0.0, 1.0);
}

std::vector<ChartScale::Tick> ChartScale::ticks(int count) const {
  std::vector<Tick> ticks;
  const auto add = [&](double value) {
    constexpr double kSlack = 1e-9;
    const double below = kSlack * (is_log_ ? low_ : high_ - low_);
    const double above = kSlack * (is_log_ ? high_ : high_ - low_);
    if (value >= low_ - below && value <= high_ + above)
      ticks.push_back({value, tick_label(value)});
  };
  if (is_log_) {
    const double first = math::log(low_) / kLn10, last = math::log(high_) / kLn10;
    const bool is_fine = last - first < 2.0;
    const int stride = std::max(1, static_cast<int>(std::ceil((last - first) / count)));
    const int from = static_cast<int>(std::floor(first / stride)) * stride;
    for (int n = from; n <= static_cast<int>(std::ceil(last)); n += is_fine ? 1 : stride) {
      add(power_of_ten(n));
      if (is_fine) add(2.0 * power_of_ten(n));
      if (is_fine) add(5.0 * power_of_ten(n));
    }
    if (ticks.size() >= 2) return ticks;
    ticks.clear();  // less than one round step: as on a linear axis
  }
  const double rough = (high_ - low_) / count;
  const double decade = power_of_ten(static_cast<int>(std::floor(math::log(rough) / kLn10)));
  double step = 10.0 * decade;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * decade >= rough * (1.0 - 1e-9)) step = factor * decade;
  }
  const double first = std::ceil(low_ / step - 1e-9);
  for (int i = 0; (first + i) * step <= high_ + 1e-9 * step; ++i) add((first + i) * step);
  return ticks;
}

bool is_for_log(double low, double high) {
  return low > 0.0 && high > 300.0 * low;
}

}  // namespace breakwater
