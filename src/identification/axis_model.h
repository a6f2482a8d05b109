// Plants whose parameters a fit to records finds.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <breakwater/plants/motor_and_load.h>
#include <breakwater/signals/encoder_rounding.h>

namespace breakwater {

/// Parameters of an axis in SI units (N m and rad, or N and m). Each model has some of them.
enum AxisParameter : std::size_t {
  kInertia,
  kViscous,
  kCoulomb,
  kBreakaway,      ///< friction at v = 0 beyond the Coulomb friction (Stribeck)
  kStribeckSpeed,  ///< v_s
  kMotorInertia,
  kLoadInertia,
  kStiffness,
  kDamping,
  kBacklash,
  kMotorViscous,
  kLoadViscous,
  kMotorCoulomb,
  kLoadCoulomb,
  kOffset,
  kDelay,
  kTorqueConstant,  ///< scale of the recorded input
  kAxisParameters
};
using AxisValues = std::array<double, kAxisParameters>;

/// A part of a record without a long gap. Input i acts from input_times_s[i] to the next of these
/// times, and the last one until the end.
struct AxisStretch {
  std::vector<double> input_times_s;
  std::vector<double> inputs;
  std::vector<double> times_s;  ///< times of the positions; the first is that of the initial state
  std::vector<double> positions;  ///< as measured
  double time_step_s = 0.0;       ///< to which the table rounds jittering times; 0: not rounded
  /// Motions of independent normal size that this rounding adds (axis_intervals.h), one a column.
  Eigen::MatrixXd drifts;
  /// Standard deviations of the positions by the same rounding of their own times. Empty: 0.
  std::vector<double> time_noise;

  /// The standard deviation of row k with this noise before the encoder.
  double noise_at(std::size_t k, double noise_std) const {
    return time_noise.empty() ? noise_std : std::hypot(noise_std, time_noise[k]);
  }
};

/// The state at the beginning of a stretch. A model uses the first `start_values` of the numbers.
struct AxisStart {
  double position = 0.0;
  double velocity = 0.0;
  double twist = 0.0;  ///< that of a second inertia
  double twist_rate = 0.0;
  Eigen::VectorXd drifts;  ///< sizes of the stretch's drifts; empty: 0
};
inline constexpr std::array<double AxisStart::*, 4> kStartParts = {
    &AxisStart::position, &AxisStart::velocity, &AxisStart::twist, &AxisStart::twist_rate};

struct AxisData;

/// A plant as the fit sees it.
struct AxisModel {
  std::vector<AxisParameter> parameters;  ///< found by a fit
  AxisParameter known_inertia;            ///< which one a user may know
  std::size_t start_values;               ///< numbers of a start: 2 for each inertia
  bool has_backlash;                      ///< kBacklash is fitted if the records show it
  /// Moves the plant from a start. `positions` gets the measured one at each of stretch.times_s.
  /// The motion does not depend on the position of the start.
  void (*move)(const AxisValues& parameters, const AxisStart& start, const AxisStretch& stretch,
               std::span<double> positions);
  /// First values of a fit by linear least squares, with a delay between the bounds of the data.
  std::vector<AxisValues> (*candidates)(const AxisData& data);
};

/// One inertia,
///     J v̇ = k u(t − τ) − d₀ − c v − sgn(v) (F_C + F_B exp(−(v/v_s)²)),   q̇ = v,
/// from event to event: changes of the input, of the sign of v, and of stick to slip. The axis
/// sticks at v = 0 while |k u − d₀| ≤ F_C + F_B. With F_B = 0 its motion is exact. Otherwise it is
/// a Taylor polynomial, in steps whose last terms are below 1e-12 v_s.
///
/// Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083–1138,
/// Eqs. 3 and 7.
const AxisModel& friction_axis();

/// A motor and a load with a spring, backlash and friction. The plant of the scenario two_inertia
/// with the ratio 1,
///     J_m v̇_m = k u(t − τ) − d₀ − c_m v_m − F_m sgn(v_m) − T,   q̇_m = v_m,
///     J_l v̇_l = T − c_l v_l − F_l sgn(v_l),                      q̇_l = v_l,
/// with the torque T of sim/transmission.h. Beyond a play b, T = K z + D (v_m − v_l) and never
/// pulls. Without a play, T = K (q_m − q_l) + D (v_m − v_l). Each side sticks at v = 0 while the
/// torques on it are at most its Coulomb friction.
///
/// Between events (reversal, stick, slip, contact of a flank) a Taylor polynomial moves it, with an
/// error below 1e-9 of a step. The motor or the load has the encoder. Its position is NaN if more
/// than 100 steps a row are needed. The twist of a start is q_m − q_l.
const AxisModel& two_inertia_axis(Side measured);

/// Records of one axis with one encoder, and the model that explains them.
struct AxisData {
  const AxisModel* model = &friction_axis();
  std::vector<AxisStretch> stretches;
  double period_s = 0.0;
  double quantum = 0.0;  ///< Δ; 0: not quantised
  EncoderRounding rounding = EncoderRounding::nearest;
  double least_delay_s = -std::numeric_limits<double>::infinity();  ///< bounds of a fitted delay
  double largest_delay_s = std::numeric_limits<double>::infinity();

  std::size_t rows() const;
};

/// How a fit moves a parameter.
enum class ParameterScale {
  plain,
  positive,    ///< at least 0: friction, damping or backlash
  logarithmic  ///< positive, and scaled by its own size
};

/// A parameter of a rotation.
struct KnownParameter {
  AxisParameter parameter;
  ParameterScale scale;
  bool is_torque;    ///< it is proportional to the unit of the torque
  const char* key;   ///< "inertia_kgm2"
  const char* unit;  ///< "kg m^2"
  const char* name;
  double largest_std;      ///< limit for an identifiable parameter, in its scale
  const char* excitation;  ///< input that shows it
};

const KnownParameter& known_parameter(AxisParameter parameter);

inline const char* parameter_key(AxisParameter parameter) {
  return known_parameter(parameter).key;
}
inline bool is_positive(AxisParameter parameter) {
  return known_parameter(parameter).scale == ParameterScale::positive;
}
inline bool is_logarithmic(AxisParameter parameter) {
  return known_parameter(parameter).scale == ParameterScale::logarithmic;
}

/// Moves `motion` through a stretch, from one change of the delayed input or row to the next:
/// motion.advance(h, input), then motion.position().
template <typename Motion>
void follow(const AxisStretch& stretch, double delay, Motion motion, std::span<double> positions) {
  const std::vector<double>& changes = stretch.input_times_s;
  double now = stretch.times_s.front();
  positions.front() = motion.position();
  // The input that acts at the beginning. The first one also acts before its time.
  std::size_t i = static_cast<std::size_t>(
      std::upper_bound(changes.begin(), changes.end(), now - delay) - changes.begin());
  i = std::max<std::size_t>(i, 1) - 1;
  for (std::size_t k = 1; k < stretch.times_s.size(); ++k) {
    const double end = stretch.times_s[k];
    while (i + 1 < changes.size() && changes[i + 1] + delay < end) {
      const double change = changes[i + 1] + delay;
      if (change > now) {
        motion.advance(change - now, stretch.inputs[i]);
        now = change;
      }
      ++i;
    }
    motion.advance(end - now, stretch.inputs[i]);
    now = end;
    positions[k] = motion.position();
  }
}

/// Coefficients of a position over the time.
inline constexpr std::size_t kOrder = 10;
using Polynomial = std::array<double, kOrder + 1>;

inline double value_at(const Polynomial& p, double t) {
  double value = p[kOrder];
  for (std::size_t k = kOrder; k-- > 0;) value = value * t + p[k];
  return value;
}

inline double slope_at(const Polynomial& p, double t) {
  double slope = kOrder * p[kOrder];
  for (std::size_t k = kOrder; k-- > 1;) slope = slope * t + static_cast<double>(k) * p[k];
  return slope;
}

/// The time in (0, h] at which g falls below 0; g(h) < 0.
template <typename Function>
double time_of(const Function& g, double h) {
  constexpr double kShortest = 1e-3;    // relative to h
  constexpr double kTolerance = 1e-13;  // relative to h
  double from = 0.0, at_from = g(from);
  if (!(at_from > 0.0)) {
    from = kShortest * h;
    at_from = g(from);
    if (!(at_from > 0.0)) return from;
  }
  const double at_h = g(h);
  if (!(at_h < 0.0)) return h;
  std::uintmax_t trials = 60;
  const auto is_close = [h](double a, double b) { return b - a <= kTolerance * h; };
  return boost::math::tools::toms748_solve(g, from, h, at_from, at_h, is_close, trials).second;
}

}  // namespace breakwater
