#include <breakwater/math/error_function.h>

#include <breakwater/math/functions.h>

namespace breakwater::math {
namespace {

// Horner's scheme, from the highest power.
template <int n>
double polynomial(const double (&coefficients)[n], double x) {
  double value = coefficients[0];
  for (int i = 1; i < n; ++i) value = value * x + coefficients[i];
  return value;
}

// (Φ(x) − ½)/x as a function of x².
double central(double x_squared) {
  constexpr double a[] = {0.065682337918207449113, 2.2352520354606839287, 161.02823106855587881,
                          1067.6894854603709582, 18154.981253343561249};
  constexpr double b[] = {1.0, 47.20258190468824187, 976.09855173777669322, 10260.932208618978205,
                          45507.789335026729956};
  return polynomial(a, x_squared) / polynomial(b, x_squared);
}

// Mills' ratio divided by √(2π).
double middle(double x) {
  constexpr double c[] = {1.0765576773720192317e-8, .39894151208813466764, 8.8831497943883759412,
                          93.506656132177855979,    597.27027639480026226, 2494.5375852903726711,
                          6848.1904505362823326,    11602.651437647350124, 9842.7148383839780218};
  constexpr double d[] = {1.0,
                          22.266688044328115691,
                          235.38790178262499861,
                          1519.377599407554805,
                          6485.558298266760755,
                          18615.571640885098091,
                          34900.952721145977266,
                          38912.003286093271411,
                          19685.429676859990727};
  return polynomial(c, x) / polynomial(d, x);
}

double far(double x) {
  constexpr double p[] = {.02307344176494017303, .21589853405795699,     .1274011611602473639,
                          .022235277870649807,   .001421619193227893466, 2.9112874951168792e-5};
  constexpr double q[] = {1.0,
                          1.28426009614491121,
                          .468238212480865118,
                          .0659881378689285515,
                          .00378239633202758244,
                          7.29751555083966205e-5};
  const double z = 1.0 / (x * x);
  return (1.0 / kRootTwoPi - z * polynomial(p, z) / polynomial(q, z)) / x;
}

}  // namespace

double mills_ratio(double x) {
  constexpr double kCentral = 0.67448975;
  constexpr double kMiddle = 5.656854249492380195;
  if (x < kCentral) return kRootTwoPi * math::exp(0.5 * x * x) * (0.5 - x * central(x * x));
  return kRootTwoPi * (x < kMiddle ? middle(x) : far(x));
}

}  // namespace breakwater::math
