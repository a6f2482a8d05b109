// Wilcoxon's signed-rank test.
#pragma once

#include <cstddef>
#include <vector>

namespace breakwater {

struct SignedRank {
  double statistic = 0.0;   ///< W₊
  double p = 1.0;           ///< two-sided
  std::size_t nonzero = 0;  ///< differences that count
  bool is_exact = true;
};

/// Whether the differences d of pairs lie symmetrically about zero. |d| are ranked, zeros too;
/// equal ones share the mean of their ranks; zeros then drop out (Pratt):
///     W₊ = Σ_{d > 0} r
/// Under the hypothesis each sign is + or − with probability 1/2 whatever |d| is. Up to 200
/// differences that are not zero p is exact, from the distribution of W₊ over all signs, these very
/// ranks given, ties included; beyond, from the normal distribution with the mean Σr/2 and the
/// variance Σr²/4, and a correction of 1/2 for continuity. p = min(1, 2 min(P(W₊ ≤ w), P(W₊ ≥ w))).
///
/// Sources: F. Wilcoxon, Biometrics Bull. 1 (1945) 80–83; J. W. Pratt, J. Amer. Statist. Assoc. 54
/// (1959) 655–667.
SignedRank signed_rank_test(const std::vector<double>& differences);

}  // namespace breakwater
