"""Places poles for one output with 60 digits. Input: n A C, then n poles as real and imaginary part. Output: H."""

import sys

import mpmath as mp

mp.mp.dps = 60
numbers = iter(sys.stdin.read().split())
for n in numbers:
    n = int(n)
    A = mp.matrix([[mp.mpf(next(numbers)) for _ in range(n)] for _ in range(n)])
    row = mp.matrix([[mp.mpf(next(numbers)) for _ in range(n)]])
    poles = [mp.mpc(next(numbers), next(numbers)) for _ in range(n)]
    O = mp.matrix(n, n)
    for i in range(n):
        O[i, :] = row
        row = row * A
    h = mp.inverse(O)[:, n - 1] if n > 1 else mp.matrix([1 / O[0, 0]])
    for pole in poles:
        h = A * h - pole * h
    for value in h:
        print(repr(float(mp.re(value))))
