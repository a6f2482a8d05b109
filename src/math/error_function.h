// Complementary error function with the same bits on every x86-64 processor.
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
