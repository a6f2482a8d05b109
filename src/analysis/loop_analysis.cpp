#include <breakwater/analysis/loop_analysis.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include <breakwater/control/controller.h>
#include <breakwater/math/functions.h>
#include <breakwater/shell/all_cores.h>
#include <breakwater/shell/progress.h>
#include <breakwater/sim/linear_model.h>
#include <breakwater/world/delay_line.h>
#include <breakwater/world/noise.h>

namespace breakwater {
namespace {

constexpr double kPi = std::numbers::pi, kTurn = 2.0 * kPi;
constexpr double kAgree = 1e-3;
constexpr std::size_t kMostWindows = 8;
constexpr double kLeastSamples = 200;  // smallest length of a window

// The probe of a loop. `force` is a force r on the plant, held over a sample and unknown to the
// controller. `noise` is an error n of the measured position.
enum class Probe { force, noise };

// The observed signals of a loop: the controller's command u without the probe, d̂ and v̂. Without
// an estimator, d̂ and v̂ are 0.
constexpr Eigen::Index kCommand = 0, kDisturbance = 1, kVelocity = 2;
using Phasors = Eigen::Vector3cd;

Eigen::Vector3d observed(const AxisLoop& loop, double command) {
  if (!loop.estimates()) return {command, 0.0, 0.0};
  return {command, loop.estimator->disturbance()(0), loop.estimator->state()(1)};
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
    sums_ += observed(loop_, u(0)) * std::polar(1.0, -angle);
    u(0) += amplitude_ * std::sin(angle);
  }
  std::span<const Signal> signals() const override { return loop_.controller->signals(); }

  std::size_t samples() const { return k_; }
  // The sums since the last call.
  Phasors take() { return std::exchange(sums_, Phasors::Zero()); }

 private:
  AxisLoop& loop_;
  double amplitude_;
  double omega_per_sample_;
  std::size_t k_ = 0;
  Phasors sums_ = Phasors::Zero();
};

// The phasors of the observed signals at the probe's frequency, divided by the probe's.
struct SineResponse {
  double omega_rad_s = 0.0;  // rounded so that whole periods have whole samples
  Phasors gain = Phasors::Zero();
  double spread = 0.0;     // relative standard deviation of the command's gain between windows
  double saturated = 0.0;  // share of the samples with the drive at its limit
};

// Runs the plant of an axis, its encoder, drive and controller with a sine as the probe alone.
// Other axes are under their own controllers. If two windows of whole periods agree to 1e-3,
// returns the second one. Otherwise returns the mean of eight windows, because a loop with an
// encoder never repeats exactly. Throws RunFailure, ControlFailure or Interrupted.
SineResponse measure_sine(const AxisOfPlant& axis, Probe kind, double omega_rad_s,
                          const AnalysisOptions& options) {
  const double amplitude = kind == Probe::force ? options.force_amplitude : options.noise_amplitude;
  const AxisTask& task = axis.task;
  const double period_s = task.axis.period_s;
  // A window of whole periods in whole samples.
  const double per_period = kTurn / (omega_rad_s * period_s);
  const double periods = std::max(1.0, std::ceil(kLeastSamples / per_period));
  const double samples = std::round(periods * per_period);
  const auto window = static_cast<std::size_t>(samples);
  const double omega_per_sample = kTurn * periods / samples;

  AxisLoop loop = axis.parts->make(task);
  auto own = std::make_unique<Probed>(loop, kind, amplitude, omega_per_sample);
  Probed& probed = *own;
  std::unique_ptr<Controller> controller = std::move(own);
  if (axis.among_others) controller = axis.among_others(std::move(controller));
  SineResponse response;
  response.omega_rad_s = omega_per_sample / period_s;
  AxisPlant plant = axis.plant;
  for (AxisSettings& one : plant.axes) one.force = one.output = {};
  plant.pushes.clear();
  if (kind == Probe::noise) {
    plant.axes[axis.index].output = {DisturbanceKind::sine, amplitude, response.omega_rad_s, 0.0};
  }
  AxisRig rig(plant, *controller);

  std::size_t saturated = 0, taken = 0;
  const auto run_until = [&](std::size_t samples_in_all) {
    while (probed.samples() < samples_in_all) {
      rig.step();
      if (!rig.simulation().sampled()) continue;
      ++taken;
      if (rig.simulation().saturated()) ++saturated;
      if (options.stop != nullptr && options.stop->load()) throw Interrupted();
    }
  };
  auto end = static_cast<std::size_t>(std::ceil(options.settle_s / period_s / samples)) * window;
  run_until(end);
  probed.take();
  // The phasor of the probe: Σ a sin(ωk) e^{−jωk} = −j a K/2.
  const std::complex<double> probe(0.0, -0.5 * amplitude * samples);
  std::vector<Phasors> windows;
  while (windows.size() < kMostWindows) {
    run_until(end += window);
    windows.emplace_back(probed.take() / probe);
    if (windows.size() < 2) continue;
    const Phasors& now = windows.back();
    if ((now - windows[windows.size() - 2]).norm() <= kAgree * now.norm()) {
      windows = {Phasors(now)};
      break;
    }
  }
  const auto count = static_cast<double>(windows.size());
  for (const Phasors& one : windows) response.gain += one / count;
  const std::complex<double> command = response.gain(kCommand);
  double squares = 0.0;
  for (const Phasors& one : windows) squares += std::norm(one(kCommand) - command);
  response.spread =
      std::sqrt(squares / count) / std::max(std::abs(command), std::numeric_limits<double>::min());
  response.saturated = static_cast<double>(saturated) / static_cast<double>(taken);
  return response;
}

// The zero of a straight line from a to b, as a share of its length, if there is one.
std::optional<double> crossing(double a, double b) {
  if (!((a <= 0.0 && b > 0.0) || (a >= 0.0 && b < 0.0))) return std::nullopt;
  return a / (a - b);
}

constexpr double kSame = 1e-6;     // two responses are equal up to this share of the largest value
constexpr double kDecayed = 1e-9;  // a response ends below this share of its largest value
constexpr std::size_t kPattern = 1000;  // samples of the random binary force
constexpr std::size_t kFirstLength = 4096, kLongest = std::size_t{1} << 20U;
constexpr std::size_t kLongestJudged = std::size_t{1} << 16U;
constexpr double kFar = 1e3;        // a last quarter of a response that has run away, over the rest
constexpr double kRounding = 1e-5;  // error of the peak of a sampled oscillation
constexpr double kWhole = 1e-9;     // a smaller part of a period is rounding
constexpr std::size_t kWarmUps[] = {500, 5000, 50'000};  // settling times of a gain, in samples
constexpr std::size_t kLater = 777;
// Samples of the observed signals, in columns.
using PulseResponse = Eigen::Matrix3Xd;

// The loop of one axis: the scenario's controller and a linear plant
//     x(k+1) = A x(k) + B (u(k − m) + r(k − m)),   y(k) = C x(k − l) + n(k − l) ,
// without limits, rounding and Coulomb friction. A jitter of the command counts as its mean.
struct ProbedLoop {
  const AxisOfPlant& axis;
  // Over one period. Behind the states of linear_axis() come those of the drive's current loop, and
  // the command before, if it acts on a part of the period.
  StateSpace plant;
  Eigen::VectorXd start_state;    // n
  int command_delay_samples = 0;  // m, the whole periods of the command's delay

  int delay_samples() const { return axis.settings().delay_samples; }  // l, of the measurement
};

struct ProbeSequence {
  Probe probe = Probe::force;
  std::size_t from = 0;
  std::vector<double> values;

  double at(Probe of, std::size_t k) const {
    return of == probe && k >= from && k - from < values.size() ? values[k - from] : 0.0;
  }
};

PulseResponse run(const ProbedLoop& design, const ProbeSequence& probe, std::size_t samples) {
  const AxisTask& task = design.axis.task;
  const AxisLoop loop = design.axis.parts->make(task);
  Eigen::VectorXd x = design.start_state;
  DelayLine measured(design.delay_samples()), command(design.command_delay_samples);
  command.update(0.0);  // the drive's force before the first command
  const bool has_full_state = task.senses_true_state;
  const Eigen::Index entries = has_full_state ? 3 : 1;
  Sample sample{0.0, Eigen::VectorXd::Zero(entries + (task.force.is_there() ? 2 : 0))};
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  const auto sense = [&](std::size_t k) {
    sample.time_s = static_cast<double>(k) * task.axis.period_s;
    sample.y(0) = measured.update((design.plant.C * x)(0) + probe.at(Probe::noise, k));
    if (has_full_state) sample.y.segment<2>(1) = x.head<2>();
  };
  PulseResponse out = PulseResponse::Zero(3, static_cast<Eigen::Index>(samples));
  for (std::size_t k = 0; k < samples; ++k) {
    sense(k);
    if (k == 0) loop.controller->reset(sample);
    loop.controller->update(sample, u);
    out.col(static_cast<Eigen::Index>(k)) = observed(loop, u(0));
    x = design.plant.A * x + design.plant.B * command.update(u(0) + probe.at(Probe::force, k));
  }
  return out;
}

// (a − b) scale, from sample `from` on.
PulseResponse difference(const PulseResponse& a, const PulseResponse& b, std::size_t from,
                         double scale) {
  return (a - b).rightCols(a.cols() - static_cast<Eigen::Index>(from)) * scale;
}

using Values = Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

// 0 of none, infinite if one is not finite.
double largest(const Values& values) {
  if (!values.allFinite()) return std::numeric_limits<double>::infinity();
  return values.size() == 0 ? 0.0 : values.cwiseAbs().maxCoeff();
}

bool is_same(const Values& a, const Values& b) {
  return ((a - b).array().abs() <= kSame * largest(a)).all();
}

bool are_same(const PulseResponse& a, const PulseResponse& b) {
  return is_same(a.row(0), b.row(0)) && is_same(a.row(1), b.row(1)) && is_same(a.row(2), b.row(2));
}

bool has_decayed(const Values& values) {
  const Eigen::Index from = values.size() * 3 / 4;
  return largest(values.tail(values.size() - from)) <= kDecayed * largest(values);
}

// A random binary sequence.
std::vector<double> binary_pattern(double amplitude) {
  const Noise random(1, "pattern");
  std::vector<double> values(kPattern);
  for (std::size_t k = 0; k < kPattern; ++k) values[k] = random(k) < 0.0 ? -amplitude : amplitude;
  return values;
}

PulseResponse to_pulse(const ProbedLoop& design, Probe probe, double size, std::size_t from,
                       std::size_t length) {
  return difference(run(design, {probe, from, {size}}, from + length),
                    run(design, {}, from + length), from, 1.0 / size);
}

bool is_linear(const ProbedLoop& design, Probe probe, double size, std::size_t from) {
  const std::size_t samples = from + 2 * kPattern;
  const PulseResponse rest = run(design, {}, samples);
  const PulseResponse once = run(design, {probe, from, binary_pattern(size)}, samples);
  const PulseResponse twice = run(design, {probe, from, binary_pattern(-2.0 * size)}, samples);
  return are_same(difference(once, rest, from, -2.0), difference(twice, rest, from, 1.0));
}

// The first sample from which the response to a pulse does not change with time, if there is one.
std::optional<std::size_t> time_invariant_from(const ProbedLoop& design, double force) {
  for (const std::size_t from : kWarmUps) {
    if (are_same(to_pulse(design, Probe::force, force, from, kFirstLength),
                 to_pulse(design, Probe::force, force, from + kLater, kFirstLength))) {
      return from;
    }
  }
  return std::nullopt;
}

// Nothing if the response does not end.
std::optional<PulseResponse> whole_response(const ProbedLoop& design, Probe probe, double size,
                                            std::size_t from) {
  for (std::size_t length = kFirstLength; length <= kLongest; length *= 4) {
    PulseResponse pulses = to_pulse(design, probe, size, from, length);
    if (has_decayed(pulses.row(0)) && has_decayed(pulses.row(1)) && has_decayed(pulses.row(2))) {
      return pulses;
    }
  }
  return std::nullopt;
}

// The plant behind the current loop of its drive, whose states are the force and its rate over ω.
StateSpace behind(const ElectricDrive& drive, const StateSpace& plant) {
  const double omega = drive.bandwidth_rad_s;
  if (omega == 0.0) return plant;
  const Eigen::Index n = plant.states(), order = drive.damping_ratio > 0.0 ? 2 : 1;
  StateSpace both{Eigen::MatrixXd::Zero(n + order, n + order), Eigen::MatrixXd::Zero(n + order, 1),
                  Eigen::MatrixXd::Zero(1, n + order)};
  both.A.topLeftCorner(n, n) = plant.A;
  both.A.col(n).head(n) = plant.B;
  both.A(n, n + order - 1) = order == 2 ? omega : -omega;
  if (order == 2) both.A.row(n + 1).tail<2>() << -omega, -2.0 * drive.damping_ratio * omega;
  both.B(n + order - 1) = omega;
  both.C.leftCols(n) = plant.C;
  return both;
}

// A period of a plant that gets each input `late_s` after its sample. The last state is the input
// before.
StateSpace hold_late(const StateSpace& continuous, double period_s, double late_s) {
  const StateSpace first = zero_order_hold(continuous, late_s);
  const StateSpace then = zero_order_hold(continuous, period_s - late_s);
  const Eigen::Index n = continuous.states();
  StateSpace sampled{Eigen::MatrixXd::Zero(n + 1, n + 1), Eigen::MatrixXd::Zero(n + 1, 1),
                     Eigen::MatrixXd::Zero(1, n + 1)};
  sampled.A.topLeftCorner(n, n) = then.A * first.A;
  sampled.A.col(n).head(n) = then.A * first.B;
  sampled.B << then.B, 1.0;
  sampled.C.leftCols(n) = continuous.C;
  return sampled;
}

// The linear part of an axis, continuous: its inertia and its viscous friction, or both inertias of
// its transmission. The other joints are held at the pose of the keyframe. Gravity has no part in
// it.
StateSpace linear_axis(const AxisOfPlant& of) {
  const Model model = of.plant.load_model();
  const AxisSettings& one = of.settings();
  return one.transmission.linear(one.transmission.true_numbers(
      model, joint_inertia(model, of.plant.pose(model)), one.axis.joint));
}

// A force that the drive has: 1, but at most a tenth of its limit.
double usual_force(const AxisSettings& axis) {
  return std::min(1.0, 0.1 * axis.force_limit());
}

ProbedLoop loop_design(const AxisOfPlant& of) {
  const AxisSettings& axis = of.settings();
  const TransmissionSettings& transmission = axis.transmission;
  const StateSpace linear = linear_axis(of);
  const StateSpace driven = behind(axis.drive.electric, linear);
  const double period_s = of.task.axis.period_s;
  const double periods = of.plant.timing.delays().mean_s() / period_s;
  const double whole = std::floor(periods + kWhole), part = periods - whole;
  ProbedLoop design{of,
                    part > kWhole ? hold_late(driven, period_s, part * period_s)
                                  : zero_order_hold(driven, period_s),
                    {},
                    static_cast<int>(whole)};
  const Eigen::Vector2d start(axis.reference.before + axis.start_position, axis.start_velocity);
  design.start_state.setZero(design.plant.states());
  design.start_state.head<2>() = start * transmission.measured_ratio();
  if (linear.states() == 4) {
    const bool is_load_other = transmission.measured == Side::motor;
    design.start_state.segment<2>(2) = start * (is_load_other ? 1.0 : transmission.design.ratio);
  }
  return design;
}

// Whether the model has joints beside those of the axis. They are held in loop_design().
bool has_other_joints(const AxisOfPlant& axis) {
  return axis.plant.load_model()->nv > (axis.settings().transmission.is_elastic() ? 2 : 1);
}

// Whether the loop has an eigenvalue outside of the unit circle. Each sample multiplies the state
// of controller, plant and delays by one matrix. So in the end the response to a pulse grows by the
// largest eigenvalue (power iteration over up to 65 536 samples). A loop that is not linear is
// unstable if its response runs away.
bool is_unstable(const ProbedLoop& design) {
  // The response begins after the delays.
  const auto delays = static_cast<std::size_t>(design.delay_samples()) +
                      static_cast<std::size_t>(design.command_delay_samples);
  const double usual = usual_force(design.axis.settings());
  std::size_t first = kFirstLength;
  while (first < 16 * delays) first *= 4;
  const auto command = [&](double force, std::size_t length) -> Eigen::RowVectorXd {
    return to_pulse(design, Probe::force, force, 0, length).row(kCommand);
  };
  for (std::size_t length = first;; length *= 4) {
    const Eigen::RowVectorXd response = command(usual, length);
    const Eigen::Index quarter = response.size() / 4;
    const double before = largest(response.segment(2 * quarter, quarter));
    const double last = largest(response.tail(quarter));
    if (!std::isfinite(last) || last > kFar * largest(response.head(3 * quarter))) return true;
    if (has_decayed(response)) return false;
    if (length < kLongestJudged) continue;
    // A loop that is not linear has no eigenvalues.
    const auto begin = static_cast<Eigen::Index>(first);
    return is_same(command(-2.0 * usual, first), response.head(begin)) &&
           (last > (1.0 + kRounding) * before ||
            (last > (1.0 - kRounding) * before && last > largest(response.head(begin / 4))));
  }
}

// Σ h(k) e^{−jωkT} of each output.
Phasors frequency_response(const PulseResponse& pulses, double omega_rad_s, double period_s) {
  const std::complex<double> back(math::cos(omega_rad_s * period_s),
                                  -math::sin(omega_rad_s * period_s));
  Phasors result = Phasors::Zero();
  // Horner's rule in z⁻¹. The three sums do not wait for each other.
  for (Eigen::Index k = pulses.cols(); k-- > 0;) result = result * back + pulses.col(k);
  return result;
}

constexpr std::size_t kDesignPoints = 1200;
constexpr double kShareOfNyquist = 0.9;
constexpr double kStillHalfThePower = std::numbers::sqrt2 / 2.0;
constexpr double kNoiseCounts = 3.0, kSmallNoise = 1e-3;

// Number i of `count` frequencies from low to high, equally spaced on a logarithmic scale.
double frequency(const AnalysisOptions& options, std::size_t i, std::size_t count) {
  const double share = count == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(count - 1);
  return options.from_rad_s * std::pow(options.to_rad_s / options.from_rad_s, share);
}

LoopPoint point(double omega_rad_s, const Phasors& of_force, const Phasors& of_noise) {
  LoopPoint p;
  p.omega_rad_s = omega_rad_s;
  p.d_hat_over_d = -of_force(kDisturbance);  // d = -r
  p.noise_to_d_hat = of_noise(kDisturbance);
  p.noise_to_v_hat = of_noise(kVelocity);
  p.complementary = -of_force(kCommand);
  p.sensitivity = 1.0 + of_force(kCommand);
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
  return LoopMargins::kNone;
}

void judge(LoopCurve& curve, bool estimates, bool is_measured) {
  std::vector<LoopPoint> reliable;
  std::vector<double> omega;
  std::vector<std::complex<double>> gain;
  for (const LoopPoint& p : curve.points) {
    if (is_measured && !is_reliable(p)) continue;
    reliable.push_back(p);
    omega.push_back(p.omega_rad_s);
    gain.push_back(p.loop_gain);
  }
  if (reliable.size() < 2) return;
  curve.margins = loop_margins(omega, gain);
  if (estimates) curve.bandwidth_rad_s = bandwidth(reliable);
}

// Determines the responses by simulation, with probes of one sample. The loop counts as linear if
// it responds −2 times as strongly to −2 times a random binary force. A pulse must also have the
// same response later, after a Kalman filter's gain has settled.
LoopCurve designed_curve(const AxisOfPlant& axis, const AnalysisOptions& options) {
  const ProbedLoop design = loop_design(axis);
  const double force = options.force_amplitude, noise = options.noise_amplitude;
  LoopCurve curve;
  const auto none = [&curve](const char* reason) {
    curve.reason = reason;
    return curve;
  };
  curve.is_unstable = is_unstable(design);
  if (curve.is_unstable) return none("its response to a pulse grows without bound");
  const std::optional<std::size_t> from = time_invariant_from(design, force);
  if (!from) return none("its response to a pulse depends on the time of the pulse");
  if (!is_linear(design, Probe::force, force, *from) ||
      !is_linear(design, Probe::noise, noise, *from)) {
    return none("not linear at these amplitudes");
  }
  const auto to_force = whole_response(design, Probe::force, force, *from);
  const auto to_noise = whole_response(design, Probe::noise, noise, *from);
  if (!to_force || !to_noise) return none("the loop does not settle");
  const double period_s = axis.task.axis.period_s;
  for (std::size_t i = 0; i < kDesignPoints; ++i) {
    const double omega = frequency(options, i, kDesignPoints);
    curve.points.push_back(point(omega, frequency_response(*to_force, omega, period_s),
                                 frequency_response(*to_noise, omega, period_s)));
  }
  return curve;
}

LoopPoint measured_point(const SineResponse& force, const SineResponse& noise) {
  LoopPoint p = point(force.omega_rad_s, force.gain, noise.gain);
  p.spread = force.spread;
  p.saturated = std::max(force.saturated, noise.saturated);
  return p;
}

// The options with this loop's numbers in place of the defaults.
AnalysisOptions options_of(const AnalysedLoop& loop, AnalysisOptions options) {
  const double nyquist = std::numbers::pi / loop.axis.task.axis.period_s;
  if (!(options.to_rad_s > 0.0)) options.to_rad_s = kShareOfNyquist * nyquist;
  if (!(options.from_rad_s > 0.0 && options.from_rad_s < options.to_rad_s &&
        options.to_rad_s < nyquist)) {
    throw std::invalid_argument(
        fmt::format("{}: frequencies from {:g} to {:g} rad/s: must rise, and stay below the "
                    "Nyquist frequency, {:.4g} rad/s",
                    loop.name.label(), options.from_rad_s, options.to_rad_s, nyquist));
  }
  const AxisSettings& settings = loop.axis.settings();
  if (options.force_amplitude >= settings.force_limit()) {
    throw std::invalid_argument(
        fmt::format("{}: --amplitude: {:g} {}: must be below the drive's "
                    "limit, {:g} {}",
                    loop.name.label(), options.force_amplitude, settings.axis.units.force,
                    settings.force_limit(), settings.axis.units.force));
  }
  if (!(options.force_amplitude > 0.0)) options.force_amplitude = usual_force(settings);
  if (!(options.noise_amplitude > 0.0)) {
    options.noise_amplitude = std::max(kSmallNoise, kNoiseCounts * settings.quantum());
  }
  return options;
}

// How the loop is cut out of its plant, and why a measurement says little about the loop that moves
// freely.
std::vector<std::string> hints(const AxisOfPlant& axis, const AnalysisOptions& options,
                               const LoopCurve& measured) {
  constexpr double kTimesFriction = 3.0, kMuchSaturated = 0.1;
  std::vector<std::string> texts;
  if (has_other_joints(axis)) {
    texts.emplace_back(measured.points.empty()
                           ? "designed with the other joints held"
                           : "designed with the other joints held, measured with them under their "
                             "own controllers, if any");
  }
  if (measured.points.empty()) return texts;
  const AxisSettings& settings = axis.settings();
  const std::string& unit = settings.axis.units.force;
  const double amplitude = options.force_amplitude;
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

LoopMargins loop_margins(const std::vector<double>& omega_rad_s,
                         const std::vector<std::complex<double>>& loop_gain) {
  if (omega_rad_s.size() < 2 || omega_rad_s.size() != loop_gain.size()) {
    throw std::invalid_argument("margins need a loop gain at two frequencies or more");
  }
  LoopMargins margins;
  double phase = 0.0;
  for (std::size_t i = 0; i < omega_rad_s.size(); ++i) {
    const std::complex<double> L = loop_gain[i];
    margins.sensitivity_peak = std::fmax(margins.sensitivity_peak, std::abs(1.0 / (1.0 + L)));
    margins.complementary_peak = std::fmax(margins.complementary_peak, std::abs(L / (1.0 + L)));
    const double before = std::exchange(phase, std::arg(L));
    if (i == 0) continue;
    // Unwraps the phase: nearest to the last one.
    phase += kTurn * std::round((before - phase) / kTurn);
    const double gain_a = std::log(std::abs(loop_gain[i - 1])), gain_b = std::log(std::abs(L));
    if (const auto share = crossing(gain_a, gain_b)) {
      margins.crossover_rad_s =
          std::exp(std::lerp(std::log(omega_rad_s[i - 1]), std::log(omega_rad_s[i]), *share));
      double above =
          std::fmod(std::lerp(before, phase, *share) + kPi, kTurn);  // from −π, in [0, 2π)
      if (above < 0.0) above += kTurn;
      margins.phase_margin_rad =
          std::fmin(margins.phase_margin_rad, std::min(above, kTurn - above));
      margins.delay_margin_s = std::fmin(margins.delay_margin_s, above / margins.crossover_rad_s);
    }
    // All crossings of −π plus whole turns.
    const double turn = kTurn * std::round((std::midpoint(before, phase) + kPi) / kTurn) - kPi;
    if (const auto share = crossing(before - turn, phase - turn)) {
      const double factor = std::exp(-std::lerp(gain_a, gain_b, *share));
      double& margin = factor > 1.0 ? margins.gain_margin : margins.gain_reduction_margin;
      margin = factor > 1.0 ? std::fmin(margin, factor) : std::fmax(margin, factor);
    }
  }
  return margins;
}

bool is_reliable(const LoopPoint& point) {
  constexpr double kMostSpread = 0.2;
  return point.spread <= kMostSpread && std::abs(point.complementary) > 1e-9;
}

std::vector<LoopAnalysis> analyse(const std::vector<AnalysedLoop>& loops,
                                  const AnalysisOptions& options) {
  std::vector<LoopAnalysis> results(loops.size());
  std::vector<AnalysisOptions> own;
  for (const AnalysedLoop& loop : loops) own.push_back(options_of(loop, options));
  on_all_cores(
      loops.size(),
      [&](std::size_t i) {
        results[i].name = loops[i].name;
        const AxisOfPlant& axis = loops[i].axis;
        results[i].estimates = axis.parts->make(axis.task).estimates();
        results[i].designed = designed_curve(axis, own[i]);
      },
      options.jobs);

  // A sine in a loop, with the force or with the noise.
  struct Task {
    std::size_t loop;
    double omega_rad_s;
    Probe probe;
    SineResponse response = {};
  };
  // The lowest frequencies of all loops come first, because they take the longest.
  const auto points = static_cast<std::size_t>(options.points);
  std::vector<Task> tasks;
  std::vector<double> times_s;
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t loop = 0; loop < loops.size(); ++loop) {
      if (results[loop].designed.is_unstable) continue;
      const double omega = frequency(own[loop], i, points);
      for (const Probe probe : {Probe::force, Probe::noise}) {
        constexpr double kPeriods = 4.0;
        tasks.push_back({loop, omega, probe});
        times_s.push_back(options.settle_s + kPeriods * kTurn / omega);
      }
    }
  }
  Progress progress("analyze", times_s, options.quiet);
  on_all_cores(
      tasks.size(),
      [&](std::size_t i) {
        Task& one = tasks[i];
        one.response =
            measure_sine(loops[one.loop].axis, one.probe, one.omega_rad_s, own[one.loop]);
        progress.finish(i);
      },
      options.jobs);
  for (std::size_t i = 0; i < tasks.size(); i += 2) {
    results[tasks[i].loop].measured.points.push_back(
        measured_point(tasks[i].response, tasks[i + 1].response));
  }
  for (std::size_t loop = 0; loop < loops.size(); ++loop) {
    LoopAnalysis& result = results[loop];
    judge(result.designed, result.estimates, false);
    judge(result.measured, result.estimates, true);
    result.hints = hints(loops[loop].axis, own[loop], result.measured);
  }
  return results;
}

}  // namespace breakwater
