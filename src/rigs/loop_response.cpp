#include <breakwater/rigs/loop_response.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

#include <breakwater/control/controller.h>
#include <breakwater/math/functions.h>
#include <breakwater/world/delay_line.h>

namespace breakwater {
namespace {

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
constexpr Eigen::Index kCommand = 0;  // its row in a response

struct ProbeSequence {
  Probe probe = Probe::force;
  std::size_t from = 0;
  std::vector<double> values;

  double at(Probe of, std::size_t k) const {
    return of == probe && k >= from && k - from < values.size() ? values[k - from] : 0.0;
  }
};

PulseResponse run(const AxisLoopDesign& design, const ProbeSequence& probe, std::size_t samples) {
  const AxisLoop loop = design.parts->make(design.task);
  Eigen::VectorXd x = design.start_state;
  DelayLine measured(design.delay_samples), command(design.command_delay_samples);
  command.update(0.0);  // the drive's force before the first command
  const bool has_full_state = design.task.senses_true_state;
  const Eigen::Index entries = has_full_state ? 3 : 1;
  Sample sample{0.0, Eigen::VectorXd::Zero(entries + (design.task.force.is_there() ? 2 : 0))};
  Eigen::VectorXd u = Eigen::VectorXd::Zero(1);
  const auto sense = [&](std::size_t k) {
    sample.time_s = static_cast<double>(k) * design.task.axis.period_s;
    sample.y(0) = measured.update((design.plant.C * x)(0) + probe.at(Probe::noise, k));
    if (has_full_state) sample.y.segment<2>(1) = x.head<2>();
  };
  PulseResponse out = PulseResponse::Zero(3, static_cast<Eigen::Index>(samples));
  for (std::size_t k = 0; k < samples; ++k) {
    sense(k);
    if (k == 0) loop.controller->reset(sample);
    loop.controller->update(sample, u);
    const auto column = static_cast<Eigen::Index>(k);
    out(kCommand, column) = u(0);
    if (loop.estimates()) {
      out(1, column) = loop.estimator->disturbance()(0);
      out(2, column) = loop.estimator->state()(1);
    }
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

// A random binary sequence (Marsaglia's xorshift).
std::vector<double> binary_pattern(double amplitude) {
  std::vector<double> values(kPattern);
  std::uint32_t state = 2463534242U;
  for (double& value : values) {
    state ^= state << 13U;
    state ^= state >> 17U;
    state ^= state << 5U;
    value = (state >> 31U) != 0 ? amplitude : -amplitude;
  }
  return values;
}

PulseResponse to_pulse(const AxisLoopDesign& design, Probe probe, double size, std::size_t from,
                       std::size_t length) {
  return difference(run(design, {probe, from, {size}}, from + length),
                    run(design, {}, from + length), from, 1.0 / size);
}

bool is_linear(const AxisLoopDesign& design, Probe probe, double size, std::size_t from) {
  const std::size_t samples = from + 2 * kPattern;
  const PulseResponse rest = run(design, {}, samples);
  const PulseResponse once = run(design, {probe, from, binary_pattern(size)}, samples);
  const PulseResponse twice = run(design, {probe, from, binary_pattern(-2.0 * size)}, samples);
  return are_same(difference(once, rest, from, -2.0), difference(twice, rest, from, 1.0));
}

// The first sample from which the response to a pulse does not change with time, if there is one.
std::optional<std::size_t> time_invariant_from(const AxisLoopDesign& design, double force) {
  for (const std::size_t from : kWarmUps) {
    if (are_same(to_pulse(design, Probe::force, force, from, kFirstLength),
                 to_pulse(design, Probe::force, force, from + kLater, kFirstLength))) {
      return from;
    }
  }
  return std::nullopt;
}

// Nothing if the response does not end.
std::optional<PulseResponse> whole_response(const AxisLoopDesign& design, Probe probe, double size,
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

}  // namespace

Phasors frequency_response(const PulseResponse& pulses, double omega_rad_s, double period_s) {
  const std::complex<double> back(math::cos(omega_rad_s * period_s),
                                  -math::sin(omega_rad_s * period_s));
  Phasors result{};
  // Horner's rule in z⁻¹. The three sums do not wait for each other.
  for (Eigen::Index k = pulses.cols(); k-- > 0;) {
    result.command = result.command * back + pulses(0, k);
    result.disturbance = result.disturbance * back + pulses(1, k);
    result.velocity = result.velocity * back + pulses(2, k);
  }
  return result;
}

AxisLoopDesign axis_loop_design(const AxisParts& parts, const AxisTask& task,
                                const AxisPlant& plant, std::size_t index) {
  const AxisSettings& axis = plant.axes[index];
  const TransmissionSettings& transmission = axis.transmission;
  const StateSpace linear = linear_axis(plant, index);
  const StateSpace driven = behind(axis.drive.electric(), linear);
  const double period_s = task.axis.period_s;
  const double periods = plant.timing.delays().mean_s() / period_s;
  const double whole = std::floor(periods + kWhole), part = periods - whole;
  AxisLoopDesign design{&parts,
                        task,
                        part > kWhole ? hold_late(driven, period_s, part * period_s)
                                      : zero_order_hold(driven, period_s),
                        {},
                        axis.delay_samples,
                        static_cast<int>(whole),
                        usual_force(axis)};
  const Eigen::Vector2d start(axis.reference.before + axis.start_position, axis.start_velocity);
  design.start_state.setZero(design.plant.states());
  design.start_state.head<2>() = start * transmission.measured_ratio();
  if (linear.states() == 4) {
    const bool is_load_other = transmission.measured == Side::motor;
    design.start_state.segment<2>(2) = start * (is_load_other ? 1.0 : transmission.design.ratio);
  }
  return design;
}

bool has_other_joints(const AxisPlant& plant, std::size_t axis) {
  return plant.load_model()->nv > (plant.axes[axis].transmission.is_elastic() ? 2 : 1);
}

double usual_force(const AxisSettings& axis) {
  return std::min(1.0, 0.1 * axis.force_limit());
}

bool is_unstable(const AxisLoopDesign& design) {
  // The response begins after the delays.
  const auto delays = static_cast<std::size_t>(design.delay_samples) +
                      static_cast<std::size_t>(design.command_delay_samples);
  std::size_t first = kFirstLength;
  while (first < 16 * delays) first *= 4;
  const auto command = [&](double force, std::size_t length) -> Eigen::RowVectorXd {
    return to_pulse(design, Probe::force, force, 0, length).row(kCommand);
  };
  for (std::size_t length = first;; length *= 4) {
    const Eigen::RowVectorXd response = command(design.force, length);
    const Eigen::Index quarter = response.size() / 4;
    const double before = largest(response.segment(2 * quarter, quarter));
    const double last = largest(response.tail(quarter));
    if (!std::isfinite(last) || last > kFar * largest(response.head(3 * quarter))) return true;
    if (has_decayed(response)) return false;
    if (length < kLongestJudged) continue;
    // A loop that is not linear has no eigenvalues.
    const auto begin = static_cast<Eigen::Index>(first);
    return is_same(command(-2.0 * design.force, first), response.head(begin)) &&
           (last > (1.0 + kRounding) * before ||
            (last > (1.0 - kRounding) * before && last > largest(response.head(begin / 4))));
  }
}

LoopResponseOrReason loop_response(const AxisLoopDesign& design, double force, double noise) {
  if (is_unstable(design)) return {{}, "its response to a pulse grows without bound", true};
  const std::optional<std::size_t> from = time_invariant_from(design, force);
  if (!from) return {{}, "its response to a pulse depends on the time of the pulse"};
  if (!is_linear(design, Probe::force, force, *from) ||
      !is_linear(design, Probe::noise, noise, *from)) {
    return {{}, "not linear at these amplitudes"};
  }
  std::optional<PulseResponse> to_force = whole_response(design, Probe::force, force, *from);
  std::optional<PulseResponse> to_noise = whole_response(design, Probe::noise, noise, *from);
  if (!to_force || !to_noise) return {{}, "the loop does not settle"};
  return {LoopResponse{std::move(*to_force), std::move(*to_noise)}, ""};
}

}  // namespace breakwater
