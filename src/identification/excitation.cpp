#include <breakwater/identification/excitation.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/identification/friction_axis.h>
#include <breakwater/math/functions.h>
#include <breakwater/world/noise.h>

namespace breakwater {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kReach_s = 0.2;   // time of a guessed axis to its largest speed
constexpr double kFriction = 0.1;  // share of the torque, each
constexpr double kQuantum = kTurn / 4096.0;
constexpr double kFirst_Hz = 0.1;
constexpr double kLast_Hz = 20.0;
constexpr std::size_t kSines = 24;
constexpr double kClocks_s[] = {0.02, 0.05, 0.1};

FreeParameters fitted() {
  FreeParameters free{};
  for (const AxisParameter p : {kInertia, kViscous, kCoulomb, kOffset, kDelay}) free[p] = true;
  return free;
}

std::size_t rows_of(const ExcitationLimits& limits) {
  return static_cast<std::size_t>(std::round(limits.duration_s / limits.period_s));
}

// The record that the axis would make.
AxisData record_of(const std::vector<double>& inputs, const ExcitationLimits& limits,
                   const AxisValues& axis) {
  AxisData data;
  data.period_s = limits.period_s;
  data.quantum = kQuantum;
  AxisStretch& stretch = data.stretches.emplace_back();
  stretch.inputs = inputs;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    stretch.input_times_s.push_back(static_cast<double>(k) * limits.period_s);
  }
  stretch.times_s = stretch.input_times_s;
  stretch.positions.resize(inputs.size());
  move_axis(axis, {}, stretch, stretch.positions);
  return data;
}

// Scales the input down until the axis keeps the speed.
std::vector<double> within_limits(std::vector<double> inputs, const ExcitationLimits& limits,
                                  const AxisValues& axis) {
  constexpr double kLess = 0.9;
  for (double& u : inputs) u = std::clamp(u, -limits.torque, limits.torque);
  for (;;) {
    const AxisData data = record_of(inputs, limits, axis);
    const std::vector<double>& q = data.stretches.front().positions;
    double fastest = 0.0;
    for (std::size_t k = 1; k < q.size(); ++k) {
      fastest = std::max(fastest, std::abs(q[k] - q[k - 1]) / limits.period_s);
    }
    if (fastest <= limits.speed) return inputs;
    for (double& u : inputs) u *= kLess;
  }
}

// The unknowns of a multisine.
struct Multisine {
  double gain = 1.0;
  double slope = 0.0;  // slope of the amplitudes over the frequency
  std::vector<double> phases;

  std::vector<double> inputs(const ExcitationLimits& limits) const {
    const double last = std::min(kLast_Hz, 0.1 / limits.period_s);
    const double first = std::min(std::max(kFirst_Hz, 2.0 / limits.duration_s), 0.5 * last);
    std::vector<double> omegas, amplitudes;
    double squares = 0.0;
    for (std::size_t i = 0; i < kSines; ++i) {
      const double share = static_cast<double>(i) / (kSines - 1);
      const double frequency = first * math::exp(share * math::log(last / first));
      // Whole periods in the record.
      omegas.push_back(kTurn * std::round(frequency * limits.duration_s) / limits.duration_s);
      amplitudes.push_back(math::exp(-slope * math::log(frequency / first)));
      squares += 0.5 * amplitudes.back() * amplitudes.back();
    }
    std::vector<double> inputs(rows_of(limits));
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      const double t = static_cast<double>(k) * limits.period_s;
      for (std::size_t i = 0; i < kSines; ++i) {
        inputs[k] += amplitudes[i] * math::sin(omegas[i] * t + phases[i]);
      }
      inputs[k] *= gain * limits.torque / std::sqrt(squares);
    }
    return inputs;
  }
};

class Draws {
 public:
  double operator()(double low, double high) {
    return low + (high - low) * noise_.uniform(next_++);
  }

 private:
  Noise noise_{1, "excitation"};
  std::uint64_t next_ = 0;
};

// The least standard deviations of the common inputs.
std::vector<double> common_std(const ExcitationLimits& limits, const AxisValues& axis) {
  std::vector<double> least = expected_std(chirp(limits, axis), limits, axis);
  for (const double clock_s : kClocks_s) {
    const std::vector<double> one =
        expected_std(binary_sequence(limits, axis, clock_s), limits, axis);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], one[i]);
  }
  return least;
}

double ratio_to(const std::vector<double>& common, const std::vector<double>& inputs,
                const ExcitationLimits& limits, const AxisValues& axis) {
  const std::vector<double> std = expected_std(inputs, limits, axis);
  double worst = 0.0;
  for (std::size_t i = 0; i < std.size(); ++i) worst = std::max(worst, std[i] / common[i]);
  return worst;
}

}  // namespace

AxisValues guessed_axis(const ExcitationLimits& limits, double inertia) {
  AxisValues axis{};
  axis[kInertia] = inertia > 0.0 ? inertia : kReach_s * limits.torque / limits.speed;
  const double speed =
      std::isfinite(limits.speed) ? limits.speed : kReach_s * limits.torque / axis[kInertia];
  axis[kViscous] = kFriction * limits.torque / speed;
  axis[kCoulomb] = kFriction * limits.torque;
  axis[kStribeckSpeed] = axis[kTorqueConstant] = 1.0;
  axis[kDelay] = 2.0 * limits.period_s;
  return axis;
}

std::vector<double> chirp(const ExcitationLimits& limits, const AxisValues& axis) {
  std::vector<double> inputs(rows_of(limits));
  const double last = std::min(kLast_Hz, 0.1 / limits.period_s);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const double t = static_cast<double>(k) * limits.period_s;
    const double turns = kFirst_Hz * t + 0.5 * (last - kFirst_Hz) * t * t / limits.duration_s;
    inputs[k] = limits.torque * math::sin(kTurn * turns);
  }
  return within_limits(std::move(inputs), limits, axis);
}

std::vector<double> binary_sequence(const ExcitationLimits& limits, const AxisValues& axis,
                                    double clock_s) {
  std::vector<double> inputs(rows_of(limits));
  const auto hold =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::round(clock_s / limits.period_s)));
  unsigned state = 1;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    // x¹¹ + x⁹ + 1: a sequence of 2047 values.
    if (k % hold == 0) state = (state >> 1) | (((state ^ (state >> 2)) & 1u) << 10);
    inputs[k] = (state & 1u) != 0 ? limits.torque : -limits.torque;
  }
  return within_limits(std::move(inputs), limits, axis);
}

std::vector<double> expected_std(const std::vector<double>& inputs, const ExcitationLimits& limits,
                                 const AxisValues& axis) {
  const AxisData data = record_of(inputs, limits, axis);
  const AxisFit fit{.values = axis, .starts = {{}}, .noise_std = 0.5 * kQuantum};
  const FreeParameters free = fitted();
  const Eigen::MatrixXd covariance = covariance_of(data, free, fit);
  // Inputs of different size have different scales.
  const AxisValues scales = parameter_scales(data);
  std::vector<double> stds;
  Eigen::Index n = 0;
  for (std::size_t p = 0; p < kAxisParameters; ++p) {
    if (!free[p]) continue;
    stds.push_back(std::sqrt(covariance(n, n)) * scales[p]);
    ++n;
  }
  return stds;
}

double worst_ratio(const std::vector<double>& inputs, const ExcitationLimits& limits,
                   const AxisValues& axis) {
  return ratio_to(common_std(limits, axis), inputs, limits, axis);
}

std::vector<double> designed_excitation(const ExcitationLimits& limits, const AxisValues& axis,
                                        int tries) {
  const std::vector<double> common = common_std(limits, axis);
  Draws draw;
  Multisine best;
  std::vector<double> best_inputs;
  double least = std::numeric_limits<double>::infinity();
  for (int n = 0; n < tries; ++n) {
    Multisine one = best;
    if (n < tries / 3) {
      one.gain = math::exp(draw(-1.0, 2.0));
      one.slope = draw(-0.5, 1.5);
      one.phases.assign(kSines, 0.0);
      for (double& phase : one.phases) phase = draw(0.0, kTurn);
    } else {
      one.gain *= math::exp(draw(-0.2, 0.2));
      one.slope += draw(-0.1, 0.1);
      for (double& phase : one.phases) phase += draw(-0.3, 0.3);
    }
    std::vector<double> inputs = within_limits(one.inputs(limits), limits, axis);
    const double ratio = ratio_to(common, inputs, limits, axis);
    if (ratio >= least) continue;
    least = ratio;
    best = one;
    best_inputs = std::move(inputs);
  }
  return best_inputs;
}

}  // namespace breakwater
