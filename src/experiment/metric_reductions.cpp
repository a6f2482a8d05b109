#include <breakwater/experiment/metric_reductions.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <breakwater/config/toml_text.h>

namespace breakwater {
namespace {

constexpr double kOpen = std::numeric_limits<double>::infinity();

// A number that each value gives.
using Number = double (*)(const ReductionSetup& setup, const AddedValues& added);

double value_of(const ReductionSetup& /*setup*/, const AddedValues& added) {
  return added.value;
}

double area_of(const ReductionSetup& setup, const AddedValues& added) {
  return added.value * setup.period_s;
}

double change_of(const ReductionSetup& /*setup*/, const AddedValues& added) {
  return added.value - added.last.value_or(0.0);
}

double travel_of(const ReductionSetup& /*setup*/, const AddedValues& added) {
  return added.last ? std::abs(added.value - *added.last) : 0.0;
}

double time_above(const ReductionSetup& setup, const AddedValues& added) {
  return added.value > setup.level.value() ? setup.period_s : 0.0;
}

double time_outside(const ReductionSetup& setup, const AddedValues& added) {
  const bool is_below = added.value < setup.lower.value();
  return is_below ? setup.period_s : time_above(setup, added);
}

// 1 for a rise above the level.
double rise_of(const ReductionSetup& setup, const AddedValues& added) {
  const double level = setup.level.value();
  return added.value > level && added.last.value_or(0.0) <= level ? 1.0 : 0.0;
}

// 1 for a rise between values that both lie in the window.
double inner_rise_of(const ReductionSetup& setup, const AddedValues& added) {
  return added.is_first ? 0.0 : rise_of(setup, added);
}

template <std::optional<double> (SampleStatistics::*kStatistic)() const, Number kNumber = value_of>
class Statistic : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override { numbers_.add(kNumber(setup_, added)); }
  std::optional<double> value() const override { return (numbers_.*kStatistic)(); }

 private:
  SampleStatistics numbers_;
};

template <Number kNumber>
using Total = Statistic<&SampleStatistics::sum, kNumber>;

class Bounces final : public Total<rise_of> {
 public:
  using Statistic::Statistic;
  std::optional<double> value() const override {
    const double rises = *Statistic::value();
    return rises == 0.0 ? std::nullopt : std::optional(rises - 1.0);
  }
};

class RiseRate final : public Total<inner_rise_of> {
 public:
  using Statistic::Statistic;
  std::optional<double> value() const override {
    return *Statistic::value() / setup_.window.length_s();
  }
};

class Settling final : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override {
    const bool is_inside = std::abs(added.value) <= std::abs(setup_.level.value());
    if (!is_inside) {
      settled_at_s_.reset();
    } else if (!settled_at_s_) {
      settled_at_s_ = added.time_s;
    }
  }
  std::optional<double> value() const override {
    if (!settled_at_s_) return std::nullopt;
    return *settled_at_s_ - setup_.window.from_s.value();
  }

 private:
  std::optional<double> settled_at_s_;
};

bool exceeds(double value, double level) {
  return value > level;
}

// No value reaches a level of 0.
bool reaches(double value, double level) {
  return level != 0.0 && std::abs(value) >= std::abs(level);
}

template <bool (*kIsThere)(double value, double level)>
class TimeUntil final : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override {
    if (!time_s_ && kIsThere(added.value, setup_.level.value())) {
      time_s_ = added.time_s - setup_.window.from_s.value();
    }
  }
  std::optional<double> value() const override { return time_s_; }

 private:
  std::optional<double> time_s_;
};

// The values of a line at 0, by least squares.
class LineAtZero {
 public:
  void add(double x, double y) {
    n_ += 1.0;
    x_ += x;
    xx_ += x * x;
    y_ += y;
    xy_ += x * y;
  }
  double value() const { return (y_ * xx_ - x_ * xy_) / (n_ * xx_ - x_ * x_); }

 private:
  double n_ = 0.0, x_ = 0.0, xx_ = 0.0, y_ = 0.0, xy_ = 0.0;
};

// The level is the time of the jump. The lower level is the length of both lines, and of the gap
// behind it.
class Jump final : public Reduction {
 public:
  explicit Jump(const ReductionSetup& setup)
      : Reduction(setup), length_s_(setup.lower.value()), before_(count()) {}

  void add(const AddedValues& added) override {
    const double since_s = added.time_s - setup_.level.value();
    if (since_s < 0.0) {
      before_[number_++ % before_.size()] = {added.time_s, added.value};
    } else if (since_s >= length_s_ && since_s < 2.0 * length_s_) {
      after_.add(since_s, added.value);
    }
    last_s_ = added.time_s;
  }

  std::optional<double> value() const override {
    const double at_s = setup_.level.value();
    if (number_ < before_.size() || !(last_s_ >= at_s + 2.0 * length_s_)) return std::nullopt;
    LineAtZero before;
    for (const auto& [time_s, value] : before_) before.add(time_s - at_s, value);
    return after_.value() - before.value();
  }

 private:
  std::size_t count() const {
    constexpr double kLeast = 2.0, kMost = 1e7;
    const double number = std::round(length_s_ / setup_.period_s);
    if (!setup_.lower.is_constant() || !(number >= kLeast && number <= kMost)) {
      throw std::invalid_argument(
          "lower: a jump needs the length of its lines, two values or more");
    }
    return static_cast<std::size_t>(number);
  }

  double length_s_;
  std::vector<std::pair<double, double>> before_;  // the last ones before the jump
  std::size_t number_ = 0;                         // ever written there
  LineAtZero after_;
  double last_s_ = -kOpen;
};

class Overshoot final : public Beyond {
 public:
  using Beyond::Beyond;
  std::optional<double> value() const override {
    if (first() == 0.0) return std::nullopt;
    return 100.0 * *Beyond::value() / std::abs(first());
  }
};

class RelativeRms final : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override {
    error_.add(added.all[0] - added.all[1]);
    truth_.add(added.all[1]);
  }
  std::optional<double> value() const override {
    if (!(*truth_.rms() > 0.0)) return std::nullopt;
    return *error_.rms() / *truth_.rms();
  }

 private:
  SampleStatistics error_;
  SampleStatistics truth_;
};

// √(mean |e|²/n) of a vector of n values. Eigen's sum of squares keeps the bits of fixed vectors.
class RmsPerValue final : public Reduction {
 public:
  explicit RmsPerValue(const ReductionSetup& setup)
      : Reduction(setup), values_(static_cast<Eigen::Index>(setup.values)) {}
  void add(const AddedValues& added) override {
    values_ = Eigen::Map<const Eigen::VectorXd>(added.all.data(), values_.size());
    squares_.add(values_.squaredNorm() / static_cast<double>(values_.size()));
  }
  std::optional<double> value() const override { return std::sqrt(*squares_.mean()); }

 private:
  Eigen::VectorXd values_;
  SampleStatistics squares_;
};

// The largest number of times that one of the values turns back by more than the level from its
// farthest point. The first motion is not a turn.
class Reversals final : public Reduction {
 public:
  explicit Reversals(const ReductionSetup& setup)
      : Reduction(setup), band_(std::abs(setup.level.value())), motions_(setup.values) {}
  void add(const AddedValues& added) override {
    for (std::size_t i = 0; i < motions_.size(); ++i) motions_[i].add(added.all[i], band_);
  }
  std::optional<double> value() const override {
    int most = 0;
    for (const Motion& motion : motions_) most = std::max(most, motion.turns);
    return most;
  }

 private:
  struct Motion {
    void add(double value, double band) {
      if (way == 0.0) {
        smallest = std::min(smallest, value);
        largest = std::max(largest, value);
        if (value > smallest + band) set_out(1.0, value);
        if (value < largest - band) set_out(-1.0, value);
      } else if (way * (value - farthest) > 0.0) {
        farthest = value;
      } else if (way * (farthest - value) > band) {
        ++turns;
        set_out(-way, value);
      }
    }
    void set_out(double to, double from) {
      way = to;
      farthest = from;
    }

    int turns = 0;
    double way = 0.0;  // direction: 1, -1, or 0 before the first motion
    double farthest = 0.0;
    double smallest = kOpen;
    double largest = -kOpen;
  };

  double band_;
  std::vector<Motion> motions_;
};

class Decay final : public Reduction {
 public:
  using Reduction::Reduction;
  void add(const AddedValues& added) override {
    const double fifth_s = setup_.window.length_s() / 5.0;
    const double rounding_s = setup_.window.rounding_s;
    const double from_s = setup_.window.from_s.value();
    const double end_s = from_s + setup_.window.length_s();
    if (added.time_s < from_s + fifth_s - rounding_s) first_.add(added.value);
    if (added.time_s >= end_s - fifth_s - rounding_s) last_.add(added.value);
  }
  std::optional<double> value() const override {
    const auto first = first_.standard_deviation(), last = last_.standard_deviation();
    if (!first || !last || !(*first > 0.0)) return std::nullopt;
    return *last / *first;
  }

 private:
  SampleStatistics first_;
  SampleStatistics last_;
};

}  // namespace

void Beyond::add(const AddedValues& added) {
  if (added.is_first) std::copy(added.all.begin(), added.all.end(), first_.begin());
  for (std::size_t i = 0; i < first_.size(); ++i) {
    beyond_ = std::max(beyond_, first_[i] > 0.0 ? -added.all[i] : added.all[i]);
  }
}

MetricExpression::MetricExpression(const std::string& text, const Numbers& numbers,
                                   const Events& events) {
  const auto wrong = [&] {
    return std::invalid_argument(
        "must be a number, or names and numbers with spaces around + - *: "
        "\"first_contact + 0.2\"");
  };
  constexpr const char* kSpaces = " \t\n\v\f\r";
  bool is_factor = true, is_negative = false, is_product = false;
  for (std::size_t from = text.find_first_not_of(kSpaces), end = 0; from != std::string::npos;
       from = text.find_first_not_of(kSpaces, end), is_factor = !is_factor) {
    end = std::min(text.find_first_of(kSpaces, from), text.size());
    const std::string word = text.substr(from, end - from);
    if (!is_factor) {
      if (word != "+" && word != "-" && word != "*") throw wrong();
      is_product = word == "*";
      is_negative = word == "-";
      continue;
    }
    if (!is_product) terms_.push_back({is_negative, {}});
    Factor factor{0.0, nullptr};
    if (const auto number = number_in(word)) {
      factor.number = *number;
    } else {
      const bool is_opposite = word.front() == '-';
      const std::string name = is_opposite ? word.substr(1) : word;
      if (is_opposite && is_product) throw wrong();
      if (is_opposite) terms_.back().is_negative = !terms_.back().is_negative;
      if (const auto event = events.find(name); event != events.end()) {
        factor.event = event->second;
        is_constant_ = false;
      } else if (const auto known = numbers(name)) {
        factor.number = *known;
      } else {
        throw std::invalid_argument("there is no number or event \"" + name + "\"");
      }
    }
    terms_.back().factors.push_back(factor);
  }
  if (is_factor) throw wrong();
  constant_ = sum();
}

double MetricExpression::sum() const {
  double sum = 0.0;
  for (const Term& term : terms_) {
    double product = 1.0;
    for (const Factor& factor : term.factors) {
      product *= factor.event != nullptr ? *factor.event : factor.number;
    }
    sum += term.is_negative ? -product : product;
  }
  return sum;
}

bool MetricWindow::contains(double time_s) const {
  const double from = from_s.value();
  const double rounding = before_s ? rounding_s : 0.0;
  if (from < 0.0 || time_s < from - rounding) return false;
  if (before_s && !(time_s < before_s->value() - rounding)) return false;
  if (!to_s) return true;
  const double to = to_s->value();
  return (to <= run_end_s || to == kOpen) && (goes_on || time_s <= to);
}

double MetricWindow::length_s() const {
  const double end_s = before_s ? before_s->value() : to_s ? to_s->value() : run_end_s;
  return end_s - from_s.value();
}

const std::vector<MetricKind>& standard_metric_kinds() {
  static const std::vector<MetricKind> kinds = {
      {"rms", "root mean square", "", make_reduction<Statistic<&SampleStatistics::rms>>},
      {"mean", "mean", "", make_reduction<Statistic<&SampleStatistics::mean>>},
      {"running_mean", "mean, by Welford's recursion", "",
       make_reduction<Statistic<&SampleStatistics::running_mean>>},
      {"max", "largest value", "", make_reduction<Statistic<&SampleStatistics::largest>>},
      {"min", "smallest value", "", make_reduction<Statistic<&SampleStatistics::smallest>>},
      {"peak", "largest magnitude", "", make_reduction<Statistic<&SampleStatistics::peak>>},
      {"std", "sample standard deviation", "",
       make_reduction<Statistic<&SampleStatistics::standard_deviation>>},
      {"deviation", "largest deviation from the mean", "",
       make_reduction<Statistic<&SampleStatistics::largest_deviation>>},
      {"excess", "largest value, or 0 if none is above 0", "",
       make_reduction<Statistic<&SampleStatistics::excess>>},
      {"first", "first value of the window", "",
       make_reduction<Statistic<&SampleStatistics::first>>},
      {"last", "last value of the window", "", make_reduction<Statistic<&SampleStatistics::last>>},
      {"rms_change", "root mean square of the change from sample to sample", "",
       make_reduction<Statistic<&SampleStatistics::rms, change_of>>},
      {"travel", "sum of the magnitudes of all changes from sample to sample", "",
       make_reduction<Total<travel_of>>},
      {"sum", "sum", "", make_reduction<Total<value_of>>},
      {"integral", "sum of the values times the time between them", kTimesSeconds,
       make_reduction<Total<area_of>>},
      {.name = "settling",
       .meaning =
           "time from the window's start until the magnitude stays within the level to its end",
       .unit = "s",
       .make = make_reduction<Settling>,
       .has_level = true,
       .why_absent = "the magnitude ends beyond the level"},
      {.name = "settled",
       .meaning = "time from the window's start until the magnitude stays within the level to the "
                  "end of the run, which covers the window",
       .unit = "s",
       .make = make_reduction<Settling>,
       .has_level = true,
       .goes_on = true,
       .why_absent = "the magnitude ends beyond the level"},
      {.name = "reach",
       .meaning = "time from the window's start until the magnitude first reaches the level",
       .unit = "s",
       .make = make_reduction<TimeUntil<reaches>>,
       .has_level = true,
       .why_absent = "the magnitude never reaches the level"},
      {.name = "exceed",
       .meaning = "time from the window's start until the value is first above the level",
       .unit = "s",
       .make = make_reduction<TimeUntil<exceeds>>,
       .has_level = true,
       .why_absent = "the value never rises above the level"},
      {.name = "jump",
       .meaning = "jump at the time `level`, by a line before and one behind a gap; `lower` is the "
                  "length of all three [s]",
       .make = make_reduction<Jump>,
       .has_level = true,
       .why_absent = "the run is too short before or after the jump"},
      {.name = "beyond",
       .meaning = "farthest value beyond 0, on the other side of the window's first value",
       .make = make_reduction<Beyond>,
       .takes_all = true},
      {.name = "overshoot",
       .meaning = "farthest value beyond 0, on the other side of the window's first value, as a "
                  "share of this first value",
       .unit = "%",
       .make = make_reduction<Overshoot>,
       .why_absent = "the first value of its window is 0"},
      {.name = "time",
       .meaning = "time for which the value is above the level",
       .unit = "s",
       .make = make_reduction<Total<time_above>>,
       .has_level = true},
      {.name = "time_outside",
       .meaning = "time for which the value is above the level or below the lower one",
       .unit = "s",
       .make = make_reduction<Total<time_outside>>,
       .has_level = true},
      {.name = "bounces",
       .meaning = "number of times that the value rises above the level, without the first: "
                  "bounces",
       .unit = "1",
       .make = make_reduction<Bounces>,
       .has_level = true,
       .why_absent = "the value never rises above the level"},
      {.name = "rises",
       .meaning = "number of times that the value rises above the level within the window",
       .unit = "1",
       .make = make_reduction<Total<inner_rise_of>>,
       .has_level = true},
      {.name = "rise_rate",
       .meaning = "number of times per second that the value rises above the level",
       .unit = "Hz",
       .make = make_reduction<RiseRate>,
       .has_level = true},
      {.name = "restitution",
       .meaning = "opposite of the last value over the first one",
       .unit = "1",
       .make = make_reduction<Statistic<&SampleStatistics::rebound>>,
       .why_absent = "the first value of its window is not positive"},
      {.name = "decay",
       .meaning = "standard deviation in the window's last fifth over that in its first fifth",
       .unit = "1",
       .make = make_reduction<Decay>,
       .why_absent = "the value is constant in the window's first fifth"},
      {.name = "relative_rms",
       .meaning = "root mean square of the first signal less the second, over that of the second",
       .unit = "1",
       .make = make_reduction<RelativeRms>,
       .takes_all = true,
       .why_absent = "the second signal is 0"},
      {.name = "rms_per_value",
       .meaning = "root mean square of all values, per value",
       .make = make_reduction<RmsPerValue>,
       .takes_all = true},
      {.name = "reversals",
       .meaning = "largest number of times that one of the values turns back by more than the "
                  "level",
       .unit = "1",
       .make = make_reduction<Reversals>,
       .has_level = true,
       .takes_all = true}};
  return kinds;
}

}  // namespace breakwater
