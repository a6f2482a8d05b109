#include <breakwater/identification/axis_intervals.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/statistics/linear_regression.hpp>
#include <cmath>
#include <limits>

#include <breakwater/identification/axis_model.h>
#include <breakwater/math/functions.h>
#include <breakwater/recorded/recorded_axis.h>
#include <breakwater/world/encoder.h>
#include <breakwater/world/noise.h>

namespace breakwater {
namespace {

constexpr double kClose = 0.05;     // in standard deviations
constexpr int kMostPoints = 6;      // on each side
constexpr double kFarthest = 20.0;  // in first guesses
constexpr double kFlat = 0.2;       // root of a rise that says that the guess is wrong
constexpr int kIterations = 20;
constexpr double kSuspicious = 1.5;  // rise, relative to that of a parabola
constexpr int kReplicates = 100;

constexpr std::size_t kBlocks = 128;
constexpr double kSmallShare = 0.25;  // share of the variance of the white errors
constexpr double kHalfStep = 0.6;     // with the error of the fitted clock

bool are_multiples(std::span<const double> times_s, double step) {
  return std::all_of(times_s.begin(), times_s.end(), [&](double t) {
    const double resolved = std::numeric_limits<double>::epsilon() * std::abs(t);
    return std::abs(t - step * std::round(t / step)) <= resolved;
  });
}

// Whether a clock without jitter explains the times. Missing rows are no jitter.
bool is_regular(std::span<const double> times_s, double step) {
  const std::vector<double> times(times_s.begin(), times_s.end());
  const double period_s = timing_of(times, 0.0, 1.5, 0.1).period_s;
  std::vector<double> ticks = {0.0}, passed_s = {0.0};
  for (std::size_t k = 1; k < times.size(); ++k) {
    ticks.push_back(ticks.back() + std::round((times[k] - times[k - 1]) / period_s));
    passed_s.push_back(times[k] - times.front());
  }
  const auto [first_s, tick_s] =
      boost::math::statistics::simple_ordinary_least_squares(ticks, passed_s);
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (std::abs(passed_s[k] - first_s - tick_s * ticks[k]) > kHalfStep * step) return false;
  }
  return true;
}

// The variance of the errors of a fit without their slow part, at least that of the encoder.
double white_variance(const AxisData& data, const AxisFit& fit) {
  const std::vector<double> positions = fitted_positions(data, fit);
  double squares = 0.0, count = 0.0;
  std::size_t from = 0;
  for (const AxisStretch& stretch : data.stretches) {
    const auto error = [&](std::size_t k) { return stretch.positions[k] - positions[from + k]; };
    for (std::size_t k = 2; k < stretch.positions.size(); ++k) {
      const double second = error(k) - 2.0 * error(k - 1) + error(k - 2);
      squares += second * second / 6.0;
      count += 1.0;
    }
    from += stretch.positions.size();
  }
  return std::max(squares / count, data.quantum * data.quantum / 12.0);
}

// |v| by the standard deviation of a time.
std::vector<double> time_noise(const AxisStretch& stretch, const Eigen::VectorXd& positions) {
  std::vector<double> noise;
  const Eigen::Index last = positions.size() - 1;
  for (Eigen::Index k = 0; k <= last; ++k) {
    const Eigen::Index from = std::max<Eigen::Index>(k - 1, 0), to = std::min(k + 1, last);
    const double h = stretch.times_s[static_cast<std::size_t>(to)] -
                     stretch.times_s[static_cast<std::size_t>(from)];
    noise.push_back(std::abs(positions(to) - positions(from)) / h * stretch.time_step_s /
                    std::sqrt(12.0));
  }
  return noise;
}

// The motions by the errors of the changes of the input, of one standard deviation. In a block
// they are in proportion to the changes: their pushes have the variance of independent errors.
template <typename Move>
Eigen::MatrixXd pushed(const AxisStretch& stretch, const Eigen::VectorXd& exact,
                       const Move& moved) {
  const std::size_t changes = stretch.inputs.size();
  const auto change = [&](std::size_t k) {
    return k == 0 ? 0.0 : stretch.inputs[k] - stretch.inputs[k - 1];
  };
  Eigen::MatrixXd pushes = Eigen::MatrixXd::Zero(exact.size(), kBlocks);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t from = block * changes / kBlocks, to = (block + 1) * changes / kBlocks;
    double squares = 0.0;
    for (std::size_t k = from; k < to; ++k) squares += change(k) * change(k);
    if (squares == 0.0) continue;
    AxisStretch late = stretch;
    for (std::size_t k = from; k < to; ++k) {
      late.input_times_s[k] += stretch.time_step_s * change(k) / std::sqrt(12.0 * squares);
    }
    pushes.col(static_cast<Eigen::Index>(block)) = moved(late) - exact;
  }
  return pushes;
}

}  // namespace

double moved_parameter(const AxisData& data, AxisParameter parameter, double value, double change) {
  if (is_logarithmic(parameter)) return value * math::exp(change);
  const double moved = value + change * parameter_scales(data)[parameter];
  if (parameter == kDelay) return std::clamp(moved, data.least_delay_s, data.largest_delay_s);
  return is_positive(parameter) ? std::max(0.0, moved) : moved;
}

AxisFit moved_fit(const AxisData& data, const FreeParameters& free, AxisFit fit,
                  const Eigen::VectorXd& changes) {
  Eigen::Index n = 0;
  for (const AxisParameter p : listed(free)) {
    fit.values[p] = moved_parameter(data, p, fit.values[p], changes(n++));
  }
  return fit;
}

ParameterInterval profile_interval(const AxisData& data, const FreeParameters& free,
                                   const AxisFit& fit, AxisParameter parameter, double std_scaled,
                                   const Eigen::VectorXd& slopes) {
  FreeParameters others = free;
  others[parameter] = false;
  ParameterInterval interval;
  interval.better = fit;
  interval.highest = {fit.values[parameter], 0.0};
  // The curvature at the fit may be that of a point. The search goes on to where a parameter counts
  // as unknown.
  const double known = kRoot95 * known_parameter(parameter).largest_std;
  const double farthest = std::max(kFarthest * std_scaled, std::isfinite(known) ? known : 0.0);
  const auto side = [&](double sign) {
    double reach = kRoot95 * std_scaled;
    double value = fit.values[parameter];
    double inside = value;  // the farthest value in the interval
    for (int i = 0; i < kMostPoints; ++i) {
      value = moved_parameter(data, parameter, fit.values[parameter], sign * reach);
      const double expected = kChiSquare95 * std::pow(reach / (kRoot95 * std_scaled), 2.0);
      AxisFit beside = moved_fit(data, free, fit, sign * reach * slopes), from = fit;
      beside.values[parameter] = from.values[parameter] = value;
      AxisFit nearest = beside;
      nearest.deviance = std::numeric_limits<double>::infinity();
      const auto search = [&](const AxisFit& start) {
        AxisFit one = fit_axis(data, others, start, kIterations);
        if (one.deviance < nearest.deviance) nearest = std::move(one);
      };
      const auto ended_beside_the_minimum = [&] {
        return !(nearest.deviance - fit.deviance < kSuspicious * expected);
      };
      search(beside);
      // Flanks and stiction make several minima.
      if (data.model->has_backlash || ended_beside_the_minimum()) search(from);
      if (ended_beside_the_minimum()) search(nearest);
      const double rise = std::max(0.0, nearest.deviance - fit.deviance);
      if (!std::isfinite(rise)) {
        reach *= 0.5;
        continue;
      }
      if (nearest.deviance < interval.better.deviance) interval.better = nearest;
      if (rise <= kChiSquare95 && sign * (value - inside) > 0.0) inside = value;
      interval.highest = std::max(interval.highest, {value, rise});
      const bool is_at_end =
          value == moved_parameter(data, parameter, fit.values[parameter], sign * 2.0 * reach);
      if (is_at_end && rise <= kChiSquare95) return value;
      const double root = std::max(std::sqrt(rise), 0.3);
      // The root of the rise is almost linear.
      const double next =
          rise < kFlat * kFlat ? farthest : std::min(reach * kRoot95 / root, farthest);
      if (std::abs(root - kRoot95) < kClose) {
        return moved_parameter(data, parameter, fit.values[parameter], sign * next);
      }
      if (next == reach) {
        interval.is_known = false;
        return value;
      }
      reach = next;
    }
    interval.is_closed = false;
    return inside == fit.values[parameter] ? value : inside;
  };
  interval.low = side(-1.0);
  interval.high = side(1.0);
  return interval;
}

std::vector<double> bootstrap_std(const AxisData& data, const FreeParameters& free,
                                  const AxisFit& fit) {
  const Noise random(1, "identify"), drift(1, "drift");
  std::uint64_t drawn = 0;
  const Encoder encoder{.quantum = data.quantum, .rounding = data.rounding};
  const std::vector<AxisParameter> order = listed(free);
  std::vector<double> stds(order.size(), 0.0);  // at first the sums of the squares
  const AxisValues scales = parameter_scales(data);
  for (std::uint64_t n = 0; n < kReplicates; ++n) {
    AxisFit truth = fit;
    for (std::size_t s = 0; s < truth.starts.size(); ++s) {
      truth.starts[s].position +=
          data.quantum * (random.uniform(n * truth.starts.size() + s) - 0.5);
      Eigen::VectorXd& drifts = truth.starts[s].drifts;
      drifts.resize(data.stretches[s].drifts.cols());
      for (double& size : drifts) size = drift(drawn++);
    }
    const std::vector<double> positions = fitted_positions(data, truth);
    AxisData made = data;
    std::size_t k = 0;
    for (AxisStretch& stretch : made.stretches) {
      for (double& y : stretch.positions) y = encoder.measure(positions[k++]);
    }
    const AxisFit again = fit_axis(made, free, truth, kIterations);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const AxisParameter p = order[i];
      const double off = is_logarithmic(p) ? math::log(again.values[p] / fit.values[p])
                                           : (again.values[p] - fit.values[p]) / scales[p];
      stds[i] += off * off;
    }
  }
  for (double& std : stds) std = std::sqrt(std / kReplicates);
  return stds;
}

double rounding_step(std::span<const double> times_s) {
  double latest = 0.0;
  for (const double t : times_s) latest = std::max(latest, std::abs(t));
  constexpr double kResolved = 0.4;
  for (int digits = 0; digits <= 12; ++digits) {
    const double step = std::pow(10.0, -digits);
    if (std::numeric_limits<double>::epsilon() * latest > kResolved * step) break;
    if (are_multiples(times_s, step)) return is_regular(times_s, step) ? 0.0 : step;
  }
  return 0.0;
}

bool allow_rounded_times(AxisData& data, const AxisFit& fit) {
  const auto is_rounded = [](const AxisStretch& stretch) { return stretch.time_step_s > 0.0; };
  if (std::none_of(data.stretches.begin(), data.stretches.end(), is_rounded)) return false;
  const double variance = white_variance(data, fit);
  bool is_added = false;
  for (std::size_t s = 0; s < data.stretches.size(); ++s) {
    AxisStretch& stretch = data.stretches[s];
    if (!is_rounded(stretch)) continue;
    const auto rows = static_cast<Eigen::Index>(stretch.positions.size());
    const auto moved = [&](const AxisStretch& one) {
      Eigen::VectorXd positions(rows);
      data.model->move(fit.values, fit.starts[s], one,
                       {positions.data(), stretch.positions.size()});
      return positions;
    };
    const Eigen::VectorXd exact = moved(stretch);
    const Eigen::MatrixXd pushes = pushed(stretch, exact, moved);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(pushes.transpose() * pushes);
    const auto large = (parts.eigenvalues().array() > kSmallShare * variance).count();
    stretch.drifts = pushes * parts.eigenvectors().rightCols(large);
    stretch.time_noise = time_noise(stretch, exact);
    double squares = 0.0;
    for (const double noise : stretch.time_noise) squares += noise * noise;
    if (squares < kSmallShare * variance * static_cast<double>(rows)) stretch.time_noise.clear();
    is_added = is_added || large > 0 || !stretch.time_noise.empty();
  }
  return is_added;
}

}  // namespace breakwater
