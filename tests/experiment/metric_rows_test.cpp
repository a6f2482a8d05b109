#include <breakwater/experiment/metric_rows.h>

#include <deque>

#include "axes_catalogue.h"
#include "catalogue.h"
#include "tables.h"

namespace breakwater::metric_rows_test {

// Rows without a run: signals and events whose values the test sets.
class History {
 public:
  History(MetricRows its_rows, const Config& config, double step_s, double period_s,
          const MetricContext& context, double end_s)
      : rows_(std::move(its_rows)), end_s_(end_s) {
    rows_.learn(config);
    Fields fields;
    rows_.bind(fields);
    std::map<std::string, ConfigEntry> own;
    for (const auto& [key, entry] : config.entries()) {
      if (key.starts_with("metric") || key.starts_with("signal")) own.emplace(key, entry);
    }
    fields.read(Config("file", own));
    PhysicsSettings physics;
    physics.timestep_s = step_s;
    physics.control_period_s = period_s;
    rows_.check(
        config, [] { return Fields(); }, physics, context);
    for (const std::string& name : context.events) events_[name] = kInfinity;
  }

  // The values of a signal, to be set.
  std::vector<double>& signal(const std::string& name, std::size_t width = 1) {
    values_.emplace_back(width, 0.0);
    signals_.push_back({name, "", "", values_.back()});
    return values_.back();
  }
  double& event(const std::string& name) { return events_.at(name); }
  MetricValues& run() {
    MetricExpression::Events events;
    for (const auto& [name, time_s] : events_) events[name] = &time_s;
    run_ = MetricValues(rows_, signals_, end_s_, events);
    return run_;
  }
  std::optional<double> metric(const std::string& name) const {
    for (const Metric& metric : run_.metrics()) {
      if (metric.name == name) return metric.value;
    }
    return std::nullopt;
  }
  std::map<std::string, std::string> absent() const {
    std::map<std::string, std::string> reasons;
    for (const AbsentMetric& metric : run_.absent()) reasons[metric.name] = metric.reason;
    return reasons;
  }

 private:
  MetricRows rows_;
  double end_s_;
  std::deque<std::vector<double>> values_;
  std::vector<Signal> signals_;
  std::map<std::string, double> events_;
  MetricValues run_;
};

History of_scenario(const std::string& scenario, const std::vector<std::string>& sets,
                    double step_s, double period_s, const MetricContext& context, double end_s,
                    std::vector<MetricKind> kinds = {}) {
  const ScenarioFile file = testing::scenario_file(scenario);
  return {MetricRows(testing::catalogue(), scenario, std::move(kinds)),
          file.config(file.default_case(), sets),
          step_s,
          period_s,
          context,
          end_s};
}

// Steps of 10 ms, samples of 20 ms, the switch at 1 s. Contact from 1.50 to 1.60 s with 3 N (raw
// peak of 4 N at 1.55 s). Then contact from 1.80 to 1.85 s with 2 N, and from 2 s with 1 N.
constexpr double kStep = 0.01;

double force_at(int k) {
  if (k >= 150 && k < 160) return k == 155 ? 4.0 : 3.0;
  if (k >= 180 && k < 185) return 2.0;
  return k >= 200 ? 1.0 : 0.0;
}

History wall_history(int steps) {
  History history = of_scenario(
      "arm_wall_contact", {"force.reference_N=1.5", "metrics.from_s=2.5", "metrics.to_s=3.0"},
      kStep, 2 * kStep, {.known = {{"force_control", 1.0}}, .events = {"first_contact"}},
      0.01 * steps);
  double& force = history.signal("force_true_N")[0];
  double& filtered = history.signal("force_filtered_N")[0];
  double& speed = history.signal("tip_speed_x_m_s")[0];
  double& mass = history.signal("impact_mass_kg")[0];
  double& y = history.signal("y_offset_m")[0];
  double& phi = history.signal("phi_offset_rad")[0];
  double& saturated = history.signal("saturated")[0];
  history.signal("force_reference_N")[0] = 1.5;
  MetricValues& run = history.run();
  for (int k = 0; k < steps; ++k) {
    const double t = k / 100.0;
    const bool before = k < 100;  // larger values before the switch, which must not count
    filtered = before ? 99.0 : (k % 2 == 0 ? 1.0 : 1.2);
    force = before ? 99.0 : force_at(k);
    speed = 0.001 * k;
    if (k == 150) {
      history.event("first_contact") = t;
      mass = 75.0;
    }
    run.at_step(t);
    if (k % 2 != 0) continue;
    y = before ? 9.0 : k == 120 ? -0.03 : 0.02;
    phi = before ? 9.0 : k == 120 ? 0.05 : -0.04;
    saturated = k % 50 == 0 ? 1.0 : 0.0;
    run.at_sample(t);
  }
  return history;
}

TEST(MetricsOfTheWall, AreRightForAHistoryWithTwoBounces) {
  const History m = wall_history(400);
  EXPECT_NEAR(*m.metric("free_motion_time_s"), 0.5, 1e-12);
  EXPECT_EQ(*m.metric("peak_force_raw_N"), 4.0);
  EXPECT_EQ(*m.metric("peak_force_filtered_N"), 1.2);
  EXPECT_EQ(*m.metric("impact_velocity_m_s"), 0.150);
  EXPECT_EQ(*m.metric("impact_mass_kg"), 75.0);
  // 1.5 to 1.7 s: nine steps of 3 N and one of 4 N.
  EXPECT_NEAR(*m.metric("contact_impulse_Ns"), 0.31, 1e-12);
  // 25 errors of 0.5 N and 25 of 0.3 N.
  EXPECT_NEAR(*m.metric("mean_force_error_N"), 0.4, 1e-12);
  EXPECT_NEAR(*m.metric("std_force_error_N"), 0.1 * std::sqrt(50.0 / 49.0), 1e-12);
  // Only sample 250 of 250, 252, …, 298.
  EXPECT_NEAR(*m.metric("saturated_share"), 1.0 / 25.0, 1e-12);
  // Samples 100, 150, …, 350: six of 20 ms.
  EXPECT_NEAR(*m.metric("saturated_time_s"), 0.12, 1e-12);
  EXPECT_NEAR(*m.metric("max_y_error_m"), 0.03, 1e-12);
  EXPECT_NEAR(*m.metric("max_posture_error_rad"), 0.05, 1e-12);
  EXPECT_EQ(*m.metric("bounce_count"), 2.0);
}

TEST(MetricsOfTheWall, AreAbsentWhereTheyDoNotApply) {
  const History early = wall_history(100);
  EXPECT_FALSE(early.metric("saturated_time_s"));
  EXPECT_EQ(early.absent().at("free_motion_time_s"),
            "the run does not cover its window, from force_control to the run's end");
  const History untouched = wall_history(150);
  EXPECT_EQ(untouched.absent().at("peak_force_raw_N"), "the run does not reach first_contact");
  EXPECT_EQ(untouched.absent().at("free_motion_time_s"), "the value never rises above the level");
  EXPECT_FALSE(untouched.metric("bounce_count"));
  EXPECT_TRUE(untouched.metric("saturated_time_s"));
  const History brief = wall_history(160);
  EXPECT_TRUE(brief.metric("peak_force_raw_N"));
  EXPECT_EQ(brief.absent().at("contact_impulse_Ns"), "the run does not reach first_contact + 0.2");
  EXPECT_FALSE(wall_history(299).metric("mean_force_error_N"));
  EXPECT_TRUE(wall_history(300).metric("mean_force_error_N"));
}

// A hundred samples in the window. The force repeats every four samples and halves in the middle.
History late_history(const std::array<double, 4>& force_N) {
  History history = of_scenario(
      "arm_wall_contact", {"force.reference_N=1.5", "metrics.from_s=1.0", "metrics.to_s=2.0"},
      kStep, kStep, {.known = {{"force_control", 0.0}}, .events = {"first_contact"}}, 2.5);
  double& force = history.signal("force_true_N")[0];
  MetricValues& run = history.run();
  for (int k = 0; k < 250; ++k) {
    const bool in_window = k >= 100 && k < 200;
    const double now = force_N[static_cast<std::size_t>(k % 4)] * (k < 150 ? 2.0 : 1.0);
    force = now;
    if (now > 0.0) history.event("first_contact") = std::min(history.event("first_contact"), 0.0);
    run.at_step(k / 100.0);
    force = in_window ? now : 50.0 * (k % 2);
    run.at_sample(k / 100.0);
  }
  return history;
}

TEST(MetricsOfTheWall, AreRightForTheLateForce) {
  const History bounces = late_history({0.0, 0.0, 2.0, 3.0});
  EXPECT_EQ(*bounces.metric("late_bounce_count"), 25.0);
  EXPECT_EQ(*bounces.metric("force_frequency_Hz"), 25.0);
  EXPECT_NEAR(*bounces.metric("force_decay_ratio"), 0.5, 1e-12);
  const History swings = late_history({0.5, 0.5, 2.0, 3.0});
  EXPECT_EQ(*swings.metric("late_bounce_count"), 0.0);
  EXPECT_EQ(*swings.metric("force_frequency_Hz"), 25.0);
  const History rests = late_history({1.0, 1.0, 1.0, 1.0});
  EXPECT_EQ(*rests.metric("force_frequency_Hz"), 0.0);
  EXPECT_EQ(rests.absent().at("force_decay_ratio"),
            "the value is constant in the window's first fifth");
  EXPECT_FALSE(late_history({0.0, 0.0, 0.0, 0.0}).metric("late_bounce_count"));
}

// Two joints, samples of 0.1 s, gripped at 1 s, released at 2 s.
History push_history(int samples, double grip_s = 1.0, double release_s = 2.0,
                     const std::function<void(int, double*, double*)>& move = {}) {
  History history = of_scenario(
      "arm_push", {"push.start_s=" + std::to_string(grip_s), "metrics.settled_within_m=0.01"}, 0.1,
      0.1, {.known = {{"release", release_s}}}, 0.1 * samples, kinds_of_a_push());
  std::vector<double>& joints = history.signal("joint_offset_rad", 2);
  std::vector<double>& speeds = history.signal("dq_true_rad_s", 2);
  std::vector<double>& released = history.signal("released_joint_offset_rad", 2);
  double& turned = history.signal("push_turned_rad")[0];
  double& saturated = history.signal("saturated")[0];
  double& tip_error = history.signal("tip_error_m")[0];
  const std::array<std::string, 3> names = {"x_offset_m", "y_offset_m", "phi_offset_rad"};
  std::array<double*, 3> tip{}, released_tip{};
  for (std::size_t i = 0; i < 3; ++i) {
    tip[i] = history.signal(names[i]).data();
    released_tip[i] = history.signal("released_" + names[i]).data();
  }
  MetricValues& run = history.run();
  for (int k = 0; k < samples; ++k) {
    std::array<double, 3> at{};
    if (move) {
      move(k, joints.data(), &tip_error);
    } else {
      joints = {0.0, 0.0};
      speeds = {0.0, 0.0};
      if (k < 10) {
        at = {9, 9, 9};  // before the window
        speeds = {9, 9};
      } else if (k < 20) {
        joints = {1.0, -0.5};  // joint 1 is pushed up by 1 rad, joint 2 down by 0.5 rad
        speeds = {5, 5};
        at = {-0.3, -0.2, 1.0};
      } else if (k < 25) {
        joints = {-0.02, 0.03};  // beyond the start
        speeds = {-2, 1};
        at = {-0.01, 0.03, -0.25};  // y and φ are beyond their start
      } else {
        joints = {k < 28 ? 0.1 : 0.05, 0.0};  // joint 1 turns back
        at = {0.003, 0.004, 0.5};
      }
      tip_error = std::hypot(at[0], at[1]);
    }
    turned = k < 20 ? -0.1 * k : 0.0;
    saturated = k % 5 == 0 ? 1.0 : 0.0;
    for (std::size_t i = 0; i < 3; ++i) *tip[i] = at[i];
    if (k / 10.0 < release_s) {
      released = joints;
      for (std::size_t i = 0; i < 3; ++i) *released_tip[i] = at[i];
    }
    run.at_step(k / 10.0);
    run.at_sample(k / 10.0);
  }
  return history;
}

TEST(MetricsOfAPush, AreRightForAHistory) {
  const History m = push_history(31);
  EXPECT_NEAR(*m.metric("max_push_rad"), 1.9, 1e-12);
  EXPECT_NEAR(*m.metric("overshoot_rad"), 0.03, 1e-12);
  EXPECT_NEAR(*m.metric("x_overshoot_m"), 0.003, 1e-12);
  EXPECT_NEAR(*m.metric("y_overshoot_m"), 0.03, 1e-12);
  EXPECT_NEAR(*m.metric("posture_overshoot_rad"), 0.25, 1e-12);
  EXPECT_EQ(*m.metric("reversal_count"), 1.0);
  EXPECT_NEAR(*m.metric("settling_time_s"), 0.5, 1e-12);
  EXPECT_NEAR(*m.metric("saturated_time_s"), 0.5, 1e-12);  // 10, 15, …, 30
  EXPECT_NEAR(*m.metric("tip_error_m"), 0.005, 1e-12);
  EXPECT_EQ(*m.metric("peak_speed_rad_s"), 2.0);
}

// The tip returns but a joint does not. It never passes its start, so this is no success.
TEST(MetricsOfAPush, AnotherPostureCountsAsOvershoot) {
  const History m = push_history(20, 0.0, 1.0, [](int k, double* joints, double* tip_error) {
    joints[0] = 0.1 * k;
    *tip_error = k < 15 ? 9.0 : 0.0;
  });
  EXPECT_NEAR(*m.metric("overshoot_rad"), 1.9, 1e-12);
}

TEST(MetricsOfAPush, AreAbsentWhereTheyDoNotApply) {
  EXPECT_EQ(push_history(10).absent().size(), 10U);
  EXPECT_EQ(push_history(19).absent().size(), 9U);
  EXPECT_EQ(push_history(24).absent().at("settling_time_s"), "the magnitude ends beyond the level");
}

// ---- rows of a file ----------------------------------------------------------------------------

History history_of(const std::string& rows, const std::string& keys = "") {
  const testing::TemporaryPath path("rows.toml",
                                    "scenario = \"plant\"\n" + keys + rows + "\n[case.a]\n");
  return {MetricRows(), ScenarioFile(path, "plant").config("a"), 1e-4, 1e-4, {.events = {"hit"}},
          10.0};
}

// In the step response of ω² / (s² + 2 ζ ω s + ω²) the overshoot is exp(−π ζ/√(1 − ζ²)). The error
// last leaves ±5 % where its sampled magnitude does.
TEST(MetricRowsTest, SecondOrderResponse) {
  constexpr double kZeta = 0.3, kOmega = 5.0;
  const double damped = kOmega * std::sqrt(1.0 - kZeta * kZeta);
  History history = history_of(
      "[metric.s]\nof = \"error_m\"\nkind = \"settling\"\nlevel = \"2 * task.band\"\n"
      "[metric.o]\nof = \"error_m\"\nkind = \"overshoot\"\n",
      "task.band = 0.025\n");
  double& error = history.signal("error_m")[0];
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

TEST(MetricRowsTest, WindowsFollowEvents) {
  History history = history_of(
      "[metric.after]\nof = \"a_m\"\nkind = \"sum\"\nfrom_s = \"hit\"\n"
      "before_s = \"hit + 2 * 0.25\"\n"
      "[metric.until]\nof = \"a_m\"\nkind = \"last\"\nto_s = \"hit - 0.5\"\nname = \"early\"\n"
      "where = \"hit is reached\"\n");
  double& a = history.signal("a_m")[0];
  MetricValues& run = history.run();
  for (int k = 0; k <= 40; ++k) {
    a = k;
    if (k == 20) history.event("hit") = 5.0;
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
  History history = history_of(rows);
  double& a = history.signal("a_m")[0];
  history.signal("b_m_s")[0] = 3.0;
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
  History history = history_of(
      "[metric.jump]\nof = \"v_m_s\"\nkind = \"jump\"\nlevel = \"hit\"\nlower = 1.0\n"
      "[metric.late]\nof = \"v_m_s\"\nkind = \"jump\"\nlevel = \"hit + 3.0\"\nlower = 2.0\n");
  double& v = history.signal("v_m_s")[0];
  MetricValues& run = history.run();
  for (int k = 0; k <= 100000; ++k) {
    const double t = k / 1e4, since_s = t - 5.0;
    if (k == 50000) history.event("hit") = t;
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
    EXPECT_TRUE(has(complaint_of([&] { history_of(row + wrong.at(0), "task.band = 0.025\n"); }),
                    wrong.at(1)))
        << wrong.at(0);
  }
}

// ---- a scenario's own rows ---------------------------------------------------------------------

}  // namespace breakwater::metric_rows_test
