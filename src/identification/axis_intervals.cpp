#include <breakwater/identification/axis_intervals.h>

#include <algorithm>
#include <cmath>

#include <breakwater/identification/axis_parameters.h>
#include <breakwater/math/functions.h>
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

double encoded(const AxisData& data, double position) {
  if (data.quantum == 0.0) return position;
  const double counts = position / data.quantum;
  return data.quantum *
         (data.rounding == EncoderRounding::nearest ? std::round(counts) : std::trunc(counts));
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
  for (std::size_t p = 0; p < kAxisParameters; ++p) {
    if (!free[p]) continue;
    fit.values[p] =
        moved_parameter(data, static_cast<AxisParameter>(p), fit.values[p], changes(n++));
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
  interval.profile.emplace_back(fit.values[parameter], 0.0);
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
      interval.profile.emplace_back(value, rise);
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
  std::sort(interval.profile.begin(), interval.profile.end());
  return interval;
}

std::vector<double> bootstrap_std(const AxisData& data, const FreeParameters& free,
                                  const AxisFit& fit) {
  const Noise random(1, "identify"), drift(1, "drift");
  std::uint64_t drawn = 0;
  std::vector<double> sums(kAxisParameters, 0.0);
  std::vector<double> squares(kAxisParameters, 0.0);
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
      for (double& y : stretch.positions) y = encoded(data, positions[k++]);
    }
    const AxisFit again = fit_axis(made, free, truth, kIterations);
    for (std::size_t i = 0; i < kAxisParameters; ++i) {
      const double off = is_logarithmic(static_cast<AxisParameter>(i))
                             ? math::log(again.values[i] / fit.values[i])
                             : (again.values[i] - fit.values[i]) / scales[i];
      sums[i] += off;
      squares[i] += off * off;
    }
  }
  std::vector<double> stds;
  for (std::size_t i = 0; i < kAxisParameters; ++i) {
    if (free[i]) stds.push_back(std::sqrt(squares[i] / kReplicates));
  }
  return stds;
}

}  // namespace breakwater
