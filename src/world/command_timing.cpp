#include <breakwater/world/command_timing.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

constexpr double kLongestDelay = 1e6;
constexpr double kNearlyWhole = 1e-6;

double whole_if_nearly(double steps) {
  const double whole = std::round(steps);
  return std::abs(steps - whole) <= kNearlyWhole ? whole : steps;
}

}  // namespace

double CommandDelays::mean_s() const {
  if (jitters_s.empty()) return delay_s + 0.5 * jitter_s;
  return delay_s + std::accumulate(jitters_s.begin(), jitters_s.end(), 0.0) /
                       static_cast<double>(jitters_s.size());
}

CommandTiming::CommandTiming(CommandDelays delays, std::uint64_t seed, double step_s,
                             int steps_per_sample, std::size_t width)
    : delays_(std::move(delays)),
      step_s_(step_s),
      steps_per_sample_(steps_per_sample),
      width_(width),
      jitter_(seed, "command jitter"),
      drop_(seed, "command drop"),
      held_(width, 0.0) {
  double largest_s = delays_.jitter_s;
  const auto check = [](double delay_s) {
    refuse_unless(is_not_negative(delay_s), "a delay must not be negative");
  };
  check(delays_.delay_s);
  check(delays_.jitter_s);
  for (const double delay_s : delays_.jitters_s) {
    check(delay_s);
    largest_s = std::max(largest_s, delay_s);
  }
  const double most = (delays_.delay_s + largest_s) / step_s;
  refuse_unless(most <= kLongestDelay, "a delay must be at most 1e6 physics steps");
  refuse_unless(delays_.drop_probability >= 0.0 && delays_.drop_probability < 1.0,
                "the probability of a drop must be from 0 to below 1");
  at_.resize(static_cast<std::size_t>(most / steps_per_sample) + 3);
  values_.resize(at_.size() * width);
}

double CommandTiming::delay_in_steps(std::int64_t k) const {
  const auto sample = static_cast<std::uint64_t>(k);
  double delay_s = delays_.delay_s;
  if (!delays_.jitters_s.empty()) {
    delay_s += delays_.jitters_s[static_cast<std::size_t>(sample % delays_.jitters_s.size())];
  } else if (delays_.jitter_s > 0.0) {
    delay_s += delays_.jitter_s * jitter_.uniform(sample);
  }
  return whole_if_nearly(delay_s / step_s_);
}

void CommandTiming::send(std::int64_t k, std::span<const double> command) {
  if (delays_.drop_probability > 0.0 &&
      drop_.uniform(static_cast<std::uint64_t>(k)) < delays_.drop_probability) {
    return;
  }
  const double at = static_cast<double>(k * steps_per_sample_) + delay_in_steps(k);
  while (count_ > 0 && at_[(first_ + count_ - 1) % at_.size()] >= at) --count_;
  const std::size_t last = (first_ + count_++) % at_.size();
  at_[last] = at;
  std::copy(command.begin(), command.end(),
            values_.begin() + static_cast<std::ptrdiff_t>(last * width_));
}

void CommandTiming::receive(std::int64_t step, std::span<double> output) {
  const auto begin = static_cast<double>(step);
  double from = begin;
  bool is_mean = false;
  std::fill(output.begin(), output.end(), 0.0);
  const auto add_held = [&](double to) {
    for (std::size_t i = 0; i < width_; ++i) output[i] += (to - from) * held_[i];
    from = to;
  };
  while (count_ > 0 && at_[first_] < begin + 1.0) {
    if (at_[first_] > begin) {
      add_held(at_[first_]);
      is_mean = true;
    }
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(first_ * width_), width_,
                held_.begin());
    first_ = (first_ + 1) % at_.size();
    --count_;
  }
  if (is_mean) {
    add_held(begin + 1.0);
  } else {
    std::copy(held_.begin(), held_.end(), output.begin());
  }
}

}  // namespace breakwater
