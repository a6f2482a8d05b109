#include <breakwater/record/held_reference.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace breakwater {
namespace {

constexpr double kHeldWithin = 0.5;  // part of the distance that was asked for
constexpr double kGrowth = 1.5;      // ratio of a part's peak to the peak of the part before
// Without a distance to go, errors below this level are ignored, since rounding errors grow too
// [m, rad, N].
constexpr double kSmallest = 1e-6;
constexpr double kGrown = 1e-3;  // the same as a part of the distance

}  // namespace

void HeldReference::add(double time_s, double error) {
  if (!(window_.to_s > window_.from_s) || !window_.contains(time_s)) return;
  const double done = (time_s - window_.from_s) / (window_.to_s - window_.from_s);
  const auto part = std::min(static_cast<std::size_t>(kParts * done), kParts - 1);
  peaks_[part] = std::max(peaks_[part], std::abs(error));
  ++samples_[part];
  if (part == kParts - 1) last_sum_of_squares_ += error * error;
}

bool HeldReference::grows() const {
  for (std::size_t part = kParts - kGrowing + 1; part < kParts; ++part) {
    if (!(peaks_[part] >= kGrowth * peaks_[part - 1])) return false;
  }
  return peaks_.back() > (asked_ > 0.0 ? kGrown * asked_ : kSmallest);
}

void HeldReference::warn(std::vector<std::string>& warnings) const {
  const auto is_empty = [](std::int64_t samples) { return samples == 0; };
  if (std::any_of(samples_.begin(), samples_.end(), is_empty)) return;
  const double part_s = (window_.to_s - window_.from_s) / kParts;
  const double rms = std::sqrt(last_sum_of_squares_ / static_cast<double>(samples_.back()));
  if (grows()) {
    warnings.push_back(fmt::format(
        "{} does not hold its reference: its error grows to the end, to peaks of {:.3g} {} in each "
        "{:.3g} s",
        what_, fmt::join(peaks_.end() - kGrowing, peaks_.end(), ", "), unit_, part_s));
  } else if (rms >= large_ || (asked_ > 0.0 && rms >= kHeldWithin * asked_)) {
    warnings.push_back(fmt::format(
        "{} does not hold its reference: over the last {:.3g} s its error is {:.3g} {} (rms)",
        what_, part_s, rms, unit_));
    if (asked_ > 0.0) warnings.back() += fmt::format(", of {:.3g} {} to go", asked_, unit_);
  }
}

}  // namespace breakwater
