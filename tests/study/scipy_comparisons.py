"""SciPy's tests and intervals. Input: problems with a name and numbers. Output: numbers.

binomial n p                     P(X <= 0) ... P(X <= n)
mcnemar b c                      exact, two-sided
wilcoxon n d...                  exact p, of differences without ties and zeros
signs n d...                     p of Pratt's mid-ranks over all 2^n signs
pratt n d...                     p by the normal approximation
bca level n x... m replicate...  the interval of the mean
range k alpha                    upper quantile of the studentized range
ranks n k x...                   average ranks of k columns over n rows
student t nu                     P(T <= t)
between k n x...                 intraclass correlation of k groups of n values, from F of the analysis of variance
turn k n x... n x...             p of the extreme t of k groups, either way
"""

import itertools

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


def signs():
    d = numbers(integer())
    ranks = scipy.stats.rankdata(np.abs(d))
    ranks = np.where(d == 0, 0, ranks)
    all_signs = np.array(list(itertools.product([0, 1], repeat=len(d))))
    sums, w = all_signs @ ranks, ranks[d > 0].sum()
    return [min(1.0, 2 * min(np.mean(sums <= w), np.mean(sums >= w)))]


def pratt():
    d = numbers(integer())
    return [scipy.stats.wilcoxon(d, zero_method="pratt", correction=True, mode="approx").pvalue]


def bca():
    level = numbers(1)[0]
    x = numbers(integer())
    replicates = numbers(integer())
    drawn = scipy.stats._resampling.BootstrapResult(None, replicates, None)
    result = scipy.stats.bootstrap(
        (x,), np.mean, n_resamples=0, bootstrap_result=drawn, confidence_level=level, method="BCa"
    )
    return [result.confidence_interval.low, result.confidence_interval.high]


def range_():
    k, alpha = integer(), numbers(1)[0]
    return [scipy.stats.studentized_range.ppf(1 - alpha, k, np.inf)]


def ranks():
    n, k = integer(), integer()
    return scipy.stats.rankdata(numbers(n * k).reshape(n, k), axis=1).mean(axis=0)


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


answer(binomial, mcnemar, wilcoxon, signs, pratt, bca, range_, ranks, student, between, turn)
