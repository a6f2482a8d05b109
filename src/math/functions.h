// Elementary functions with the same bits on every x86-64 processor.
#pragma once

#include <cmath>
#include <complex>

// musl's functions, renamed (cmake/musl_math.cmake). Unlike those of <cmath>, they never set errno.
extern "C" {
double breakwater_sin(double x) noexcept;
double breakwater_cos(double x) noexcept;
void breakwater_sincos(double x, double* sine, double* cosine) noexcept;
double breakwater_tan(double x) noexcept;
double breakwater_asin(double x) noexcept;
double breakwater_acos(double x) noexcept;
double breakwater_atan2(double y, double x) noexcept;
double breakwater_exp(double x) noexcept;
double breakwater_expm1(double x) noexcept;
double breakwater_log(double x) noexcept;
double breakwater_pow(double base, double exponent) noexcept;
double breakwater_tanh(double x) noexcept;
}

/// glibc selects its functions by processor, with or without fused multiply-add, and the results
/// differ in the last bit. Code that affects a simulation's state uses these functions. sqrt,
/// hypot, floor, round, fma, remainder, ldexp and similar ones are the same everywhere in <cmath>.
/// Angles are in radians. Errors are below one unit in the last place (atan2: 1.5, tanh: 2.5).
/// Special arguments follow C99's Annex F.
namespace breakwater::math {

inline constexpr auto& sin = breakwater_sin;
inline constexpr auto& cos = breakwater_cos;
inline constexpr auto& tan = breakwater_tan;
inline constexpr auto& asin = breakwater_asin;
inline constexpr auto& acos = breakwater_acos;
inline constexpr auto& atan2 = breakwater_atan2;
inline constexpr auto& expm1 = breakwater_expm1;
inline constexpr auto& pow = breakwater_pow;
inline constexpr auto& tanh = breakwater_tanh;

struct SineCosine {
  double sine;
  double cosine;
};

/// Both at little more than the cost of one; the same bits as sin() and cos().
inline SineCosine sincos(double x) {
  SineCosine both;
  breakwater_sincos(x, &both.sine, &both.cosine);
  return both;
}
inline double exp(double x) {
  return breakwater_exp(x);
}
inline double log(double x) {
  return breakwater_log(x);
}

inline std::complex<double> exp(const std::complex<double>& z) {
  const double size = exp(z.real());
  if (z.imag() == 0.0) return {size, z.imag()};
  const SineCosine turn = sincos(z.imag());
  return {size * turn.cosine, size * turn.sine};
}
/// The principal value: the imaginary part is within ±π.
inline std::complex<double> log(const std::complex<double>& z) {
  return {log(std::abs(z)), atan2(z.imag(), z.real())};
}

/// The power of two that scales x > 0 to [1, 2), and 1 for any other x. A product with it keeps the
/// bits.
inline double power_of_two_scale(double x) {
  return x > 0.0 ? std::ldexp(1.0, -std::ilogb(x)) : 1.0;
}

}  // namespace breakwater::math
