#include <breakwater/statistics/student_t.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <breakwater/math/functions.h>

namespace breakwater {

double student_t_cdf(double t, std::size_t degrees) {
  const double root = std::sqrt(static_cast<double>(degrees));
  const double size = std::hypot(t, root);
  const double sine = std::isinf(t) ? std::copysign(1.0, t) : t / size;
  const double cosine = std::isinf(t) ? 0.0 : root / size;
  const bool is_odd = degrees % 2 == 1;
  // Σ of the powers cosᵏ θ with k = 0, 2, … (odd ν: 1, 3, …) up to ν − 2.
  double term = is_odd ? cosine : 1.0, sum = 0.0;
  for (std::size_t k = is_odd ? 1 : 0; k + 2 <= degrees; k += 2) {
    sum += term;
    const auto power = static_cast<double>(k);
    term *= (power + 1.0) / (power + 2.0) * cosine * cosine;
  }
  double inside = sine * sum;  // P(|T| ≤ |t|), with the sign of t
  if (is_odd) inside = 2.0 / std::numbers::pi * (math::atan2(t, root) + inside);
  return std::clamp(0.5 * (1.0 + inside), 0.0, 1.0);
}

}  // namespace breakwater
