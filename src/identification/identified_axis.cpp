#include <breakwater/identification/identified_axis.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <ranges>
#include <stdexcept>

#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/axis_model.h>
#include <breakwater/identification/axis_start.h>
#include <breakwater/observers/code_sensor.h>
#include <breakwater/observers/sensor_error.h>
#include <breakwater/shell/table.h>
#include <breakwater/world/noise.h>

namespace breakwater {
namespace {

constexpr double kGapPeriods = 1.5;      // a longer interval lacks rows
constexpr std::size_t kMostStarts = 10;  // gaps of a record, each of which begins a stretch
constexpr double kLongestGap = 20.0;     // in periods: after a longer one a stretch begins
constexpr std::size_t kLeastRows = 60;   // in a stretch
constexpr double kLeastCounts = 10.0;    // the least motion
constexpr double kLargestDelay = 0.02;   // s, or 20 periods if that is more
constexpr double kLargestLead = 0.005;   // s, of the clock of u, or 5 periods
constexpr double kSettlePeriods = 20.0;  // the inputs before the first row act in them
constexpr int kTrialIterations = 15;
constexpr std::size_t kFinalists = 2;
constexpr std::size_t kLags = 20;
constexpr int kMostRestarts = 4;
constexpr int kRestarts = 12;        // random ones, if the residuals are not white
constexpr double kAround = 0.15;     // their distance, relative
constexpr double kBetter = 0.5;      // rise of 2 ln L by which another fit counts as better
constexpr double kWhite99 = 37.566;  // 99 % quantile of chi-square with kLags degrees of freedom
constexpr double kTied = 0.95;       // correlation of parameters that a record does not separate
constexpr double kLeastPlay = 0.05;  // first guess of an interval of a backlash, in RMS twists
constexpr double kFound = 0.1, kBest = 0.4, kBounded = 0.9;  // usual shares of the work
constexpr double kClear = 0.5;  // rise of −2 ln L, in that of an interval, that shows its end

double rms_error(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  double squares = 0.0;
  std::size_t k = 0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double y : stretch.positions) squares += std::pow(y - positions[k++], 2.0);
  }
  return std::sqrt(squares / static_cast<double>(k));
}

// The best of the candidates after a few iterations each, then to the end. `starts` may be given,
// too.
AxisFit best_fit(const AxisData& data, const FreeParameters& free,
                 const std::vector<AxisValues>& candidates,
                 const std::vector<AxisStart>& starts = {}) {
  using Trial = std::pair<double, AxisFit>;  // the RMS error first
  std::vector<Trial> trials;
  const double least = std::max(data.quantum, 1e-9 * range_of(data));
  for (const AxisValues& values : candidates) {
    AxisFit fit{.values = values, .starts = starts, .noise_std = least};
    fit = fit_starts(data, fit);
    fit.noise_std = std::max(least, 0.1 * rms_error(data, fit));
    fit = fit_axis(data, free, fit, kTrialIterations);
    const double rms = rms_error(data, fit);
    if (std::isfinite(rms)) trials.emplace_back(rms, fit);
  }
  std::ranges::sort(trials, {}, &Trial::first);
  AxisFit best;
  for (const Trial& trial : trials | std::views::take(kFinalists)) {
    const AxisFit fit = fit_axis_and_noise(data, free, trial.second);
    if (fit.deviance < best.deviance) best = fit;
  }
  return best;
}

// The best fit with a backlash, from several sizes of it. A play makes the spring look softer.
AxisFit fit_with_backlash(const AxisData& data, FreeParameters free, const AxisFit& without) {
  free[kBacklash] = true;
  std::vector<AxisValues> candidates;
  for (const double share : {0.1, 0.5, 2.0}) {
    AxisValues values = without.values;
    values[kBacklash] = share * rms_twist(data, without);
    candidates.push_back(values);
    values[kStiffness] *= 1.0 + share;
    candidates.push_back(values);
  }
  return best_fit(data, free, candidates, without.starts);
}

// The best of the searches that begin five standard deviations beside a fit. Flanks and stiction
// make several minima.
AxisFit best_beside(const AxisData& data, const FreeParameters& free, const AxisFit& fit) {
  constexpr double kBeside = 5.0;
  const Eigen::MatrixXd covariance = covariance_of(data, free, fit);
  AxisFit best = fit;
  Eigen::Index i = 0;
  for (const AxisParameter p : listed(free)) {
    const double std = std::sqrt(covariance(i, i));
    const Eigen::VectorXd change = kBeside / std * covariance.col(i++);
    if (!(std <= known_parameter(p).largest_std)) continue;
    for (const double sign : {-1.0, 1.0}) {
      const AxisFit one =
          fit_axis(data, free, moved_fit(data, free, fit, sign * change), kTrialIterations);
      if (one.deviance < best.deviance - kBetter) best = one;
    }
  }
  return best;
}

// The best of the searches that begin at random points around a fit.
AxisFit best_around(const AxisData& data, const FreeParameters& free, const AxisFit& fit) {
  const Noise random(1, "restarts");
  const AxisValues scales = parameter_scales(data);
  std::uint64_t drawn = 0;
  std::vector<double> sizes;
  for (const AxisParameter p : listed(free)) {
    const bool is_scaled = is_logarithmic(p) || p == kDelay;
    sizes.push_back(is_scaled ? 1.0 : std::abs(fit.values[p]) / scales[p]);
  }
  AxisFit best = fit;
  for (int n = 0; n < kRestarts; ++n) {
    Eigen::VectorXd changes(static_cast<Eigen::Index>(sizes.size()));
    std::transform(sizes.begin(), sizes.end(), changes.begin(),
                   [&](double size) { return kAround * size * random(drawn++); });
    const AxisFit start = moved_fit(data, free, fit, changes);
    const AxisFit one = fit_axis(data, free, fit_starts(data, start), kTrialIterations);
    if (one.deviance < best.deviance - kBetter) best = one;
  }
  return best;
}

// `tied` are the parameters that a record does not separate from this one.
void explain(ParameterEstimate& estimate, const std::vector<std::string>& tied) {
  estimate.reason =
      tied.empty() ? "its interval is too wide for the size of the input"
                   : fmt::format("the records do not separate it from: {}", fmt::join(tied, ", "));
  estimate.excitation = known_parameter(estimate.parameter).excitation;
}

// The scores of the likelihood by the position, in standard deviations: white if the model is true.
std::vector<std::vector<double>> scores_of(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  std::vector<std::vector<double>> scores;
  std::size_t k = 0;
  const double truncated = data.rounding == EncoderRounding::truncate ? 0.5 * data.quantum : 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    std::vector<double>& one = scores.emplace_back();
    for (const double y : stretch.positions) {
      const double noise = stretch.noise_at(one.size(), fit.noise_std);
      const double off = (positions[k++] - y - std::copysign(truncated, y)) / noise;
      const double half = 0.5 * data.quantum / noise;
      one.push_back(data.quantum == 0.0 ? -off
                                        : CodeInterval(-half - off, half - off).moments().mean);
    }
  }
  return scores;
}

Whiteness whiteness_of(const AxisData& data, const AxisFit& fit) {
  const std::vector<std::vector<double>> scores = scores_of(data, fit);
  Whiteness whiteness;
  whiteness.limit = kWhite99;
  double rows = 0.0, squares = 0.0;
  for (const auto& one : scores) {
    rows += static_cast<double>(one.size());
    for (const double s : one) squares += s * s;
  }
  if (squares == 0.0) return whiteness;
  for (std::size_t lag = 1; lag <= kLags; ++lag) {
    double products = 0.0;
    for (const auto& one : scores) {
      for (std::size_t k = lag; k < one.size(); ++k) products += one[k] * one[k - lag];
    }
    const double r = products / squares;
    whiteness.statistic += rows * (rows + 2.0) * r * r / (rows - static_cast<double>(lag));
  }
  return whiteness;
}

// The variance of the noise before the encoder, with that of rounded times.
double noise_variance(const AxisData& data, const AxisFit& fit) {
  double squares = 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double noise : stretch.time_noise) squares += noise * noise;
  }
  return fit.noise_std * fit.noise_std + squares / static_cast<double>(data.rows());
}

// The variance of the measured positions about the quadratics through their three predecessors.
// Unlike the residuals it does not depend on the fit.
double variance_of_differences(const AxisData& data) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const AxisStretch& stretch : data.stretches) {
    for (std::size_t k = 3; k < stretch.positions.size(); ++k, ++count) {
      double difference = 0.0;
      double weights = 0.0;
      for (std::size_t i = k - 3; i <= k; ++i) {
        double weight = 1.0;
        for (std::size_t j = k - 3; j <= k; ++j) {
          if (j != i) weight /= stretch.times_s[i] - stretch.times_s[j];
        }
        difference += weight * stretch.positions[i];
        weights += weight * weight;
      }
      squares += difference * difference / weights;
    }
  }
  return count > 0 ? squares / static_cast<double>(count) : std::numeric_limits<double>::infinity();
}

// The variance of the errors that noise and encoder explain. The fitted noise explains all errors
// of a bad fit, so it counts only as far as the record itself is noisy.
double error_variance(const AxisData& data, const AxisFit& fit) {
  const SensorError encoder{Eigen::VectorXd::Constant(1, data.quantum), Eigen::VectorXd::Zero(1),
                            data.rounding};
  const double rounding = encoder.variance()(0);
  return std::min(noise_variance(data, fit) + rounding,
                  std::max(variance_of_differences(data), rounding));
}

FitErrors held_out_errors(const AxisData& held, const Identification& found) {
  const AxisFit& fit = found.fit;
  const AxisValues scales = parameter_scales(found.data);
  AxisFit model = fit;
  model.starts.clear();
  model = fit_starts(held, model);
  FitErrors errors{rms_error(held, model), 0.0};
  // The parameters' uncertainty adds to the variance: the mean square of each scaled direction.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(found.covariance);
  const std::vector<double> positions = fitted_positions(held, model);
  double variance = error_variance(held, fit);
  for (Eigen::Index n = 0; n < found.covariance.rows(); ++n) {
    AxisFit moved = model;
    const double std = std::sqrt(std::max(0.0, directions.eigenvalues()(n)));
    // A direction that the records did not show must not hide an error.
    const double size = std::min(std, 0.5);
    Eigen::Index i = 0;
    for (const AxisParameter p : listed(found.free)) {
      const double change = size * directions.eigenvectors()(i++, n);
      moved.values[p] = is_logarithmic(p) ? moved_parameter(held, p, moved.values[p], change)
                                          : moved.values[p] + change * scales[p];
    }
    moved = fit_starts(held, moved);
    const std::vector<double> other = fitted_positions(held, moved);
    double squares = 0.0;
    for (std::size_t k = 0; k < other.size(); ++k)
      squares += std::pow(other[k] - positions[k], 2.0);
    variance += squares / static_cast<double>(other.size());
  }
  errors.normalised = errors.rms / std::sqrt(variance);
  return errors;
}

// The upper end of a backlash that the fit does without. `better` becomes a fit with a backlash
// that the records demand, if the profile meets one.
ParameterEstimate no_backlash(const AxisData& data, const FreeParameters& free, const AxisFit& fit,
                              bool shows_spring, std::optional<AxisFit>& better) {
  const double guess = kLeastPlay * rms_twist(data, fit) / parameter_scales(data)[kBacklash];
  const auto count = std::count(free.begin(), free.end(), true);
  ParameterInterval interval =
      profile_interval(data, free, fit, kBacklash, guess, Eigen::VectorXd::Zero(count));
  if (interval.better.deviance < fit.deviance - kChiSquare95) better = interval.better;
  ParameterEstimate estimate{.parameter = kBacklash, .high = interval.high};
  estimate.is_identifiable = shows_spring && interval.highest.second > kClear * kChiSquare95;
  if (!estimate.is_identifiable) explain(estimate, {});
  return estimate;
}

// Values, intervals and identifiability of the fit. Returns a better fit instead, if a profile
// meets one. `done` gets the share of the parameters.
std::optional<AxisFit> add_parameters(Identification& result, bool is_last,
                                      const std::function<void(double)>& done) {
  const AxisData& data = result.data;
  const AxisFit& fit = result.fit;
  const FreeParameters& free = result.free;
  result.parameters.clear();
  result.notes.clear();
  result.covariance = covariance_of(data, free, fit);
  // A prior must not make a parameter look known.
  const Eigen::MatrixXd shown = covariance_of(data, free, fit, kHardlyAnyPrior);
  const std::vector<AxisParameter> order = listed(free);
  // The likelihood of codes has hardly any curvature without noise.
  result.is_bootstrapped =
      data.quantum > 0.0 && std::sqrt(noise_variance(data, fit)) < 1.5 * kLeastNoise * data.quantum;
  const std::vector<double> boots =
      result.is_bootstrapped ? bootstrap_std(data, free, fit) : std::vector<double>();
  // Damping and backlash mean nothing beside an unknown stiffness.
  const auto spring = std::find(order.begin(), order.end(), kStiffness);
  const Eigen::Index row = spring - order.begin();
  const bool shows_spring = spring == order.end() ||
                            std::sqrt(shown(row, row)) <= known_parameter(kStiffness).largest_std;
  for (std::size_t n = 0; n < order.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    ParameterEstimate estimate{.parameter = order[n], .value = fit.values[order[n]]};
    const double std = std::sqrt(result.covariance(i, i)), shown_std = std::sqrt(shown(i, i));
    const bool is_of_spring = order[n] == kDamping || order[n] == kBacklash;
    estimate.is_identifiable =
        shown_std <= known_parameter(order[n]).largest_std && (shows_spring || !is_of_spring);
    std::optional<double> interval_std;  // nothing: the profile has the interval
    if (!estimate.is_identifiable) {
      // The far end of the set that fits is not seen from the fit.
      interval_std = is_logarithmic(order[n]) ? std::max(std, kPriorStd) : std;
    } else if (result.is_bootstrapped) {
      interval_std = boots[n];
    } else {
      const ParameterInterval interval = profile_interval(
          data, free, fit, order[n], std, result.covariance.col(i) / result.covariance(i, i));
      if (interval.better.deviance < fit.deviance - kBetter) {
        if (!is_last) return interval.better;
        result.is_converged = false;
      }
      if (!interval.is_closed) {
        result.notes.push_back(
            fmt::format("the interval of {} may be too narrow: the search for its ends did not "
                        "converge",
                        parameter_key(order[n])));
      }
      estimate.low = interval.low;
      estimate.high = interval.high;
      estimate.is_identifiable = interval.is_known;
      if (!interval.is_known) interval_std = kPriorStd;
    }
    if (interval_std) {
      const double reach = kRoot95 * *interval_std;
      estimate.low = moved_parameter(data, order[n], estimate.value, -reach);
      estimate.high = moved_parameter(data, order[n], estimate.value, reach);
    }
    if (!estimate.is_identifiable) {
      std::vector<std::string> tied;
      for (std::size_t m = 0; m < order.size(); ++m) {
        const auto j = static_cast<Eigen::Index>(m);
        if (m != n && std::abs(shown(i, j)) > kTied * shown_std * std::sqrt(shown(j, j))) {
          tied.emplace_back(known_parameter(order[m]).name);
        }
      }
      explain(estimate, tied);
    }
    result.parameters.push_back(std::move(estimate));
    done(static_cast<double>(n + 1) / static_cast<double>(order.size()));
  }
  if (data.model->has_backlash && !free[kBacklash]) {
    std::optional<AxisFit> better;
    result.parameters.push_back(no_backlash(data, free, fit, shows_spring, better));
    if (better && !is_last) return better;
    if (better) result.is_converged = false;
  }
  return std::nullopt;
}

constexpr double kPeriod = 5e-3;  // s, of the rows that the search uses
constexpr double kLargest = 2.0;  // s
constexpr double kLeast = 0.01;   // s: a fitted delay covers a smaller one
constexpr std::ptrdiff_t kLeastVotes = 3;

// The time by which the input acts later than its rows say; 0 if no offset is clear.
double clock_offset(const RecordedAxis& record, const IdentificationSettings& settings) {
  AxisData data = axis_data({record}, settings.inputs_act_before, 0.0);
  if (data.stretches.empty()) return 0.0;
  const auto every = static_cast<std::size_t>(std::max(1.0, std::round(kPeriod / data.period_s)));
  data.quantum = settings.quantum ? *settings.quantum : encoder_quantum(record.positions);
  data.period_s *= static_cast<double>(every);
  for (AxisStretch& stretch : data.stretches) {
    std::vector<double> times_s, positions;
    for (std::size_t k = 0; k < stretch.times_s.size(); k += every) {
      times_s.push_back(stretch.times_s[k]);
      positions.push_back(stretch.positions[k]);
    }
    stretch.times_s = std::move(times_s);
    stretch.positions = std::move(positions);
  }
  data.largest_delay_s =
      std::min(kLargest, 0.25 * (record.times_s.back() - record.times_s.front()));
  data.least_delay_s = -data.largest_delay_s;
  const std::vector<AxisValues> candidates = start_candidates(data);
  const auto votes = [&](const AxisValues& one) {
    return std::ranges::count_if(candidates, [&](const AxisValues& other) {
      return std::abs(other[kDelay] - one[kDelay]) <= data.period_s;
    });
  };
  const auto best = std::ranges::max_element(candidates, {}, votes);
  return best != candidates.end() && votes(*best) >= kLeastVotes ? (*best)[kDelay] : 0.0;
}

// Moves the inputs of each record by its offset. Returns the offsets.
std::vector<double> corrected(std::vector<RecordedAxis>& records,
                              const IdentificationSettings& settings) {
  std::vector<double> offsets;
  for (RecordedAxis& record : records) {
    const double found = clock_offset(record, settings);
    offsets.push_back(std::abs(found) < kLeast ? 0.0 : found);
    if (record.input_times_s.empty()) {
      record.input_times_s = record.times_s;
      record.all_inputs = record.inputs;
    }
    for (double& t : record.input_times_s) t += offsets.back();
  }
  return offsets;
}

}  // namespace

AxisData axis_data(const std::vector<RecordedAxis>& records, bool inputs_act_before,
                   double settle_s) {
  AxisData data;
  for (const RecordedAxis& record : records) {
    const bool has_all = !record.input_times_s.empty();
    const std::vector<double>& t = has_all ? record.input_times_s : record.times_s;
    const std::vector<double>& u = has_all ? record.all_inputs : record.inputs;
    const RecordedTiming timing = timing_of(t, 0.0, kGapPeriods, 0.1);
    data.period_s =
        std::max(data.period_s, timing_of(record.times_s, 0.0, kGapPeriods, 0.1).period_s);
    const double time_step_s = rounding_step(record.times_s);
    // A start after each gap forgets the unknown inputs. Many gaps are bridged instead.
    const double longest_s =
        (timing.gaps.size() > kMostStarts ? kLongestGap : kGapPeriods) * timing.period_s;
    const std::size_t rows = t.size();
    // The input that acts from row k on.
    const auto input = [&](std::size_t k) {
      return u[inputs_act_before ? std::min(k + 1, rows - 1) : k];
    };
    std::size_t row = 0;
    for (std::size_t from = 0; from < rows;) {
      AxisStretch stretch{.time_step_s = time_step_s};
      std::size_t k = from;
      for (;; ++k) {
        stretch.input_times_s.push_back(t[k] - t[from]);
        stretch.inputs.push_back(input(k));
        if (k + 1 == rows || t[k + 1] - t[k] > longest_s) break;
        // Inputs of missing rows lie on a line.
        const double missing = std::round((t[k + 1] - t[k]) / timing.period_s);
        for (int i = 1; i < missing; ++i) {
          stretch.input_times_s.push_back(t[k] - t[from] + i * (t[k + 1] - t[k]) / missing);
          stretch.inputs.push_back(std::lerp(input(k), input(k + 1), i / missing));
        }
      }
      for (; row < record.times_s.size() && record.times_s[row] <= t[k]; ++row) {
        const double now = record.times_s[row] - t[from];
        if (now < settle_s) continue;
        stretch.times_s.push_back(now);
        stretch.positions.push_back(record.positions[row]);
      }
      if (stretch.times_s.size() >= kLeastRows) data.stretches.push_back(std::move(stretch));
      from = k + 1;
    }
  }
  return data;
}

Identification identify_axis(const std::vector<RecordedAxis>& records,
                             const std::vector<RecordedAxis>& held_out,
                             const IdentificationSettings& settings) {
  const auto done = [&](double share) {
    if (settings.progress) settings.progress(share);
  };
  Identification result;
  const AxisData all = axis_data(records, settings.inputs_act_before, 0.0);
  if (all.stretches.empty()) {
    throw std::invalid_argument(
        fmt::format("the records have no stretch of {} rows without a long gap", kLeastRows));
  }
  // The inputs before the first row are unknown. Where a delay is longer, the start takes up most
  // of their effect.
  const double settle_s = kSettlePeriods * all.period_s;
  AxisData& data = result.data;
  data = axis_data(records, settings.inputs_act_before, settle_s);
  if (data.stretches.empty()) data = all;
  data.model = settings.model;
  data.least_delay_s = -std::max(kLargestLead, 5.0 * all.period_s);
  data.largest_delay_s = std::max(kLargestDelay, 20.0 * all.period_s);
  if (settings.quantum) {
    data.quantum = *settings.quantum;
  } else {
    for (const AxisStretch& stretch : data.stretches) {
      const double quantum = encoder_quantum(stretch.positions);
      if (quantum > 0.0 && (data.quantum == 0.0 || quantum < data.quantum)) data.quantum = quantum;
    }
    result.is_quantum_found = true;
  }
  data.rounding = settings.rounding;
  const double range = range_of(data);
  if (range == 0.0 || range < kLeastCounts * data.quantum) {
    throw std::invalid_argument(fmt::format(
        "the position moves by {:.3g} alone, and the encoder's count is {:.3g}: a larger input is "
        "needed",
        range, data.quantum));
  }
  const AxisValues scales = parameter_scales(data);
  if (!(scales[kOffset] > 0.0)) throw std::invalid_argument("the input is always 0");

  FreeParameters& free = result.free;
  for (const AxisParameter p : settings.model->parameters) free[p] = true;
  std::vector<AxisValues> candidates = settings.model->candidates(data);
  if (candidates.empty()) {
    throw std::invalid_argument(
        "no start of the fit was found: the input does not explain the motion. Check the signs of "
        "u and y, and their columns");
  }
  if (settings.known_inertia) {
    free[settings.model->known_inertia] = false;
    free[kTorqueConstant] = true;
    for (AxisValues& values : candidates) {
      const double factor = *settings.known_inertia / values[settings.model->known_inertia];
      for (std::size_t p = 0; p < kAxisParameters; ++p) {
        if (known_parameter(static_cast<AxisParameter>(p)).is_torque) values[p] *= factor;
      }
    }
  }
  done(0.0);
  result.fit = best_fit(data, free, candidates);
  done(kFound);
  if (std::isfinite(result.fit.deviance) && allow_rounded_times(data, result.fit)) {
    result.fit = fit_axis_and_noise(data, free, result.fit);
  }
  if (settings.has_stribeck) {
    // The friction of standstill falls to that of motion: several speeds are tried.
    free[kBreakaway] = free[kStribeckSpeed] = true;
    const double speed = scales[kOffset] / scales[kViscous];
    std::vector<AxisValues> with_bump;
    for (const double share : {0.03, 0.1, 0.3}) {
      AxisValues values = result.fit.values;
      values[kBreakaway] = std::max(0.3 * values[kCoulomb], 0.02 * scales[kBreakaway]);
      values[kStribeckSpeed] = share * speed;
      with_bump.push_back(values);
    }
    result.fit = best_fit(data, free, with_bump);
  }
  const AxisFit& fit = result.fit;
  if (settings.model->has_backlash && std::isfinite(fit.deviance)) {
    AxisFit with = fit_with_backlash(data, free, fit);
    done(0.5 * (kFound + kBest));
    if (with.deviance < fit.deviance - kChiSquare95) {
      free[kBacklash] = true;
      result.fit = std::move(with);
    }
    const AxisFit beside = best_beside(data, free, fit);
    if (beside.deviance < fit.deviance) result.fit = fit_axis_and_noise(data, free, beside);
    // A wrong minimum leaves errors that are not white.
    for (int turn = 0; turn < kMostRestarts && !whiteness_of(data, fit).is_white(); ++turn) {
      const AxisFit around = best_around(data, free, fit);
      if (!(around.deviance < fit.deviance)) break;
      result.fit = fit_axis_and_noise(data, free, around);
    }
  }
  result.is_converged = fit.is_converged;
  if (!std::isfinite(fit.deviance)) return result;
  done(kBest);

  // A better fit may have a play, or none.
  for (int turn = 0; turn <= kMostRestarts; ++turn) {
    free[kBacklash] = fit.values[kBacklash] > 0.0;
    const std::optional<AxisFit> better =
        add_parameters(result, turn == kMostRestarts,
                       [&](double share) { done(kBest + (kBounded - kBest) * share); });
    if (!better) break;
    free[kBacklash] = better->values[kBacklash] > 0.0;
    result.fit = fit_axis_and_noise(data, free, *better);
    result.is_converged = result.fit.is_converged;
  }

  result.errors.rms = rms_error(data, fit);
  result.errors.normalised = result.errors.rms / std::sqrt(error_variance(data, fit));
  result.whiteness = whiteness_of(data, fit);
  if (!result.whiteness.is_white()) {
    result.notes.emplace_back(
        "the residuals are not white: the model lacks something, or times or repaired rows of the "
        "table are wrong. The intervals are too narrow");
  }
  if (!held_out.empty()) {
    AxisData held = axis_data(held_out, settings.inputs_act_before, settle_s);
    held.model = data.model;
    held.quantum = data.quantum;
    held.rounding = data.rounding;
    if (held.stretches.empty()) {
      throw std::invalid_argument("the held-out records are too short");
    }
    AxisFit at_held = fit;
    at_held.starts.clear();
    allow_rounded_times(held, fit_starts(held, at_held));
    result.held_out = held_out_errors(held, result);
  }
  return result;
}

Identification identify_despite_clocks(std::vector<RecordedAxis> records,
                                       std::vector<RecordedAxis> held_out,
                                       const IdentificationSettings& settings) {
  std::exception_ptr refusal;  // the first one
  const auto attempt = [&]() -> std::optional<Identification> {
    try {
      return identify_axis(records, held_out, settings);
    } catch (const std::invalid_argument&) {
      if (!refusal) refusal = std::current_exception();
      return std::nullopt;
    }
  };
  const auto has_fit = [](const auto& one) { return one && !one->parameters.empty(); };
  const std::optional<Identification> plain = attempt();
  if (has_fit(plain) && plain->whiteness.is_white()) return *plain;
  const std::vector<double> offsets = corrected(records, settings);
  std::optional<Identification> moved;
  if (std::ranges::any_of(offsets, [](double offset) { return offset != 0.0; })) {
    corrected(held_out, settings);
    moved = attempt();
    const bool is_worse =
        has_fit(plain) && (!has_fit(moved) || moved->errors.rms > 0.5 * plain->errors.rms);
    if (is_worse) moved.reset();
  }
  if (!moved && !plain) std::rethrow_exception(refusal);
  if (!moved) return *plain;
  Identification& found = *moved;
  found.notes.push_back(fmt::format(
      "the clocks of u and y differ: u acts later by {:.3g} s. The delay is what remains",
      fmt::join(offsets, " s, ")));
  for (ParameterEstimate& estimate : found.parameters) {
    if (estimate.parameter != kDelay) continue;
    estimate.is_identifiable = false;
    estimate.reason = "the clocks of u and y differ, and a delay acts alike";
    estimate.excitation = "a record of both with one clock";
  }
  return found;
}

}  // namespace breakwater
