// Student's t distribution.
#pragma once

#include <cstddef>

namespace breakwater {

/// P(T ≤ t) of Student's T with ν ≥ 1 degrees of freedom; to 1e-14, and the same bits on every
/// processor. With θ = atan(t/√ν), the finite sums of sin θ and cos θ.
///
/// Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964, 26.7.3, 26.7.4.
double student_t_cdf(double t, std::size_t degrees);

}  // namespace breakwater
