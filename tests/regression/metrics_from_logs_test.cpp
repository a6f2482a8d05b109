// Each metric again, from the log, with plain loops over whole arrays.
#include "regression/run_case.h"
#include "tables.h"

namespace breakwater::metrics_from_logs_test {

using testing::run_case;
using Values = std::vector<double>;
using Rows = std::vector<Values>;  // the values at each time

Values of(const Recording& run, const std::string& signal) {
  return run.track("control").values(signal);
}

// The values from one time to another, both included.
Values between(const Recording& run, const Values& values, double from_s, double to_s) {
  const Values times = run.track("control").times();
  Values part;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (times[i] >= from_s && times[i] <= to_s) part.push_back(values[i]);
  }
  return part;
}

Values difference(Values a, const Values& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

double mean(const Values& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms(const Values& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                   static_cast<double>(values.size()));
}

Values sizes(Values values) {
  for (double& value : values) value = std::abs(value);
  return values;
}

double largest(const Values& values) {
  return *std::max_element(values.begin(), values.end());
}

double largest_size(const Values& values) {
  return largest(sizes(values));
}

Values about_mean(const Values& values) {
  return difference(values, Values(values.size(), mean(values)));
}

double spread(const Values& values) {
  const auto n = static_cast<double>(values.size());
  return rms(about_mean(values)) * std::sqrt(n / (n - 1.0));
}

Values changes(const Values& values) {
  return difference(Values(values.begin() + 1, values.end()), values);
}

// ---- one reader for all rows -------------------------------------------------------------------

// The data of a reduction. The values are those of the window.
struct Part {
  Values times;
  Values values;
  Rows rows;            // all signals or values
  double before = 0.0;  // the value before the window
  double from_s, to_s, level, lower, period_s;

  // The time of the first value that fits; nothing if none does.
  std::optional<double> first_time(const std::function<bool(double)>& fits) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (fits(values[i])) return times[i];
    }
    return std::nullopt;
  }
  double time_of(const std::function<bool(double)>& fits) const {
    return period_s * static_cast<double>(std::count_if(values.begin(), values.end(), fits));
  }
  int rises(Values all) const {
    int count = 0;
    for (std::size_t i = 1; i < all.size(); ++i) {
      count += all[i] > level && all[i - 1] <= level ? 1 : 0;
    }
    return count;
  }
  Values while_in(double from, double to) const {
    Values part;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (times[i] >= from - 1e-9 && times[i] < to - 1e-9) part.push_back(values[i]);
    }
    return part;
  }
  Values column(std::size_t i) const {
    Values values_of;
    for (const Values& row : rows) values_of.push_back(row[i]);
    return values_of;
  }
};

using Again = std::function<std::optional<double>(const Part&)>;

std::optional<double> settled(const Part& part) {
  std::optional<double> since;
  for (std::size_t i = part.values.size(); i-- > 0;) {
    if (std::abs(part.values[i]) > std::abs(part.level)) break;
    since = part.times[i] - part.from_s;
  }
  return since;
}

const std::map<std::string, Again>& reductions() {
  const auto since = [](const Part& part, const std::optional<double>& time) {
    return time ? std::optional(*time - part.from_s) : std::nullopt;
  };
  static const std::map<std::string, Again> known = {
      {"rms", [](const Part& p) { return rms(p.values); }},
      {"mean", [](const Part& p) { return mean(p.values); }},
      {"running_mean", [](const Part& p) { return mean(p.values); }},
      {"max", [](const Part& p) { return largest(p.values); }},
      {"min", [](const Part& p) { return *std::min_element(p.values.begin(), p.values.end()); }},
      {"peak", [](const Part& p) { return largest_size(p.values); }},
      {"std", [](const Part& p) { return spread(p.values); }},
      {"deviation", [](const Part& p) { return largest_size(about_mean(p.values)); }},
      {"excess", [](const Part& p) { return std::max(0.0, largest(p.values)); }},
      {"first", [](const Part& p) { return p.values.front(); }},
      {"last", [](const Part& p) { return p.values.back(); }},
      {"rms_change",
       [](const Part& p) {
         Values all = {p.before};
         all.insert(all.end(), p.values.begin(), p.values.end());
         return rms(changes(all));
       }},
      {"travel",
       [](const Part& p) {
         const Values steps = sizes(changes(p.values));
         return std::accumulate(steps.begin(), steps.end(), 0.0);
       }},
      {"integral",
       [](const Part& p) {
         return p.period_s * std::accumulate(p.values.begin(), p.values.end(), 0.0);
       }},
      {"settling", settled},
      {"settled", settled},
      {"reach",
       [since](const Part& p) -> std::optional<double> {
         if (p.level == 0.0) return std::nullopt;
         return since(p, p.first_time([&](double v) { return std::abs(v) >= std::abs(p.level); }));
       }},
      {"exceed",
       [since](const Part& p) {
         return since(p, p.first_time([&](double v) { return v > p.level; }));
       }},
      {"overshoot",
       [](const Part& p) {
         const double way = p.values.front() > 0.0 ? -1.0 : 1.0;
         double beyond = 0.0;
         for (const double v : p.values) beyond = std::max(beyond, way * v);
         return 100.0 * beyond / std::abs(p.values.front());
       }},
      {"time", [](const Part& p) { return p.time_of([&](double v) { return v > p.level; }); }},
      {"time_outside",
       [](const Part& p) {
         return p.time_of([&](double v) { return v > p.level || v < p.lower; });
       }},
      {"bounces",
       [](const Part& p) -> std::optional<double> {
         Values all = {p.before};
         all.insert(all.end(), p.values.begin(), p.values.end());
         if (p.rises(all) == 0) return std::nullopt;
         return p.rises(all) - 1;
       }},
      {"rises", [](const Part& p) { return p.rises(p.values); }},
      {"rise_rate", [](const Part& p) { return p.rises(p.values) / (p.to_s - p.from_s); }},
      {"decay",
       [](const Part& p) -> std::optional<double> {
         const double fifth_s = (p.to_s - p.from_s) / 5.0;
         const double first = spread(p.while_in(p.from_s, p.from_s + fifth_s));
         if (first == 0.0) return std::nullopt;
         return spread(p.while_in(p.to_s - fifth_s, p.to_s)) / first;
       }},
      {"relative_rms",
       [](const Part& p) { return rms(difference(p.column(0), p.column(1))) / rms(p.column(1)); }},
      {"rms_per_value", [](const Part& p) {
         double squares = 0.0;
         for (const Values& row : p.rows) squares += std::pow(rms(row), 2);
         return std::sqrt(squares / static_cast<double>(p.rows.size()));
       }}};
  return known;
}

// The rows of a signal of the log, NAME or NAME[2]; empty if the log does not have it.
Rows logged(const Track& track, const std::string& text) {
  const std::string name = whole_key(text);
  for (std::size_t i = 0; i < track.signals(); ++i) {
    if (track.signal(i).name != name) continue;
    const std::size_t width = track.signal(i).values.size();
    const Values values = track.values(i);
    Rows rows;
    for (std::size_t k = 0; k < track.rows(); ++k) {
      const auto row = values.begin() + static_cast<std::ptrdiff_t>(k * width);
      rows.emplace_back(row, row + static_cast<std::ptrdiff_t>(width));
      if (text != name)
        rows.back() = {rows.back().at(std::stoul(text.substr(name.size() + 1)) - 1)};
    }
    return rows;
  }
  return {};
}

double taken(const MetricRow& row, const Values& values) {
  switch (row.take) {
    case Taken::largest:
      return largest(values);
    case Taken::largest_size:
      return largest_size(values);
    case Taken::norm:
      return rms(values) * std::sqrt(static_cast<double>(values.size()));
    default:
      return values.front();
  }
}

// A signal of metrics that the log has except for a constant: the logged one minus the constant.
// Without a logged one it is the constant.
struct Derived {
  std::string logged;
  double constant;
};
using AllDerived = std::map<std::string, Derived>;

struct Reader {
  const Recording& run;
  AllDerived derived;
  const MetricRows& rows;
  double end_s;
  MetricExpression::Events events;

  const Track& track_of(const MetricRow& row) const {
    const bool is_fine = rows.is_at_step(row) && run.tracks.size() > 1;
    return run.track(is_fine ? "physics" : "control");
  }
  Rows signal(const Track& track, const std::string& name) const {
    const auto found = derived.find(name);
    if (found == derived.end()) return logged(track, name);
    const auto& [of, constant] = found->second;
    if (of.empty()) return Rows(track.rows(), {constant});
    Rows shifted = logged(track, of);
    for (Values& row : shifted) row.front() -= constant;
    return shifted;
  }
  // The values of all signals of a row; empty if the log lacks one.
  Rows values(const MetricRow& row) const {
    const Track& track = track_of(row);
    const std::size_t comma = row.of.find(", ");
    Rows all = signal(track, row.of.substr(0, comma));
    if (comma != std::string::npos) {
      const Rows second = signal(track, row.of.substr(comma + 2));
      if (second.empty()) return {};
      for (std::size_t i = 0; i < all.size(); ++i) all[i].push_back(second[i].front());
    }
    if (row.minus == "none") return all;
    const Rows other = signal(track, row.minus);
    if (other.empty()) return {};
    for (std::size_t i = 0; i < all.size(); ++i) all[i].front() -= other[i].front();
    return all;
  }
  // The metric again; nothing if it does not apply.
  std::optional<double> again(const MetricRow& row, const Rows& all) const {
    const auto number = [&](const std::string& text) {
      return rows.expression(text, events).value();
    };
    const Values times = track_of(row).times();
    Part part;
    part.from_s = number(row.from_s);
    const bool is_open = row.to_s == "0.0", has_before = row.before_s != "0.0";
    part.to_s = has_before ? number(row.before_s) : is_open ? end_s : number(row.to_s);
    part.level = number(row.level);
    part.lower = number(row.lower);
    part.period_s = rows.period_of(row);
    if (part.from_s < 0.0 || (!is_open && number(row.to_s) > end_s)) return std::nullopt;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double value = taken(row, all[i]);
      const bool is_late = has_before ? times[i] >= part.to_s - 1e-9
                                      : row.kind != "settled" && times[i] > part.to_s + 1e-9;
      if (times[i] < part.from_s - (has_before ? 1e-9 : 0.0)) part.before = value;
      if (times[i] < part.from_s - (has_before ? 1e-9 : 0.0) || is_late) continue;
      part.times.push_back(times[i]);
      part.values.push_back(value);
      part.rows.push_back(all[i]);
    }
    if (part.values.empty()) return std::nullopt;
    return reductions().at(row.kind)(part);
  }
};

// The start pose is (0.45 m, 0, 0).
const AllDerived kOfTheWall = {{"force_reference_N", {"", 2.0}},
                               {"y_offset_m", {"y_true_m", 0.0}},
                               {"phi_offset_rad", {"phi_true_rad", 0.0}}};

using Case = std::vector<std::string>;  // a row of texts.txt

class MetricsFromLogs : public ::testing::TestWithParam<Case> {};

TEST_P(MetricsFromLogs, AreThoseOfTheRun) {
  const Case& one = GetParam();
  const std::string& scenario = one.at(0);
  const PreparedRun prepared = testing::prepare(scenario, one.at(1), testing::words_in(one.at(2)));
  const Recording run = prepared.scenario->run({});
  ASSERT_FALSE(run.failure);
  const MetricRows& rows = prepared.scenario->metric_rows();
  // The events, from the log.
  double first_contact_s = kInfinity, first_separation_s = kInfinity;
  if (run.tracks.size() > 1) {
    const double from_s = scenario == "arm_wall_contact" ? 10.0 : 0.0;
    const Track& fine = run.track("physics");
    const Values times = fine.times(), force = fine.values("force_true_N");
    for (std::size_t i = 0; i < force.size(); ++i) {
      if (force[i] > 0.0 && times[i] >= from_s) {
        first_contact_s = std::min(first_contact_s, times[i]);
      } else if (first_contact_s < kInfinity) {
        first_separation_s = std::min(first_separation_s, times[i]);
      }
    }
  }
  const Reader reader{
      run,
      scenario == "arm_wall_contact" ? kOfTheWall : AllDerived(),
      rows,
      prepared.scenario->run_settings().duration_s,
      {{"first_contact", &first_contact_s}, {"first_separation", &first_separation_s}}};
  std::set<std::string> not_logged;
  int found = 0;
  for (std::size_t i = 0; i < rows.rows().size(); ++i) {
    const MetricRow& row = rows.rows()[i];
    const std::string name = row.definition(rows.kind_of(row)).name;
    if (row.is_signal || !rows.unmet(i).empty()) continue;
    const Rows values = reader.values(row);
    if (values.empty() || !reductions().contains(row.kind)) {
      not_logged.insert(name);
      continue;
    }
    const auto again = reader.again(row, values);
    const auto metric = run.metric(name);
    EXPECT_EQ(again.has_value(), metric.has_value()) << name;
    if (!again || !metric) continue;
    ++found;
    EXPECT_NEAR(*metric, *again, 1e-9 * std::max(1.0, std::abs(*again))) << name;
  }
  EXPECT_GT(found, 2);
  const std::vector<std::string> expected = testing::words_in(one.at(3));
  EXPECT_EQ(not_logged, std::set<std::string>(expected.begin(), expected.end()));
}

INSTANTIATE_TEST_SUITE_P(Regression, MetricsFromLogs,
                         ::testing::ValuesIn(testing::rows_of("MetricsFromLogs")),
                         [](const auto& row) {
                           return row.param.at(0) + std::to_string(row.index);
                         });

// ---- what no row says --------------------------------------------------------------------------

TEST(SignalsOfMetrics, RawVelocityOfTheMotorIsTheRawDifference) {
  const Recording run = run_case("motor_estimation", "mdob", {"encoder.bits=8"});
  const Values angle = of(run, "position_measured_rad");
  const Values times = run.track("control").times();
  Values raw(angle.size(), 0.0);
  for (std::size_t i = 1; i < raw.size(); ++i) {
    raw[i] = (angle[i] - angle[i - 1]) / (times[i] - times[i - 1]);
  }
  EXPECT_LT(largest_size(difference(raw, of(run, "velocity_raw_rad_s"))), 1e-6);
}

TEST(SignalsOfMetrics, LagOfARampIsItsMeanErrorOverItsSlope) {
  const Recording run = run_case("cart_estimation", "order1", {"disturbance.kind=ramp"});
  const Values late = difference(of(run, "d_true_N"), of(run, "d_hat_N"));
  const double slope = of(run, "d_true_N").back() - of(run, "d_true_N").rbegin()[1];
  const double period_s = run.track("control").times()[1];
  EXPECT_NEAR(*run.metric("disturbance_lag_s"),
              mean(between(run, late, 40.0, 50.0)) / (slope / period_s), 1e-9);
}

// d shifted by the lag fits d̂, except for a gain, better than with a smaller or larger shift.
TEST(SignalsOfMetrics, LagOfASineIsTheDelayThatFitsBest) {
  const Recording run = run_case("cart_estimation", "order2", {"disturbance.kind=sine"});
  const double lag_s = *run.metric("disturbance_lag_s");
  const double period_s = run.track("control").times()[1];
  const Values truth = of(run, "d_true_N"), estimate = of(run, "d_hat_N");
  const auto misfit = [&](double delay_s) {
    const auto shift = static_cast<std::ptrdiff_t>(std::lround(delay_s / period_s));
    double of_estimate = 0.0, of_truth = 0.0, of_both = 0.0;
    for (auto i = static_cast<std::ptrdiff_t>(20.0 / period_s);
         i < static_cast<std::ptrdiff_t>(truth.size()); ++i) {
      if (i - shift < 0 || i - shift >= static_cast<std::ptrdiff_t>(truth.size())) continue;
      const double here = estimate[static_cast<std::size_t>(i)];
      const double there = truth[static_cast<std::size_t>(i - shift)];
      of_estimate += here * here;
      of_truth += there * there;
      of_both += here * there;
    }
    return of_estimate - of_both * of_both / of_truth;  // with the best gain
  };
  for (const double off_s : {-1.0, 1.0}) EXPECT_LT(misfit(lag_s), misfit(lag_s + off_s));
}

}  // namespace breakwater::metrics_from_logs_test
