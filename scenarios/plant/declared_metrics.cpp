#include "plant/declared_metrics.h"

#include <fmt/format.h>

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
  if (unit == "%") return "percent";
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
      return "farthest value beyond 0, on the other side of the window's first value, as a share "
             "of this first value";
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

// The value of a signal, NAME or NAME[2], or all values; empty if there is none.
std::span<const double> value_of(const std::string& name, const std::vector<Signal>& signals,
                                 bool takes_all = false) {
  const SignalName wanted = signal_name(name);
  for (const Signal& signal : signals) {
    if (signal.name != wanted.name) continue;
    if (takes_all && wanted.index == 0) return signal.values;
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
  fields.text("of", of,
              "signal of the log, with a number in square brackets for one of its values");
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
  fields.choice(
      "take", take,
      {{"value", Taken::value},
       {"difference", Taken::difference},
       {"high_pass", Taken::high_pass},
       {"largest", Taken::largest}},
      "value that is taken from the signal, before minus. difference: to the last sample (of a "
      "contact's force the last physics step), divided by the time between; largest: of several "
      "values");
  fields.standard("take", {std::string("value")});
  const Fields::OfPart high_pass(fields, "take", "high_pass");
  fields.number("cutoff_Hz", cutoff_Hz, positive(),
                "cut-off of the high-pass, a Butterworth filter of second order [Hz]");
}

TimeWindow DeclaredMetric::window() const {
  return to_s > 0.0 ? TimeWindow{from_s, to_s} : TimeWindow{from_s};
}

MetricDefinition DeclaredMetric::definition() const {
  std::string of_signal = unit_of(whole_key(of));
  if (of_signal.empty()) of_signal = "1";
  std::string of_what = of;
  switch (take) {
    case Taken::value:
      break;
    case Taken::difference:
      of_signal += "/s";
      of_what = "rate of change of " + of;
      break;
    case Taken::high_pass:
      of_what = fmt::format("{} behind a high-pass of {} Hz", of, cutoff_Hz);
      break;
    case Taken::largest:
      of_what = "largest value of " + of;
      break;
  }
  const std::string unit = is_time(kind)                     ? "s"
                           : kind == DeclaredKind::overshoot ? "%"
                           : kind == DeclaredKind::onsets    ? "1"
                                                             : of_signal;
  const std::string end = "_" + suffix_of(unit);
  if (minus != kNone) of_what += " less " + minus;
  return {name.ends_with(end) ? name : name + end, unit, of_what + ": " + meaning(kind)};
}

std::string missing_signal(const DeclaredMetric& metric, const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  for (const Signal& signal : signals) names.push_back(signal.name);
  for (const auto& [key, name] : {std::pair("of", metric.of), std::pair("minus", metric.minus)}) {
    const bool takes_all = metric.take == Taken::largest && name == metric.of;
    if (name == kNone || !value_of(name, signals, takes_all).empty()) continue;
    return metric.prefix() + key + ": the log has no signal " + toml_string(name) +
           did_you_mean(signal_name(name).name, names);
  }
  return "";
}

DeclaredValue::DeclaredValue(const DeclaredMetric& metric, const std::vector<Signal>& signals,
                             double end_s, double period_s)
    : metric_(metric),
      of_(value_of(metric.of, signals, metric.take == Taken::largest)),
      minus_(metric.minus == kNone ? std::span<const double>() : value_of(metric.minus, signals)),
      period_s_(period_s),
      window_(metric.window().within(end_s)),
      values_(window_),
      changes_(window_),
      settling_(window_, metric.level),
      reach_(metric.from_s, metric.level) {
  if (metric.take == Taken::high_pass) high_pass_.emplace(metric.cutoff_Hz, period_s);
}

double DeclaredValue::taken() {
  switch (metric_.take) {
    case Taken::value:
      break;
    case Taken::difference: {
      const double before = last_of_.value_or(of_.front());
      last_of_ = of_.front();
      return (of_.front() - before) / period_s_;
    }
    case Taken::high_pass:
      return high_pass_->update(of_.front());
    case Taken::largest:
      return *std::max_element(of_.begin(), of_.end());
  }
  return of_.front();
}

void DeclaredValue::add(double time_s) {
  const double value = taken() - (minus_.empty() ? 0.0 : minus_.front());
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
    time_above_s_ += period_s_;
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
      return 100.0 * beyond_ / std::abs(*first_);
    case DeclaredKind::time_above:
      if (!first_) return std::nullopt;
      return time_above_s_;
    case DeclaredKind::onsets:
      if (onsets_ == 0) return std::nullopt;
      return onsets_ - 1;
  }
  return std::nullopt;
}

std::string DeclaredValue::why_absent() const {
  if (!first_) return "the run does not cover its window";
  switch (metric_.kind) {
    case DeclaredKind::settling:
      return "the magnitude ends beyond the level";
    case DeclaredKind::reach:
      return "the magnitude never reaches the level";
    case DeclaredKind::overshoot:
      return "the first value of its window is 0";
    case DeclaredKind::onsets:
      return "the value never rises above the level";
    default:
      return "it is not finite";
  }
}

}  // namespace breakwater
