"""Solves quadratic programs with CVXOPT. Input: n m H Omega g lower upper. Output: z."""

import sys

import cvxopt
import numpy as np

cvxopt.solvers.options.update(show_progress=False, abstol=1e-11, reltol=1e-11, feastol=1e-11,
                              maxiters=100)
numbers = iter(np.array(sys.stdin.read().split(), dtype=float))


def matrix(rows, cols):
    return np.array([next(numbers) for _ in range(rows * cols)]).reshape(rows, cols)


for n in numbers:
    n, m = int(n), int(next(numbers))
    H, Omega, g = matrix(n, n), matrix(m, n), matrix(n, 1)
    lower, upper = matrix(m, 1).ravel(), matrix(m, 1).ravel()
    above, below = np.isfinite(upper), np.isfinite(lower)
    G = np.vstack([Omega[above], -Omega[below]])
    h = np.concatenate([upper[above], -lower[below]])
    solution = cvxopt.solvers.qp(*(cvxopt.matrix(x) for x in (H, g, G, h)))
    for value in np.array(solution["x"]).ravel():
        print(repr(float(value)))
