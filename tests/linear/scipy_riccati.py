"""Solves Riccati equations with SciPy. Input: n m A B Q R. Output: P and K."""

import sys

import numpy as np
import scipy.linalg

numbers = iter(np.array(sys.stdin.read().split(), dtype=float))


def matrix(rows, cols):
    return np.array([next(numbers) for _ in range(rows * cols)]).reshape(rows, cols)


for n in numbers:
    n, m = int(n), int(next(numbers))
    A, B, Q, R = matrix(n, n), matrix(n, m), matrix(n, n), matrix(m, m)
    P = scipy.linalg.solve_discrete_are(A, B, Q, R)
    K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    for value in np.concatenate([P.ravel(), K.ravel()]):
        print(repr(float(value)))
