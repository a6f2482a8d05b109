#include <breakwater/analysis/loop_analysis.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <breakwater/rigs/loop_response.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/progress.h>

namespace breakwater {
namespace {

constexpr double kAgree = 1e-3;
constexpr std::size_t kMostWindows = 8;
constexpr double kLeastSamples = 200;  // smallest length of a window

double abs2(const Phasors& a) {
  return std::norm(a.command) + std::norm(a.disturbance) + std::norm(a.velocity);
}

Phasors operator-(const Phasors& a, const Phasors& b) {
  return {a.command - b.command, a.disturbance - b.disturbance, a.velocity - b.velocity};
}

// A loop's controller with a sine as the probe. Computes the outputs' phasors at its frequency.
class Probed final : public Controller {
 public:
  Probed(AxisLoop& loop, Probe probe, double amplitude, double omega_per_sample)
      : loop_(loop),
        amplitude_(probe == Probe::force ? amplitude : 0.0),
        omega_per_sample_(omega_per_sample) {}

  void reset(const Sample& first) override { loop_.controller->reset(first); }
  void update(const Sample& y, Eigen::Ref<Eigen::VectorXd> u) override {
    loop_.controller->update(y, u);
    const double angle = omega_per_sample_ * static_cast<double>(k_++);
    const std::complex<double> turned = std::polar(1.0, -angle);
    sums_.command += u(0) * turned;
    if (loop_.estimates()) {
      sums_.disturbance += loop_.estimator->disturbance()(0) * turned;
      sums_.velocity += loop_.estimator->state()(1) * turned;
    }
    u(0) += amplitude_ * std::sin(angle);
  }
  std::span<const Signal> signals() const override { return loop_.controller->signals(); }

  std::size_t samples() const { return k_; }
  // The sums since the last call.
  Phasors take() { return std::exchange(sums_, Phasors{}); }

 private:
  AxisLoop& loop_;
  double amplitude_;
  double omega_per_sample_;
  std::size_t k_ = 0;
  Phasors sums_;
};

}  // namespace

SineResponse measure_sine(const AxisOfPlant& axis, const SineTest& test) {
  const AxisTask& task = axis.task;
  const double period_s = task.axis.period_s;
  // A window of whole periods in whole samples.
  const double per_period = 2.0 * std::numbers::pi / (test.omega_rad_s * period_s);
  const double periods = std::max(1.0, std::ceil(kLeastSamples / per_period));
  const double samples = std::round(periods * per_period);
  const auto window = static_cast<std::size_t>(samples);
  const double omega_per_sample = 2.0 * std::numbers::pi * periods / samples;

  AxisLoop loop = axis.parts->make(task);
  auto own = std::make_unique<Probed>(loop, test.probe, test.amplitude, omega_per_sample);
  Probed& probed = *own;
  std::unique_ptr<Controller> controller = std::move(own);
  if (axis.among_others) controller = axis.among_others(std::move(controller));
  SineResponse response;
  response.omega_rad_s = omega_per_sample / period_s;
  AxisPlant plant = axis.plant;
  for (AxisSettings& one : plant.axes) one.force = one.output = {};
  plant.pushes.clear();
  if (test.probe == Probe::noise) {
    plant.axes[axis.index].output = {DisturbanceKind::sine, test.amplitude, response.omega_rad_s,
                                     0.0};
  }
  AxisRig rig(plant, *controller);

  std::size_t saturated = 0, taken = 0;
  const auto run_until = [&](std::size_t samples_in_all) {
    while (probed.samples() < samples_in_all) {
      rig.step();
      if (!rig.simulation().sampled()) continue;
      ++taken;
      if (rig.simulation().saturated()) ++saturated;
      if (test.stop != nullptr && test.stop->load()) throw Interrupted();
    }
  };
  auto end = static_cast<std::size_t>(std::ceil(test.settle_s / period_s / samples)) * window;
  run_until(end);
  probed.take();
  // The phasor of the probe: Σ a sin(ωk) e^{−jωk} = −j a K/2.
  const std::complex<double> probe(0.0, -0.5 * test.amplitude * samples);
  std::vector<Phasors> windows;
  while (windows.size() < kMostWindows) {
    run_until(end += window);
    const Phasors sums = probed.take();
    windows.push_back({sums.command / probe, sums.disturbance / probe, sums.velocity / probe});
    if (windows.size() < 2) continue;
    const Phasors& now = windows.back();
    if (abs2(now - windows[windows.size() - 2]) <= kAgree * kAgree * abs2(now)) {
      windows = {now};
      break;
    }
  }
  const auto count = static_cast<double>(windows.size());
  for (const Phasors& one : windows) {
    response.gain.command += one.command / count;
    response.gain.disturbance += one.disturbance / count;
    response.gain.velocity += one.velocity / count;
  }
  double squares = 0.0;
  for (const Phasors& one : windows) squares += std::norm(one.command - response.gain.command);
  response.spread = std::sqrt(squares / count) /
                    std::max(std::abs(response.gain.command), std::numeric_limits<double>::min());
  response.saturated = static_cast<double>(saturated) / static_cast<double>(taken);
  return response;
}

namespace {

constexpr double kPi = std::numbers::pi;

// Finds the zero of a straight line from a to b, as a share of its length, if there is one.
bool crosses(double a, double b, double& share) {
  if (!((a <= 0.0 && b > 0.0) || (a >= 0.0 && b < 0.0))) return false;
  share = a / (a - b);
  return true;
}

double between(double a, double b, double share) {
  return a + (b - a) * share;
}

void take_less(double& least, double value) {
  if (std::isnan(least) || value < least) least = value;
}

}  // namespace

LoopMargins loop_margins(const std::vector<double>& omega_rad_s,
                         const std::vector<std::complex<double>>& loop_gain) {
  if (omega_rad_s.size() < 2 || omega_rad_s.size() != loop_gain.size()) {
    throw std::invalid_argument("margins need a loop gain at two frequencies or more");
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  LoopMargins margins{kNone, kNone, kNone, kNone, kNone, 0.0, 0.0};
  double last_phase = 0.0;
  for (std::size_t i = 0; i < omega_rad_s.size(); ++i) {
    const std::complex<double> L = loop_gain[i];
    margins.sensitivity_peak = std::max(margins.sensitivity_peak, std::abs(1.0 / (1.0 + L)));
    margins.complementary_peak = std::max(margins.complementary_peak, std::abs(L / (1.0 + L)));
    // Unwraps the phase: nearest to the last one.
    double phase = std::arg(L);
    if (i > 0) phase += 2.0 * kPi * std::round((last_phase - phase) / (2.0 * kPi));
    if (i > 0) {
      const double gain_a = std::log(std::abs(loop_gain[i - 1])), gain_b = std::log(std::abs(L));
      const double omega_a = std::log(omega_rad_s[i - 1]), omega_b = std::log(omega_rad_s[i]);
      double share = 0.0;
      if (crosses(gain_a, gain_b, share)) {
        const double omega = std::exp(between(omega_a, omega_b, share));
        const double at = between(last_phase, phase, share);
        double above = std::fmod(at + kPi, 2.0 * kPi);  // from −π, in [0, 2π)
        if (above < 0.0) above += 2.0 * kPi;
        margins.crossover_rad_s = omega;
        take_less(margins.phase_margin_rad, std::min(above, 2.0 * kPi - above));
        take_less(margins.delay_margin_s, above / omega);
      }
      // All crossings of −π plus whole turns.
      const double turn =
          2.0 * kPi * std::round((between(last_phase, phase, 0.5) + kPi) / (2.0 * kPi));
      if (crosses(last_phase + kPi - turn, phase + kPi - turn, share)) {
        const double factor = std::exp(-between(gain_a, gain_b, share));
        if (factor > 1.0 && !(margins.gain_margin <= factor)) {
          margins.gain_margin = factor;
        } else if (factor <= 1.0 && !(margins.gain_reduction_margin > factor)) {
          margins.gain_reduction_margin = factor;
        }
      }
    }
    last_phase = phase;
  }
  return margins;
}

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
  std::vector<std::vector<double>> omegas;
  for (const double to : to_rad_s) omegas.push_back(frequencies(options.from_rad_s, to, points));
  std::vector<double> times_s(2 * points * loops.size());
  std::vector<SineResponse> measured(times_s.size());  // with the force, then with the noise
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
        measured[task] = measure_sine(axis, test);
        progress.finish(task);
      },
      options.jobs);
  for (std::size_t loop = 0; loop < loops.size(); ++loop) {
    for (std::size_t i = 0; i < points && !results[loop].designed.is_unstable; ++i) {
      const std::size_t task = 2 * (i * loops.size() + loop);
      results[loop].measured.points.push_back(measured_point(measured[task], measured[task + 1]));
    }
    judge(results[loop].designed, results[loop].estimates);
    judge(results[loop].measured, results[loop].estimates);
    results[loop].hints = hints(loops[loop].axis, options, results[loop].measured);
  }
  return results;
}

}  // namespace breakwater
