#include "plant/declared_metrics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/record/hdf5_log.h>
#include <breakwater/shell/did_you_mean.h>

namespace breakwater {
namespace {

constexpr const char* kNone = "none";

// "rad_s" for "rad/s".
std::string suffix_of(const std::string& unit) {
  std::string suffix;
  for (const char c : unit) {
    if (c != ' ') suffix += c == '/' ? '_' : c;
  }
  return suffix;
}

bool is_time(DeclaredKind kind) {
  return kind == DeclaredKind::settling || kind == DeclaredKind::reach ||
         kind == DeclaredKind::time_above;
}
bool is_number(DeclaredKind kind) {
  return kind == DeclaredKind::overshoot || kind == DeclaredKind::onsets;
}

const char* meaning(DeclaredKind kind) {
  switch (kind) {
    case DeclaredKind::rms:
      return "root mean square";
    case DeclaredKind::mean:
      return "mean";
    case DeclaredKind::max:
      return "largest value";
    case DeclaredKind::min:
      return "smallest value";
    case DeclaredKind::peak:
      return "largest magnitude";
    case DeclaredKind::settling:
      return "time from the window's start until the magnitude stays within the level to its end";
    case DeclaredKind::overshoot:
      return "farthest value beyond 0, relative to the first value of the window, on its other "
             "side";
    case DeclaredKind::reach:
      return "time from the window's start until the magnitude first reaches the level";
    case DeclaredKind::rms_change:
      return "root mean square of the change from sample to sample";
    case DeclaredKind::time_above:
      return "time for which the value is above the level";
    case DeclaredKind::onsets:
      return "number of times that the value rises above the level, without the first: bounces";
  }
  return "";
}

// The value of a signal, NAME or NAME[2]; empty if there is none.
std::span<const double> value_of(const std::string& name, const std::vector<Signal>& signals) {
  const SignalName wanted = signal_name(name);
  for (const Signal& signal : signals) {
    if (signal.name != wanted.name) continue;
    const std::size_t index = std::max<std::size_t>(1, wanted.index);
    if (index > signal.values.size() || (wanted.index == 0 && signal.values.size() > 1)) {
      throw std::invalid_argument(name + ": the signal has " +
                                  std::to_string(signal.values.size()) + " values");
    }
    return signal.values.subspan(index - 1, 1);
  }
  return {};
}

}  // namespace

void DeclaredMetric::bind(Fields& fields) {
  const Fields::Under under(fields, prefix());
  fields.text("of", of, "signal of the log, NAME or NAME[2]");
  fields.text("minus", minus, "signal that is subtracted from it; none: nothing");
  fields.standard("minus", {std::string(kNone)});
  fields.choice(
      "kind", kind,
      {{"rms", DeclaredKind::rms},
       {"rmse", DeclaredKind::rms},
       {"mean", DeclaredKind::mean},
       {"max", DeclaredKind::max},
       {"min", DeclaredKind::min},
       {"peak", DeclaredKind::peak},
       {"settling", DeclaredKind::settling},
       {"overshoot", DeclaredKind::overshoot},
       {"reach", DeclaredKind::reach},
       {"rms_change", DeclaredKind::rms_change},
       {"time", DeclaredKind::time_above},
       {"bounces", DeclaredKind::onsets}},
      "rms or rmse, mean, max, min, peak (magnitude), rms_change (from sample to sample), "
      "overshoot (of the difference to a reference). With a level: settling (within it), reach "
      "(of it), time (above it), bounces (above it)");
  fields.number("from_s", from_s, not_negative(), "start of the window [s]");
  fields.number("to_s", to_s, not_negative(), "end of the window; 0: the end of the run [s]");
  fields.number("level", level, not_negative(), "level, in the signal's unit");
  for (const char* key : {"from_s", "to_s", "level"}) fields.standard(key, {0.0});
  fields.only_for({"level"}, "kind", {"settling", "reach", "time", "bounces"});
}

TimeWindow DeclaredMetric::window() const {
  return to_s > 0.0 ? TimeWindow{from_s, to_s} : TimeWindow{from_s};
}

MetricDefinition DeclaredMetric::definition() const {
  const std::string of_signal = unit_of(whole_key(of));
  const std::string unit = is_time(kind)                          ? "s"
                           : is_number(kind) || of_signal.empty() ? "1"
                                                                  : of_signal;
  const std::string end = "_" + suffix_of(unit);
  const std::string of_what = minus == kNone ? of : of + " less " + minus;
  return {name.ends_with(end) ? name : name + end, unit, of_what + ": " + meaning(kind)};
}

std::string missing_signal(const DeclaredMetric& metric, const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  for (const Signal& signal : signals) names.push_back(signal.name);
  for (const auto& [key, name] : {std::pair("of", metric.of), std::pair("minus", metric.minus)}) {
    if (name == kNone || !value_of(name, signals).empty()) continue;
    return metric.prefix() + key + ": the log has no signal " + toml_string(name) +
           did_you_mean(signal_name(name).name, names);
  }
  return "";
}

DeclaredValue::DeclaredValue(const DeclaredMetric& metric, const std::vector<Signal>& signals,
                             double end_s)
    : metric_(metric),
      of_(value_of(metric.of, signals)),
      minus_(metric.minus == kNone ? std::span<const double>() : value_of(metric.minus, signals)),
      window_(metric.window().within(end_s)),
      values_(window_),
      changes_(window_),
      settling_(window_, metric.level),
      reach_(metric.from_s, metric.level) {}

void DeclaredValue::add(double time_s, double step_s) {
  const double value = of_.front() - (minus_.empty() ? 0.0 : minus_.front());
  values_.add(time_s, value);
  settling_.add(time_s, value);
  changes_.add(time_s, value - last_.value_or(0.0));
  const double before = last_.value_or(0.0);
  last_ = value;
  if (!window_.contains(time_s)) return;
  reach_.add(time_s, value);
  if (!first_) first_ = value;
  beyond_ = std::max(beyond_, *first_ > 0.0 ? -value : value);
  if (value > metric_.level) {
    time_above_s_ += step_s;
    if (before <= metric_.level) ++onsets_;
  }
}

std::optional<double> DeclaredValue::value() const {
  switch (metric_.kind) {
    case DeclaredKind::rms:
      return values_.rms();
    case DeclaredKind::mean:
      return values_.mean();
    case DeclaredKind::max:
      return values_.largest();
    case DeclaredKind::min:
      return values_.smallest();
    case DeclaredKind::peak:
      return values_.peak();
    case DeclaredKind::settling:
      return settling_.value();
    case DeclaredKind::reach:
      return reach_.value();
    case DeclaredKind::rms_change:
      return changes_.rms();
    case DeclaredKind::overshoot:
      if (!first_ || *first_ == 0.0) return std::nullopt;
      return beyond_ / std::abs(*first_);
    case DeclaredKind::time_above:
      if (!first_) return std::nullopt;
      return time_above_s_;
    case DeclaredKind::onsets:
      if (onsets_ == 0) return std::nullopt;
      return onsets_ - 1;
  }
  return std::nullopt;
}

}  // namespace breakwater
