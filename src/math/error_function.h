// Complementary error function and standard normal distribution with the same bits on every x86-64
// processor.
#pragma once

// musl's, renamed (cmake/musl_math.cmake).
extern "C" double breakwater_erfc(double x) noexcept;

namespace breakwater::math {

/// erfc(x) = 1 − erf(x) = 2/√π ∫ₓ^∞ exp(−t²) dt. If the result is a normal number, the error is
/// below 4 units in the last place. Special arguments follow C99's Annex F.
inline double erfc(double x) {
  return breakwater_erfc(x);
}

}  // namespace breakwater::math

namespace breakwater {

/// Φ(z) = erfc(−z/√2)/2, the standard normal distribution. Its quantile is in
/// statistics/distribution.h.
inline double normal_cdf(double z) {
  constexpr double kSqrtHalf = 0.70710678118654752440;
  return 0.5 * math::erfc(-kSqrtHalf * z);
}

}  // namespace breakwater
