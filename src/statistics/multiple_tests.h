// Tests of several hypotheses together.
#pragma once

#include <vector>

namespace breakwater {

/// Holm's adjusted p: with p₍₁₎ ≤ … ≤ p₍ₘ₎,  p'₍ᵢ₎ = max_{j ≤ i} min(1, (m − j + 1) p₍ⱼ₎). A
/// rejection where p' ≤ α gives any false rejection with probability α at most, for any dependence.
///
/// Source: S. Holm, Scand. J. Statist. 6 (1979) 65–70.
std::vector<double> holm(const std::vector<double>& p);

/// The levels at which Holm's procedure decides the tests: with r rejections, α/(m − i + 1) for the
/// rejected p₍ᵢ₎, equal ones like the first of them, and α/(m − r) for the others. p ≤ its level exactly where p' ≤ α. So an interval
/// that belongs to the test has this level, and covers with probability 1 − α or more.
std::vector<double> holm_levels(const std::vector<double>& p, double alpha);

}  // namespace breakwater
