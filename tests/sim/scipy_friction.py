"""Integrates a mass with friction, finely and implicitly.

Input, in this order:
- mass, Coulomb friction, static ratio, Stribeck velocity, sigma_0, sigma_1, viscous friction
- amplitude and angular frequency of a force
- stiffness and speed of a spring that pulls
- duration, number of outputs

Output: the positions at equal distances of time. sigma_0 = 0: no bristles, friction as a set-valued force.
"""

import math
import sys

import numpy as np
import scipy.integrate

(mass, coulomb, ratio, stribeck, sigma_0, sigma_1, viscous, amplitude, omega, stiffness, speed, duration,
 count) = map(float, sys.stdin.read().split())


def force(t, x):
    return amplitude * math.sin(omega * t) + stiffness * (speed * t - x)


def level(v):
    return coulomb * (1.0 + (ratio - 1.0) * math.exp(-(v / stribeck) ** 2))


def bristles(t, state):
    x, v, z = state
    rate = v - sigma_0 * abs(v) / level(v) * z
    return [v, (force(t, x) - sigma_0 * z - sigma_1 * rate - viscous * v) / mass, rate]


def set_valued(h):
    """Implicit Euler: the velocity is 0 where the friction can hold the mass."""
    x, v = 0.0, 0.0
    every = int(round(duration / count / h))
    for k in range(1, int(count) * every + 1):
        free = v + h / mass * force(k * h, x)
        new = v
        for _ in range(3):  # iterations for the level at the new velocity
            moving = max(0.0, abs(free) - h / mass * level(new)) / (1.0 + h / mass * viscous)
            new = math.copysign(moving, free)
        v = new
        x += h * v
        if k % every == 0:
            yield x


times = np.linspace(0.0, duration, int(count) + 1)[1:]
if sigma_0 > 0.0:
    solution = scipy.integrate.solve_ivp(bristles, (0.0, duration), [0.0] * 3, method="Radau", t_eval=times,
                                         rtol=1e-8, atol=[1e-12, 1e-10, 1e-12], max_step=duration / 2000)
    positions = solution.y[0]
else:
    positions = set_valued(5e-5)
for position in positions:
    print(repr(float(position)))
