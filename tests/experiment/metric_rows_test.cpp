// Rows of a file. tests/python/logs_test.py has those of the scenarios.
#include <breakwater/experiment/metric_rows.h>

#include <deque>
#include <optional>

#include "support.h"
#include "tables.h"

namespace breakwater::metric_rows_test {

// Rows without a run: signals and an event whose values the test sets.
class History {
 public:
  explicit History(const std::string& rows, const std::string& keys = "") {
    const testing::TemporaryPath path("rows.toml",
                                      "scenario = \"plant\"\n" + keys + rows + "\n[case.a]\n");
    const Config config = ScenarioFile(path, "plant").config("a");
    rows_.learn(config);
    Fields fields;
    rows_.bind(fields);
    std::map<std::string, ConfigEntry> own;
    for (const auto& [key, entry] : config.entries()) {
      if (key.starts_with("metric") || key.starts_with("signal")) own.emplace(key, entry);
    }
    fields.read(Config("file", own));
    PhysicsSettings physics;
    physics.timestep_s = physics.control_period_s = 1e-4;
    rows_.check(config, Fields(), physics, {.events = {"hit"}});
  }

  // The value of a signal, to be set.
  double& signal(const std::string& name) {
    signals_.push_back({name, "", "", view(values_.emplace_back(0.0))});
    return values_.back();
  }
  MetricValues& run() {
    const MetricExpression::Events events = {{"hit", &hit_s}};
    return run_.emplace(rows_, signals_, 10.0, events);
  }
  std::optional<double> metric(const std::string& name) const {
    for (const Metric& metric : run_->metrics()) {
      if (metric.name == name) return metric.value;
    }
    return std::nullopt;
  }

  double hit_s = kInfinity;

 private:
  MetricRows rows_;
  std::deque<double> values_;
  std::vector<Signal> signals_;
  std::optional<MetricValues> run_;
};

// In the step response of ω² / (s² + 2 ζ ω s + ω²) the overshoot is exp(−π ζ/√(1 − ζ²)). The error
// last leaves ±5 % where its sampled magnitude does.
TEST(MetricRowsTest, SecondOrderResponse) {
  constexpr double kZeta = 0.3, kOmega = 5.0;
  const double damped = kOmega * std::sqrt(1.0 - kZeta * kZeta);
  History history(
      "[metric.s]\nof = \"error_m\"\nkind = \"settling\"\nlevel = \"2 * task.band\"\n"
      "[metric.o]\nof = \"error_m\"\nkind = \"overshoot\"\n",
      "task.band = 0.025\n");
  double& error = history.signal("error_m");
  MetricValues& run = history.run();
  double last_outside_s = 0.0;
  for (int k = 0; k <= 100000; ++k) {
    const double t = k / 1e4;
    error = -std::exp(-kZeta * kOmega * t) *
            (std::cos(damped * t) + kZeta * kOmega / damped * std::sin(damped * t));
    if (std::abs(error) > 0.05) last_outside_s = t;
    run.at_step(t);
    run.at_sample(t);
  }
  EXPECT_NEAR(history.metric("o_percent").value(),
              100.0 * std::exp(-M_PI * kZeta / std::sqrt(1.0 - kZeta * kZeta)), 1e-4);
  EXPECT_NEAR(history.metric("s_s").value(), last_outside_s + 1e-4, 1e-9);
}

// The metric of a row for these values of a_m, from 0 s on.
std::optional<double> reduced(const std::string& row, const std::vector<double>& values,
                              double period_s = 1.0) {
  History history("[metric.m]\nof = \"a_m\"\nunit = \"m\"\n" + row);
  double& a = history.signal("a_m");
  MetricValues& run = history.run();
  for (std::size_t k = 0; k < values.size(); ++k) {
    a = values[k];
    run.at_step(period_s * static_cast<double>(k));
    run.at_sample(period_s * static_cast<double>(k));
  }
  return history.metric("m");
}

TEST(MetricRowsTest, AWindowHasBothOfItsEnds) {
  const std::vector<double> values = {100.0, -3.0, -2.0, -1.0, 100.0};
  for (const auto& [kind, expected] : std::map<std::string, double>{{"mean", -2.0},
                                                                    {"running_mean", -2.0},
                                                                    {"rms", std::sqrt(14.0 / 3.0)},
                                                                    {"max", -1.0},
                                                                    {"min", -3.0},
                                                                    {"peak", 3.0},
                                                                    {"std", 1.0},
                                                                    {"deviation", 1.0}}) {
    const std::string row = "kind = \"" + kind + "\"\nfrom_s = 1.0\n";
    EXPECT_DOUBLE_EQ(reduced(row + "to_s = 3.0\n", values).value(), expected) << kind;
    EXPECT_FALSE(reduced(row + "to_s = 3.0\n", {1.0})) << kind << " without values";
    EXPECT_FALSE(reduced(row + "to_s = 11.0\n", values)) << kind << " of a run that is too short";
  }
}

TEST(MetricRowsTest, TheSpreadDoesNotSufferFromALargeMean) {
  SampleStatistics statistics;
  for (int k = 0; k < 1000; ++k) statistics.add(1e8 + (k % 2 == 0 ? 0.5 : -0.5));
  EXPECT_NEAR(*statistics.standard_deviation(), 0.5 * std::sqrt(1000.0 / 999.0), 1e-6);
}

TEST(MetricRowsTest, ReversalsAreLargerThanTheLevel) {
  const std::string row = "kind = \"reversals\"\nlevel = 0.1\n";
  EXPECT_EQ(reduced(row, {0.0, 0.05, -0.04, 0.05}), 0.0) << "within the band";
  EXPECT_EQ(reduced(row, {0.0, 0.5, 1.0}), 0.0) << "the first way";
  EXPECT_EQ(reduced(row, {0.0, 1.0, 0.95, 1.0, 0.91}), 0.0);
  EXPECT_EQ(reduced(row, {0.0, 1.0, 0.95, 0.89}), 1.0) << "by small steps";
  EXPECT_EQ(reduced(row, {0.0, -1.0, 0.0, -1.0, 0.0}), 3.0);
  // Each swing of a damped cosine is e^(−0.2 π) times the one before: 1.54 (does not count), 0.83,
  // 0.45, 0.24, 0.13, 0.07.
  std::vector<double> swings;
  for (int i = 0; i < 10000; ++i) swings.push_back(std::exp(-0.002 * i) * std::cos(0.01 * i));
  EXPECT_EQ(reduced(row, swings, 1e-3), 4.0);
}

TEST(MetricRowsTest, TimesCountFromTheWindowsStart) {
  const std::string settling = "kind = \"settling\"\nlevel = 0.5\nfrom_s = 1.0\nto_s = 7.0\n";
  const std::vector<double> errors = {9.0, 9.0, 0.4, 0.6, 0.5, -0.1, 0.0};
  EXPECT_EQ(reduced(settling, errors), 3.0);  // in the band from 4 s
  std::vector<double> leaves = errors;
  leaves.insert(leaves.end(), {0.7, 0.0});  // values behind the window do not count
  EXPECT_FALSE(reduced(settling, leaves));
  const std::string settled = "kind = \"settled\"\nlevel = 0.5\nfrom_s = 1.0\nto_s = ";
  const std::vector<double> late = {9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 0.0, 0.0};
  EXPECT_EQ(reduced(settled + "3.0\n", late), 5.0) << "the rest of the run counts";
  EXPECT_FALSE(reduced(settled + "11.0\n", late));
  const std::string reach = "kind = \"reach\"\nfrom_s = 1.0\nlevel = ";
  EXPECT_EQ(reduced(reach + "2.0\n", {3.0, 1.0, 1.9, -2.0, 5.0}), 2.0);
  EXPECT_FALSE(reduced(reach + "0.0\n", {3.0, 1.0, 1.9, -2.0, 5.0}));
}

TEST(MetricRowsTest, WindowsFollowEvents) {
  History history(
      "[metric.after]\nof = \"a_m\"\nkind = \"sum\"\nfrom_s = \"hit\"\n"
      "before_s = \"hit + 2 * 0.25\"\n"
      "[metric.until]\nof = \"a_m\"\nkind = \"last\"\nto_s = \"hit - 0.5\"\nname = \"early\"\n"
      "where = \"hit is reached\"\n");
  double& a = history.signal("a_m");
  MetricValues& run = history.run();
  for (int k = 0; k <= 40; ++k) {
    a = k;
    if (k == 20) history.hit_s = 5.0;
    run.at_step(0.25 * k);
    run.at_sample(0.25 * k);
  }
  EXPECT_EQ(*history.metric("after_m"), 20.0 + 21.0);
  EXPECT_EQ(*history.metric("early_m"), 19.0);  // the event was not known before
}

TEST(MetricRowsTest, SignalsAreComputedBeforeTheMetrics) {
  const std::string rows =
      "[signal.speed_m_s]\nof = \"a_m\"\ntake = \"difference\"\nminus = \"b_m_s\"\ntext = \"it\"\n"
      "[signal.change_m_s2]\nof = \"speed_m_s\"\ntake = \"difference\"\n"
      "[signal.nothing_m]\nof = \"c_m\"\n"
      "[metric.most]\nof = \"change_m_s2\"\nkind = \"max\"\n";
  History history(rows);
  double& a = history.signal("a_m");
  history.signal("b_m_s") = 3.0;
  MetricValues& run = history.run();
  ASSERT_EQ(run.signals().size(), 2U);  // the run lacks c_m
  const Signal &speed = run.signals()[0], &change = run.signals()[1];
  EXPECT_EQ(speed.unit + ": " + speed.description, "m/s: it");
  for (int k = 0; k < 3; ++k) {
    a = k * k * 1e-4;
    run.at_sample(k * 1e-4);
    EXPECT_NEAR(speed.values[0], k == 0 ? -3.0 : 2 * k - 1 - 3.0, 1e-9);
    EXPECT_NEAR(change.values[0], k == 0 ? 0.0 : k == 1 ? 1e4 : 2e4, 1e-4);
  }
  EXPECT_NEAR(history.metric("most_m_s2").value(), 2e4, 1e-4);
  history.signal("speed_m_s");
  EXPECT_TRUE(has(complaint_of([&] { history.run(); }),
                  "signal.speed_m_s.of: the log has a signal of this name already"));
}

// Two lines with a jump of 3 between them, and something else in the gap.
TEST(MetricRowsTest, AJumpIsBetweenTwoLines) {
  History history(
      "[metric.jump]\nof = \"v_m_s\"\nkind = \"jump\"\nlevel = \"hit\"\nlower = 1.0\n"
      "[metric.late]\nof = \"v_m_s\"\nkind = \"jump\"\nlevel = \"hit + 3.0\"\nlower = 2.0\n");
  double& v = history.signal("v_m_s");
  MetricValues& run = history.run();
  for (int k = 0; k <= 100000; ++k) {
    const double t = k / 1e4, since_s = t - 5.0;
    if (k == 50000) history.hit_s = t;
    v = since_s < 0.0 ? 2.0 + 0.5 * since_s : since_s < 0.999 ? 99.0 : 5.0 - 0.25 * since_s;
    run.at_step(t);
    run.at_sample(t);
  }
  EXPECT_NEAR(history.metric("jump_m_s").value(), 3.0, 1e-9);
  EXPECT_FALSE(history.metric("late_m_s"));
}

TEST(MetricRowsTest, Refuses) {
  const std::string row = "[metric.m]\nof = \"a_m\"\nkind = \"rms\"\n";
  for (const auto& wrong : testing::rows_of("MetricRows")) {
    EXPECT_TRUE(
        has(complaint_of([&] { History(row + wrong.at(0), "task.band = 0.025\n"); }), wrong.at(1)))
        << wrong.at(0);
  }
}

}  // namespace breakwater::metric_rows_test
