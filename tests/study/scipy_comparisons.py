"""SciPy's tests and intervals. Input: problems with a name and numbers. Output: numbers.

binomial n p                     P(X <= 0) ... P(X <= n)
mcnemar b c                      exact, two-sided
wilcoxon n d...                  exact p, of differences without ties and zeros
signed_rank alpha n d...         the pseudo-median, and the interval of the values that the exact test keeps
approximate n d...               p by the normal approximation
share level k n                  the exact interval of a share
student t nu                     P(T <= t)
between k n x...                 intraclass correlation of k groups of n values, from F of the analysis of variance
turn k n x... n x...             p of the extreme t of k groups, either way
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


def student():
    t, nu = numbers(2)
    return [scipy.stats.t.cdf(t, nu)]


def between():
    k, n = integer(), integer()
    f = scipy.stats.f_oneway(*numbers(k * n).reshape(k, n)).statistic
    return [max(0.0, (f - 1) / (f - 1 + n))]


def turn():
    groups = [numbers(integer()) for _ in range(integer())]
    pooled = np.concatenate([group - group.mean() for group in groups])
    spread = np.sum(pooled**2) / (len(pooled) - len(groups))
    t = [g.mean() / np.sqrt(max(g.var(ddof=1), spread) / len(g)) for g in groups]
    nu = [len(group) - 1 for group in groups]
    below, above = scipy.stats.t.cdf(t, nu).min(), scipy.stats.t.sf(t, nu).min()
    return [min(1.0, len(groups) * max(below, above))]


answer(binomial, mcnemar, wilcoxon, signed_rank, approximate, share, student, between, turn)
