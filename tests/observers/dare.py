"""Solves discrete algebraic Riccati equations with SciPy, for the tests of the Kalman filters.

Reads on stdin one problem a line: n p, then A (n x n), C (p x n), Q (n x n), R (p x p), all by rows.
Prints the stabilising X = A X A' - A X C' (C X C' + R)^-1 C X A' + Q, by rows, one line each.
"""

import sys

import numpy as np
from scipy.linalg import solve_discrete_are

for line in sys.stdin:
    numbers = [float(x) for x in line.split()]
    n, p = int(numbers[0]), int(numbers[1])
    rest = np.array(numbers[2:])
    shapes = [(n, n), (p, n), (n, n), (p, p)]
    matrices = []
    for shape in shapes:
        size = shape[0] * shape[1]
        matrices.append(rest[:size].reshape(shape))
        rest = rest[size:]
    A, C, Q, R = matrices
    X = solve_discrete_are(A.T, C.T, Q, R)
    print(" ".join(f"{x:.17g}" for x in X.ravel()))
