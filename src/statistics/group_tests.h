// Values in groups: how they vary, and whether their sign turns.
#pragma once

#include <optional>
#include <vector>

namespace breakwater {

using Groups = std::vector<std::vector<double>>;

/// The share of variance that lies between groups, the intraclass correlation of the one-way model
/// of random effects, from k groups of n_g ≥ 1 values, N in all:
///     σ_b² = max(0, (MS_b − MS_w)/n₀),  n₀ = (N − Σ n_g²/N)/(k − 1)
///     share = σ_b²/(σ_b² + MS_w)
/// with the mean squares MS_b between and MS_w within. Empty groups do not count. Nothing where no
/// group has two values, there are fewer than two groups, or nothing varies but
/// for rounding.
///
/// Source: A. Donner, Int. Statist. Rev. 54 (1986) 67–82, section 2.
std::optional<double> share_between(const Groups& groups);

/// Whether a difference is negative in one group and positive in another (a qualitative, or
/// crossover, interaction). The hypothesis: all means μ_g ≥ 0, or all μ_g ≤ 0. G groups have
/// n_g ≥ 2 values each, with mean m_g:
///     t_g = m_g √n_g/s_g,  s_g² the larger of the group's variance and of that pooled over all
///     p₋ = G min_g P(T ≤ t_g),  p₊ = G min_g P(T ≥ t_g),  T Student's with n_g − 1 degrees
///     p = min(1, max(p₋, p₊))
/// Bonferroni's G holds whatever groups have in common (their seeds, say); both halves must be
/// rejected, so neither needs more. Groups of fewer values do not count; 1 where fewer than two do.
///
/// Sources: M. Gail, R. Simon, Biometrics 41 (1985) 361–372 (the hypothesis); S. Piantadosi, M. H.
/// Gail, Statist. Med. 12 (1993) 1239–1248 (by the extreme t); R. L. Berger, Technometrics 24
/// (1982) 295–300 (both halves).
double sign_turn_p(const Groups& groups);

}  // namespace breakwater
