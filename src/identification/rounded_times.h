// Effects of a table's rounded times on a simulated motion.
#pragma once

#include <span>

#include <breakwater/identification/axis_fit.h>

namespace breakwater {

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
