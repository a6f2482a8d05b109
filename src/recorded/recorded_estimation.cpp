#include <breakwater/recorded/recorded_estimation.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <ranges>
#include <span>

#include <breakwater/experiment/metric_reductions.h>
#include <breakwater/math/float_environment.h>
#include <breakwater/observers/record_intervals.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/table.h>
#include <breakwater/sim/state_hash.h>

namespace breakwater {
namespace {

constexpr double kExplained = 15.1;  // 99.99 % quantile of chi-square with one degree of freedom

// Compares innovations e with R = Δ²/12 + σ², the variance of the sensor's error, plus that of the
// error of the instant. An encoder that truncates has Δ²/3. Estimators' variances have no common
// unit.
//
// With a correct model and a small error of the estimator, e²/R is chi-square distributed. A value
// above 15.1, the 99.99 % quantile, is unexplained. It counts as 15.1 in the mean, so that a step
// of the disturbance does not dominate a record. Rounding alone gives no such value: the
// prediction and the code then differ by at most a count, so e² ≤ 12 R.
struct InnovationStatistics {
  double variance = 0.0;  // that of SensorError; 0: unknown
  double count = 0.0;
  double unexplained = 0.0;
  double squares = 0.0;
  double normalised = 0.0;  // the sum of e²/R
  double products = 0.0;    // the sum of e times the last e
  double last = 0.0;        // 0 after a restart

  // `instant_error` is the speed of the output times the standard deviation of the instant.
  void add(double innovation, double instant_error) {
    const double square = innovation * innovation, R = variance + instant_error * instant_error;
    count += 1.0;
    squares += square;
    if (R > 0.0) normalised += std::min(square / R, kExplained);
    if (square > kExplained * R) unexplained += 1.0;
    products += innovation * last;
    last = innovation;
  }
};

// The metrics of a record. A value that is not finite is not there.
std::vector<std::pair<MetricDefinition, std::optional<double>>> metrics_of(
    const AxisUnits& units, std::size_t rows, const RecordedTiming& timing,
    const SampleStatistics& d, const InnovationStatistics& e) {
  // Without innovations these are NaN.
  const double known = e.variance > 0.0 ? e.count : std::nan("");
  return {
      {{"sample_count", "1", "rows of the record"}, static_cast<double>(rows)},
      {{"period_s", "s", "csv.period_s, or the mean interval without gaps"}, timing.period_s},
      {{"jitter_rms_s", "s", "root mean square of interval minus period, without gaps"},
       timing.jitter_rms_s},
      {{"jitter_max_s", "s", "largest difference of interval and period, without gaps"},
       timing.jitter_max_s},
      {{"gap_count", "1", "intervals longer than csv.gap_periods"},
       static_cast<double>(timing.gaps.size())},
      {{"mean_disturbance_" + units.force_suffix, units.force,
        "mean of the estimated disturbance over all rows"},
       d.mean()},
      {{"std_disturbance_" + units.force_suffix, units.force,
        "standard deviation of the estimated disturbance over all rows"},
       d.standard_deviation()},
      {{"rms_innovation_" + units.position, units.position,
        "root mean square of the innovation e, the measured position minus the predicted one"},
       std::sqrt(e.squares / e.count)},
      {{"innovation_correlation_1", "1",
        "correlation of the innovation with that of the next row, about zero"},
       e.products / e.squares},
      {{"normalised_innovation_squared", "1",
        "mean of e^2/R with each term limited to 15.1, where R is the variance of the sensor's "
        "error"},
       e.normalised / known},
      {{"unexplained_share", "1", "share of rows with e^2/R above 15.1"}, e.unexplained / known}};
}

constexpr std::size_t kMostGapsNamed = 3;
constexpr std::size_t kRowsBetweenReports = 100000;

}  // namespace

std::optional<std::string> doubt_of(const std::vector<Metric>& metrics) {
  // A prediction with an error as large as that of the code doubles the mean from 1 to 2.
  // Transients of a correct estimator may be 7 % of the rows, which add 1 at 15.1 each.
  constexpr double kPrediction = 2.0;
  constexpr double kTransients = 1.0;
  constexpr double kCorrelated = 0.5;
  const auto count = metric_in(metrics, "sample_count");
  const auto square = metric_in(metrics, "normalised_innovation_squared");
  const auto beyond = metric_in(metrics, "unexplained_share");
  const auto correlation = metric_in(metrics, "innovation_correlation_1");
  if (!count || !square || !beyond || !correlation) return std::nullopt;
  // The number of independent squares for a geometric correlation; at least one in 200.
  const double memory = std::min(*correlation * *correlation, 0.99);
  const double n = *count * (1.0 - memory) / (1.0 + memory);
  const boost::math::chi_squared squares(n);
  const double largest = kPrediction * boost::math::quantile(squares, 0.999) / n + kTransients;
  if (*square <= largest) return std::nullopt;
  return fmt::format(
      "the model does not explain the data: the squared innovations are {:.3g} times the variance "
      "that encoder and noise explain (expected: at most {:.3g} times). {:.0f} % of them are above "
      "15.1 times. The correlation of successive innovations is {:.2f}. Check {}",
      *square, largest, 100.0 * *beyond, *correlation,
      *correlation > kCorrelated
          ? "inertia, friction, scales and signs, and whether the observer is fast enough for the "
            "disturbance"
          : "the times (csv.time_std_s), encoder.quantum, noise.std, scales and signs");
}

ScenarioKind recorded_estimation() {
  ScenarioKind kind = scenario_kind<RecordedEstimation>("estimate");
  kind.folder = data_file("data/estimate");
  return kind;
}

std::vector<MetricDefinition> RecordedEstimation::metric_definitions() const {
  std::vector<MetricDefinition> definitions;
  for (const AxisUnits& units : {rotation_units(), translation_units()}) {
    for (const auto& [definition, value] : metrics_of(units, 0, {}, {}, {})) {
      const bool is_there =
          std::ranges::count(definitions, definition.name, &MetricDefinition::name) > 0;
      if (!is_there) definitions.push_back(definition);
    }
  }
  return definitions;
}

Fields RecordedEstimation::fields() {
  Fields fields;
  fields.file("csv.file", file_, "table of times, inputs and positions (--csv FILE)");
  bind_record_format(fields, format_);
  fields.optional_number("csv.time_std_s", time_std_s_, not_negative(),
                         "standard deviation of the error of the times [s]");
  fields.number("csv.period_s", period_s_, not_negative(),
                "T_s; 0: the mean interval without gaps [s]");
  fields.number("csv.gap_periods", gap_periods_, between(1, 1e9),
                "longest normal interval: a longer one is a gap [T_s]");
  fields.optional_number("csv.longest_gap_s", longest_gap_s_, not_negative(),
                         "after a longer gap the estimator starts again [s]");
  fields.number("csv.jitter_share", jitter_share_, not_negative(),
                "deviation of an interval from T_s above which a warning is printed [T_s]");
  fields.choice("plant.motion", motion_,
                {{"rotation", Motion::rotation}, {"translation", Motion::translation}},
                "kind of motion: rotation (rad, N m) or translation (m, N)");
  fields.number("plant.inertia", inertia_, positive(),
                "moving inertia [kg m^2] or mass [kg] (--set plant.inertia=VALUE)");
  fields.number("plant.viscous_friction", viscous_friction_, not_negative(),
                "viscous friction [N m s/rad] or [N s/m]");
  fields.number(
      "encoder.quantum", quantum_, not_negative(),
      "encoder resolution, one count; 0: not quantised [rad or m] (--set encoder.quantum=VALUE)");
  fields.number("encoder.pulses_per_revolution", pulses_, not_negative(),
                "b_reso of Eq. 4.26, or counts per metre; 0: from encoder.quantum");
  bind_encoder_rounding(fields, rounding_);
  fields.only_with({"encoder.rounding"}, "encoder.quantum");
  fields.number("noise.std", noise_std_, not_negative(),
                "standard deviation of the white noise of y [rad or m]");
  estimator_.bind(fields);
  fields.count("record.compression", run_.compression, between(0, 9),
               "compression of log.h5 by deflate: 0 is fastest, 9 gives the smallest file");
  return fields;
}

NominalAxis RecordedEstimation::axis() const {
  const double turn = motion_ == Motion::rotation ? 2.0 * std::numbers::pi : 1.0;
  const double counts = quantum_ == 0.0 ? 0.0 : turn / quantum_;  // Eq. 4.23
  return {.plant = damped_inertia(inertia_, viscous_friction_),
          .period_s = timing_.period_s,
          .force_limit = largest_input_,
          .sensor = {Eigen::VectorXd::Constant(1, quantum_),
                     Eigen::VectorXd::Constant(1, noise_std_), rounding_},
          .pulses_per_revolution = pulses_ == 0.0 ? counts : pulses_,
          .units = motion_ == Motion::rotation ? rotation_units() : translation_units()};
}

void RecordedEstimation::check(const Config& config, const Fields& /*fields*/) {
  check_record_format(config);
  record_ = read_recorded_axis(file_, format_);
  timing_ = timing_of(record_.times_s, period_s_, gap_periods_, jitter_share_);
  const auto [least, most] = std::minmax_element(record_.inputs.begin(), record_.inputs.end());
  largest_input_ = std::max(std::abs(*least), std::abs(*most));
  follows_ = estimator_.check(config, axis())->follow({});
}

std::vector<std::string> RecordedEstimation::warnings() const {
  std::vector<std::string> lines = record_.warnings(file_);
  const std::vector<double>& t = record_.times_s;
  if (!timing_.gaps.empty()) {
    std::vector<std::string> places;
    for (const std::size_t k : timing_.gaps | std::views::take(kMostGapsNamed)) {
      places.push_back(fmt::format("{:.6g} s for {:.6g} s", t[k - 1], t[k] - t[k - 1]));
    }
    if (timing_.gaps.size() > kMostGapsNamed) places.emplace_back("...");
    const std::string what_is_done =
        follows_ ? fmt::format(
                       "the estimator predicts over a gap, with the inputs of the rows beside it. "
                       "After more than {:.3g} s it starts again",
                       longest_gap_s_)
                 : "the estimator starts again after each gap";
    lines.push_back(fmt::format("{}: {} after {}: {}", file_, number_of(timing_.gaps.size(), "gap"),
                                fmt::join(places, ", "), what_is_done));
  }
  if (timing_.irregular > 0 && !follows_) {
    lines.push_back(
        fmt::format("{}: {} of {} intervals differ from T_s = {:.6g} s by more than {:.3g} T_s, by "
                    "at most {:.3g} s. "
                    "The estimator takes each for one period",
                    file_, timing_.irregular, t.size() - 1, timing_.period_s, jitter_share_,
                    timing_.jitter_max_s));
  }
  return lines;
}

Recording RecordedEstimation::run(const RunControl& control) const {
  const math::FloatEnvironment floats;
  const NominalAxis axis = this->axis();
  const AxisUnits& units = axis.units;
  const auto estimator = estimator_.make(axis);
  double position = 0.0;
  double input = 0.0;
  double raw_velocity = 0.0;
  double stretch = 0.0;
  const std::vector<Signal> estimates = estimate_signals(*estimator, units);
  std::vector<Signal> signals = {
      {"position_measured_" + units.position, units.position, "y of the record", view(position)},
      {"applied_" + units.force_suffix, units.force, "u of the record", view(input)},
      estimates[0],
      estimates[1],
      {"velocity_raw_" + units.velocity_suffix, units.velocity,
       "raw difference of y over an interval; 0 at the first row of a stretch", view(raw_velocity)},
      estimates[2],
      {"stretch", "1",
       "number of the part of the record since the last restart of the estimator, from 1",
       view(stretch)}};
  for (const Signal& signal : signals_of(*estimator, units.position)) signals.push_back(signal);
  const std::span<const double> innovation = published(*estimator, "innovation");

  const std::size_t rows = record_.times_s.size();
  Track log("control", std::move(signals), rows);
  StateHash hash;
  SampleStatistics d;
  const double sensor_std = std::sqrt(axis.sensor.variance()(0));
  InnovationStatistics innovations{sensor_std * sensor_std};
  RecordIntervals intervals({.times_s = record_.times_s,
                             .inputs = record_.inputs,
                             .inputs_act_before = format_.input_acts == InputActs::before,
                             .period_s = timing_.period_s,
                             .gap_periods = gap_periods_,
                             .instant_std_s = time_std_s_,
                             .output_std = sensor_std});
  const bool is_followed = follows_ && !intervals.is_regular();
  Eigen::VectorXd y(1);
  Eigen::VectorXd start = Eigen::VectorXd::Zero(2);
  for (std::size_t k = 0; k < rows; ++k) {
    if (k % kRowsBetweenReports == 0) {
      if (control.stop != nullptr && *control.stop) throw Interrupted();
      if (control.progress) control.progress(static_cast<double>(k) / static_cast<double>(rows));
    }
    const double time_s = record_.times_s[k];
    const double interval_s = k == 0 ? 0.0 : time_s - record_.times_s[k - 1];
    const bool is_gap = interval_s > gap_periods_ * timing_.period_s;
    const bool starts = k == 0 || (is_gap && (!follows_ || interval_s > longest_gap_s_));
    y(0) = record_.positions[k];
    if (k > 0) intervals.move_to(k);
    // The log views it. NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores)
    raw_velocity = starts ? 0.0 : (y(0) - position) / interval_s;
    if (starts) {
      stretch += 1.0;
      innovations.last = 0.0;
      start(0) = y(0);
      estimator->reset(start);
    } else if (is_followed) {
      estimator->follow(intervals.interval());
    }
    position = y(0);
    input = record_.inputs[k];
    estimator->update(intervals.held_input(), y);
    log.append(time_s);
    const double values[] = {estimator->state()(0), estimator->state()(1),
                             estimator->disturbance()(0)};
    hash.update(values);
    d.add(values[2]);
    if (!innovation.empty() && !starts) {
      innovations.add(innovation.front(), values[1] * time_std_s_);
    }
  }

  Recording recording;
  recording.state_hash = hash.digest();
  recording.simulated_s = record_.times_s.back() - record_.times_s.front();
  recording.tracks.push_back(std::move(log));
  for (const auto& [definition, value] : metrics_of(units, rows, timing_, d, innovations)) {
    add(recording.metrics, definition.name, definition.unit, value);
  }
  return recording;
}

void bind_record_format(Fields& fields, RecordFormat& format) {
  fields.optional_text("csv.time_column", format.time_column, "name of the column of times");
  fields.optional_text("csv.input_column", format.input_column, "name of the column of inputs u");
  fields.optional_text("csv.position_column", format.position_column,
                       "name of the column of positions y");
  fields.optional_number("csv.time_scale", format.time_scale, positive(),
                         "unit of the column of times in s: 1e-3 for milliseconds");
  fields.optional_number("csv.input_scale", format.input_scale, any(),
                         "unit of the column u in N m or N, with sign: a torque constant, for "
                         "example");
  fields.optional_number("csv.position_scale", format.position_scale, any(),
                         "unit of the column y in rad or m, with sign");
  fields.optional_choice("csv.input_acts", format.input_acts,
                         {{"after", InputActs::after}, {"before", InputActs::before}},
                         "interval in which u of a row acts: after the row, or before it");
}

void check_record_format(const Config& config) {
  for (const char* key : {"csv.input_scale", "csv.position_scale"}) {
    if (config.number(key) == 0.0) config.fail(key, "must not be 0");
  }
}

}  // namespace breakwater
