"""SciPy's tests and intervals. Input: problems with a name and numbers. Output: numbers.

binomial n p                     P(X <= 0) ... P(X <= n)
mcnemar b c                      exact, two-sided
wilcoxon n d...                  exact p, of differences without ties and zeros
signed_rank alpha n d...         the pseudo-median, and the interval of the values that the exact test keeps
approximate n d...               p by the normal approximation
share level k n                  the exact interval of a share
"""

import numpy as np
import scipy.stats

from problems import answer, integer, numbers


def binomial():
    n, p = integer(), numbers(1)[0]
    return scipy.stats.binom(n, p).cdf(np.arange(n + 1))


def mcnemar():
    b, c = integer(), integer()
    return [scipy.stats.binomtest(b, b + c, 0.5).pvalue]


def wilcoxon():
    return [scipy.stats.wilcoxon(numbers(integer()), mode="exact").pvalue]


def signed_rank():
    """Invert the test: its p changes at the Walsh averages alone."""
    alpha = numbers(1)[0]
    d = numbers(integer())
    first, second = np.triu_indices(len(d))
    averages = np.sort((d[first] + d[second]) / 2)
    between = (averages[:-1] + averages[1:]) / 2
    inside = [i for i, at in enumerate(between) if scipy.stats.wilcoxon(d - at, mode="exact").pvalue > alpha]
    return [np.median(averages), averages[inside[0]], averages[inside[-1] + 1]]


def approximate():
    return [scipy.stats.wilcoxon(numbers(integer()), correction=True, mode="approx").pvalue]


def share():
    level = numbers(1)[0]
    interval = scipy.stats.binomtest(integer(), integer()).proportion_ci(level, method="exact")
    return [interval.low, interval.high]


answer(binomial, mcnemar, wilcoxon, signed_rank, approximate, share)
