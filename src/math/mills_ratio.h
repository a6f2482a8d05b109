// Tail of the normal distribution with the same bits on every x86-64 processor.
#pragma once

namespace breakwater::math {

inline constexpr double kRootTwoPi = 2.50662827463100050242;     ///< √(2π)
inline constexpr double kLogRootTwoPi = 0.91893853320467274178;  ///< ln √(2π)

/// Mills' ratio (1 − Φ(x))/φ(x) of the standard normal distribution, for x ≥ 0. It is about 1/x and
/// finite, even where Φ and φ underflow. Rational approximations of W. J. Cody, Math. Comp. 23
/// (1969) 631–637; relative error below 1e-15.
double mills_ratio(double x);

}  // namespace breakwater::math
