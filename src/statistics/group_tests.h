// Tests on grouped values: variance between groups and change of sign.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace breakwater {

/// P(T ≤ t) of Student's T with ν ≥ 1 degrees of freedom, from finite sums of sin θ and cos θ with
/// θ = atan(t/√ν). The error is below 1e-14. The bits are the same on every processor.
///
/// Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964, 26.7.3, 26.7.4.
double student_t_cdf(double t, std::size_t degrees);

using Groups = std::vector<std::vector<double>>;

/// The share of the variance that lies between groups: the intraclass correlation of the one-way
/// random-effects model. For k groups of n_g ≥ 1 values, N in total:
///     σ_b² = max(0, (MS_b − MS_w)/n₀),  n₀ = (N − Σ n_g²/N)/(k − 1)
///     share = σ_b²/(σ_b² + MS_w)
/// with the mean squares MS_b between and MS_w within groups. Empty groups do not count. Nothing if
/// no group has two values, there are fewer than two groups, or the values differ only by rounding.
///
/// Source: A. Donner, Int. Statist. Rev. 54 (1986) 67–82, section 2.
std::optional<double> share_between(const Groups& groups);

/// Tests whether a difference is negative in one group and positive in another one (a qualitative
/// or crossover interaction). The hypothesis is that all means μ_g ≥ 0, or all μ_g ≤ 0. Each of G
/// groups has n_g ≥ 2 values with mean m_g:
///     t_g = m_g √n_g/s_g,  s_g² the larger of the group's variance and of that pooled over all
///     p₋ = G min_g P(T ≤ t_g),  p₊ = G min_g P(T ≥ t_g),  T Student's with n_g − 1 degrees
///     p = min(1, max(p₋, p₊))
/// Bonferroni's factor G holds even if the groups depend on each other, for example by common
/// seeds. Both halves must be rejected, so neither needs a further factor. Groups of one value do
/// not count. Returns 1 if fewer than two groups count.
///
/// Sources: M. Gail, R. Simon, Biometrics 41 (1985) 361–372 (the hypothesis); S. Piantadosi, M. H.
/// Gail, Statist. Med. 12 (1993) 1239–1248 (by the extreme t); R. L. Berger, Technometrics 24
/// (1982) 295–300 (both halves).
double sign_turn_p(const Groups& groups);

}  // namespace breakwater
