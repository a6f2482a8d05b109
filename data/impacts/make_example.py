#!/usr/bin/env python3
"""Makes rubber-ball.csv: an impact of a law that Breakwater does not have.

    data/impacts/make_example.py > data/impacts/rubber-ball.csv

No rig measured it. A mass of 0.5 kg strikes a contact with 0.25 m/s. The contact stiffens
exponentially and loses energy by a hysteresis that depends on the direction alone:

    F = F0 (exp(x/x0) - 1) (1 + h sign(v)),   F0 = 4 N, x0 = 0.9 mm, h = 0.18

A sensor with noise of 0.05 N and steps of 0.02 N samples it at 20 kHz.
"""
import math
import random

MASS, SPEED, F0, X0, HYSTERESIS = 0.5, 0.25, 4.0, 0.9e-3, 0.18
RATE, SUBSTEPS, BEFORE, AFTER = 20000, 50, 0.002, 0.004


def force(x, v):
    return F0 * (math.exp(x / X0) - 1.0) * (1.0 + math.copysign(HYSTERESIS, v)) if x > 0.0 else 0.0


def main():
    random.seed(1)
    step = 1.0 / RATE / SUBSTEPS
    x, v, left, k = -SPEED * BEFORE, SPEED, None, 0
    print("time_s,force_N")
    while left is None or k / RATE < left + AFTER:
        reading = force(x, v) + random.gauss(0.0, 0.05)
        print(f"{k / RATE:.5f},{0.02 * round(reading / 0.02):.2f}")
        for _ in range(SUBSTEPS):
            v -= step * force(x, v) / MASS
            x += step * v
        k += 1
        if left is None and x < 0.0 and v < 0.0:
            left = k / RATE


if __name__ == "__main__":
    main()
