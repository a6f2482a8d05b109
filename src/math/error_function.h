// Complementary error function, standard normal distribution and its tail, with the same bits on
// every x86-64 processor.
#pragma once

// musl's, renamed (cmake/musl_math.cmake).
extern "C" double breakwater_erfc(double x) noexcept;

namespace breakwater::math {

/// erfc(x) = 1 − erf(x) = 2/√π ∫ₓ^∞ exp(−t²) dt. If the result is a normal number, the error is
/// below 4 units in the last place. Special arguments follow C99's Annex F.
inline double erfc(double x) {
  return breakwater_erfc(x);
}

inline constexpr double kRootTwoPi = 2.50662827463100050242;     ///< √(2π)
inline constexpr double kLogRootTwoPi = 0.91893853320467274178;  ///< ln √(2π)

/// Mills' ratio (1 − Φ(x))/φ(x) of the standard normal distribution, for x ≥ 0. It is about 1/x and
/// finite, even where Φ and φ underflow. Rational approximations of W. J. Cody, Math. Comp. 23
/// (1969) 631–637; relative error below 1e-15.
double mills_ratio(double x);

}  // namespace breakwater::math

namespace breakwater {

/// Φ(z) = erfc(−z/√2)/2, the standard normal distribution. Its quantile is in
/// statistics/distribution.h.
inline double normal_cdf(double z) {
  constexpr double kSqrtHalf = 0.70710678118654752440;
  return 0.5 * math::erfc(-kSqrtHalf * z);
}

}  // namespace breakwater
