"""SciPy's points and quantiles. Input: problems with a name and numbers. Output: numbers.

sobol n d                        the first n points, row by row
latin_hypercube n d m            centred discrepancies of m hypercubes, seeds 0 ... m - 1
discrepancy n d u...             that of n points
quantile kind a b m u...         of m u
"""

import numpy as np
import scipy.stats
from scipy.stats import qmc

from problems import answer, integer, numbers, words


def sobol():
    n, d = integer(), integer()
    return qmc.Sobol(d, scramble=False).random(n).ravel()


def latin_hypercube():
    n, d, m = integer(), integer(), integer()
    return [qmc.discrepancy(qmc.LatinHypercube(d, seed=seed).random(n)) for seed in range(m)]


def discrepancy():
    n, d = integer(), integer()
    return [qmc.discrepancy(numbers(n * d).reshape(n, d))]


def quantile():
    kind, (a, b) = next(words), numbers(2)
    u = numbers(integer())
    return {
        "uniform": lambda: scipy.stats.uniform(a, b - a),
        "log_uniform": lambda: scipy.stats.loguniform(a, b),
        "normal": lambda: scipy.stats.norm(a, b),
    }[kind]().ppf(u)


answer(sobol, latin_hypercube, discrepancy, quantile)
