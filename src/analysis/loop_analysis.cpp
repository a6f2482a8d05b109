#include <breakwater/analysis/loop_analysis.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <breakwater/analysis/swept_sine.h>
#include <breakwater/rigs/loop_response.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/progress.h>

namespace breakwater {
namespace {

constexpr std::size_t kDesignPoints = 1200;
constexpr double kShareOfNyquist = 0.9;
constexpr double kStillHalfThePower = std::numbers::sqrt2 / 2.0;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoiseCounts = 3.0, kSmallNoise = 1e-3;

double nyquist_rad_s(const AxisOfPlant& axis) {
  return std::numbers::pi / axis.task.axis.period_s;
}

// From low to high, equally spaced on a logarithmic scale.
std::vector<double> frequencies(double low, double high, std::size_t count) {
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = count == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(count - 1);
    result[i] = low * std::pow(high / low, share);
  }
  return result;
}

LoopPoint point(double omega_rad_s, const Phasors& of_force, const Phasors& of_noise) {
  LoopPoint p;
  p.omega_rad_s = omega_rad_s;
  p.d_hat_over_d = -of_force.disturbance;  // d = -r
  p.noise_to_d_hat = of_noise.disturbance;
  p.noise_to_v_hat = of_noise.velocity;
  p.complementary = -of_force.command;
  p.sensitivity = 1.0 + of_force.command;
  p.loop_gain = p.complementary / p.sensitivity;
  return p;
}

double bandwidth(const std::vector<LoopPoint>& points) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double a = std::abs(points[i - 1].d_hat_over_d), b = std::abs(points[i].d_hat_over_d);
    if (a < kStillHalfThePower || b >= kStillHalfThePower) continue;
    const double share = std::log(kStillHalfThePower / a) / std::log(b / a);
    return points[i - 1].omega_rad_s *
           std::pow(points[i].omega_rad_s / points[i - 1].omega_rad_s, share);
  }
  return kNone;
}

void judge(LoopCurve& curve, bool estimates) {
  curve.bandwidth_rad_s = kNone;
  curve.margins = {kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  if (curve.points.size() < 2) return;
  std::vector<double> omega;
  std::vector<std::complex<double>> gain;
  for (const LoopPoint& p : curve.points) {
    omega.push_back(p.omega_rad_s);
    gain.push_back(p.loop_gain);
  }
  curve.margins = loop_margins(omega, gain);
  if (estimates) curve.bandwidth_rad_s = bandwidth(curve.points);
}

double force_amplitude(const AxisOfPlant& axis, const AnalysisOptions& options) {
  if (options.force_amplitude > 0.0) return options.force_amplitude;
  return usual_force(axis.settings());
}

double noise_amplitude(const AxisOfPlant& axis, const AnalysisOptions& options) {
  if (options.noise_amplitude > 0.0) return options.noise_amplitude;
  return std::max(kSmallNoise, kNoiseCounts * axis.settings().quantum());
}

LoopCurve designed_curve(const AxisOfPlant& axis, const AnalysisOptions& options, double to_rad_s) {
  const double period_s = axis.task.axis.period_s;
  const AxisLoopDesign design = axis_loop_design(*axis.parts, axis.task, axis.plant, axis.index);
  const LoopResponseOrReason found =
      loop_response(design, force_amplitude(axis, options), noise_amplitude(axis, options));
  LoopCurve curve;
  curve.reason = found.reason;
  curve.is_unstable = found.is_unstable;
  if (found.response) {
    for (const double omega : frequencies(options.from_rad_s, to_rad_s, kDesignPoints)) {
      curve.points.push_back(point(omega,
                                   frequency_response(found.response->to_force, omega, period_s),
                                   frequency_response(found.response->to_noise, omega, period_s)));
    }
  }
  return curve;
}

// All measured responses of one loop.
struct SineResponses {
  std::vector<SineResponse> of_force, of_noise;
};

LoopPoint measured_point(const SineResponse& force, const SineResponse& noise) {
  LoopPoint p = point(force.omega_rad_s, force.gain, noise.gain);
  p.spread = force.spread;
  p.saturated = std::max(force.saturated, noise.saturated);
  return p;
}

void check(const AnalysedLoop& loop, const AnalysisOptions& options, double to_rad_s) {
  const double nyquist = nyquist_rad_s(loop.axis);
  if (!(options.from_rad_s > 0.0 && options.from_rad_s < to_rad_s && to_rad_s < nyquist)) {
    throw std::invalid_argument(
        fmt::format("{}: frequencies from {:g} to {:g} rad/s: must rise, and stay below the "
                    "Nyquist frequency, {:.4g} rad/s",
                    loop.name.label(), options.from_rad_s, to_rad_s, nyquist));
  }
  const AxisSettings& settings = loop.axis.settings();
  if (options.force_amplitude >= settings.force_limit()) {
    throw std::invalid_argument(
        fmt::format("{}: --amplitude: {:g} {}: must be below the drive's "
                    "limit, {:g} {}",
                    loop.name.label(), options.force_amplitude, settings.axis.units.force,
                    settings.force_limit(), settings.axis.units.force));
  }
}

// How the loop is cut out of its plant, and why a measurement says little about the loop that moves
// freely.
std::vector<std::string> hints(const AxisOfPlant& axis, const AnalysisOptions& options,
                               const LoopCurve& measured) {
  constexpr double kTimesFriction = 3.0, kMuchSaturated = 0.1;
  std::vector<std::string> texts;
  if (has_other_joints(axis.plant, axis.index)) {
    texts.emplace_back(measured.points.empty()
                           ? "designed with the other joints held"
                           : "designed with the other joints held, measured with them under their "
                             "own controllers, if any");
  }
  if (measured.points.empty()) return texts;
  const AxisSettings& settings = axis.settings();
  const std::string& unit = settings.axis.units.force;
  const double amplitude = force_amplitude(axis, options);
  const double friction = axis.plant.coulomb_friction_at_drive(axis.index);
  if (amplitude < kTimesFriction * friction) {
    texts.push_back(fmt::format(
        "the sine of {:g} {} is less than {:g} times the Coulomb friction at the drive, {:g} {}. "
        "The axis sticks for a part of the time, and the margins show that: use a larger "
        "--amplitude",
        amplitude, unit, kTimesFriction, friction, unit));
  }
  double saturated = 0.0;
  for (const LoopPoint& one : measured.points) saturated = std::max(saturated, one.saturated);
  if (saturated > kMuchSaturated) {
    texts.push_back(fmt::format(
        "the drive is at its limit for up to {:.0f} % of the time (saturated_1 in analysis.csv): "
        "a smaller --amplitude or --noise-amplitude may help",
        100.0 * saturated));
  }
  return texts;
}

}  // namespace

std::vector<LoopAnalysis> analyse(const std::vector<AnalysedLoop>& loops,
                                  const AnalysisOptions& options) {
  std::vector<LoopAnalysis> results(loops.size());
  std::vector<double> to_rad_s;
  for (const AnalysedLoop& loop : loops) {
    to_rad_s.push_back(options.to_rad_s > 0.0 ? options.to_rad_s
                                              : kShareOfNyquist * nyquist_rad_s(loop.axis));
    check(loop, options, to_rad_s.back());
  }
  on_all_cores(
      loops.size(),
      [&](std::size_t i) {
        results[i].name = loops[i].name;
        const AxisOfPlant& axis = loops[i].axis;
        results[i].estimates = axis.parts->make(axis.task).estimates();
        results[i].designed = designed_curve(axis, options, to_rad_s[i]);
      },
      options.jobs);

  // The lowest frequencies of all loops come first, because they take the longest.
  const auto points = static_cast<std::size_t>(options.points);
  std::vector<SineResponses> measured(loops.size());
  for (SineResponses& one : measured) {
    one.of_force.resize(points);
    one.of_noise.resize(points);
  }
  std::vector<std::vector<double>> omegas;
  for (const double to : to_rad_s) omegas.push_back(frequencies(options.from_rad_s, to, points));
  std::vector<double> times_s(2 * points * loops.size());
  for (std::size_t task = 0; task < times_s.size(); ++task) {
    constexpr double kPeriods = 4.0;
    times_s[task] = options.settle_s + kPeriods * 2.0 * std::numbers::pi /
                                           omegas[task / 2 % loops.size()][task / 2 / loops.size()];
  }
  Progress progress("analyze", times_s, options.quiet);
  on_all_cores(
      times_s.size(),
      [&](std::size_t task) {
        const std::size_t loop = task / 2 % loops.size(), i = task / 2 / loops.size();
        if (results[loop].designed.is_unstable) return progress.finish(task);
        const bool is_force = task % 2 == 0;
        const AxisOfPlant& axis = loops[loop].axis;
        const SineTest test{
            .probe = is_force ? Probe::force : Probe::noise,
            .omega_rad_s = omegas[loop][i],
            .amplitude = is_force ? force_amplitude(axis, options) : noise_amplitude(axis, options),
            .settle_s = options.settle_s,
            .stop = options.stop};
        (is_force ? measured[loop].of_force : measured[loop].of_noise)[i] =
            measure_sine(axis, test);
        progress.finish(task);
      },
      options.jobs);
  for (std::size_t loop = 0; loop < loops.size(); ++loop) {
    for (std::size_t i = 0; i < points && !results[loop].designed.is_unstable; ++i) {
      results[loop].measured.points.push_back(
          measured_point(measured[loop].of_force[i], measured[loop].of_noise[i]));
    }
    judge(results[loop].designed, results[loop].estimates);
    judge(results[loop].measured, results[loop].estimates);
    results[loop].hints = hints(loops[loop].axis, options, results[loop].measured);
  }
  return results;
}

}  // namespace breakwater
