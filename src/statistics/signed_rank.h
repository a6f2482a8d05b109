// Ranks of a sample, and Wilcoxon's signed-rank test.
#pragma once

#include <cstddef>
#include <vector>

namespace breakwater {

/// The rank of each value, 1 for the smallest; equal values share the mean of their ranks.
std::vector<double> mid_ranks(const std::vector<double>& values);

struct SignedRank {
  double statistic = 0.0;   ///< W₊
  double p = 1.0;           ///< two-sided
  std::size_t nonzero = 0;  ///< number of nonzero differences
  bool is_exact = true;
};

/// Tests whether the differences d of pairs are symmetric about zero. All |d| are ranked. Equal
/// ones share the mean of their ranks. Then zeros drop out (Pratt):
///     W₊ = Σ_{d > 0} r
/// Under the hypothesis each sign is + or − with probability 1/2, for any |d|. For up to 200
/// nonzero differences p is exact, from the distribution of W₊ over all signs with these ranks and
/// ties. For more it is from the normal distribution with mean Σr/2, variance Σr²/4 and a
/// continuity correction of 1/2. p = min(1, 2 min(P(W₊ ≤ w), P(W₊ ≥ w))).
///
/// Sources: F. Wilcoxon, Biometrics Bull. 1 (1945) 80–83; J. W. Pratt, J. Amer. Statist. Assoc. 54
/// (1959) 655–667.
SignedRank signed_rank_test(const std::vector<double>& differences);

}  // namespace breakwater
