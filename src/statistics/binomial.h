// The binomial distribution, and what follows from it alone.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <breakwater/statistics/confidence_interval.h>

namespace breakwater {

/// P(X ≤ 0) … P(X ≤ n) of a binomial X: n ≥ 1 trials, each a success with probability p, 0 < p < 1;
/// to 1e-11, and the same bits on every processor.
std::vector<double> binomial_cdf(std::size_t n, double p);

/// An interval of the p-quantile of a continuous distribution from a sorted sample x₁ ≤ … ≤ x_n:
///     [x_l, x_u],  l the largest, u the smallest with P(X < l) ≤ (1 − level)/2,
///                                                     P(X ≥ u) ≤ (1 − level)/2,  X ~ Bin(n, p)
/// It covers with at least `level`, whatever the distribution. Empty if the sample is too small for
/// either end: five values or fewer for a median at 95 %.
///
/// Source: H. A. David, H. N. Nagaraja, Order Statistics, 3rd ed., 2003, section 7.1.
std::optional<ConfidenceInterval> quantile_interval(const std::vector<double>& sorted, double p,
                                                    double level);

/// McNemar's exact test: of pairs of which one alone failed, `first` the one and `second` the
/// other. The two-sided p of first ~ Bin(first + second, 1/2); 1 if there are none.
///
/// Source: Q. McNemar, Psychometrika 12 (1947) 153–157, with the exact distribution.
double mcnemar_exact(std::size_t first, std::size_t second);

}  // namespace breakwater
