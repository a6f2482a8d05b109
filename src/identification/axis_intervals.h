// 95 % intervals of the parameters of a fitted axis.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <breakwater/identification/axis_fit.h>

namespace breakwater {

inline constexpr double kRoot95 = 1.959963984540054;       ///< normal quantile
inline constexpr double kChiSquare95 = 3.841458820694124;  ///< one degree of freedom

struct ParameterInterval {
  double low = 0.0;
  double high = 0.0;
  std::pair<double, double> highest;  ///< largest value that was tried, and its rise of −2 ln L
  bool is_closed = true;              ///< both ends were found
  bool is_known = true;  ///< the rise is large enough where the parameter counts as unknown
  AxisFit better;        ///< the most likely fit of all, which may be above the given one
};

/// The values of a parameter at which −2 ln L, minimised over the other free ones, has risen by
/// kChiSquare95. If the search does not converge, an end is the farthest value with a smaller rise.
/// A value that cannot be negative ends at 0. If hardly anything rises at the first guess, the
/// search goes on to where the parameter counts as unknown. `std_scaled` is the standard deviation
/// in its scale, the first guess. `slopes` has the changes of the free parameters, in their scales
/// and order, for one of this parameter: where the search for the others begins.
ParameterInterval profile_interval(const AxisData& data, const FreeParameters& free,
                                   const AxisFit& fit, AxisParameter parameter, double std_scaled,
                                   const Eigen::VectorXd& slopes);

/// Standard deviations of the free parameters, in their scales, over fits to simulated records. The
/// fitted axis makes the records without noise, each with another phase of the encoder.
std::vector<double> bootstrap_std(const AxisData& data, const FreeParameters& free,
                                  const AxisFit& fit);

/// Moves a parameter by `change` in its scale. Friction stays at least 0.
double moved_parameter(const AxisData& data, AxisParameter parameter, double value, double change);

/// Moves all free parameters. `changes` has their order and scales.
AxisFit moved_fit(const AxisData& data, const FreeParameters& free, AxisFit fit,
                  const Eigen::VectorXd& changes);

/// The largest power of ten [s] of which all times are multiples. 0 if a double resolves none.
/// 0 too if a regular clock explains the times within half of it: it has no error to fit.
double rounding_step(std::span<const double> times_s);

/// Puts the rounding of the times into the likelihood. Returns whether it counts beside the noise.
///
/// A time has an error that is uniform over one step. It moves a position by the velocity times
/// the error, which is white noise. It also moves a change of the input, which is a small push.
/// Pushes add up: each stretch gets drifts, the principal components of their covariance
/// (Karhunen and Loève). A drift far below the white errors is left out.
bool allow_rounded_times(AxisData& data, const AxisFit& fit);

}  // namespace breakwater
