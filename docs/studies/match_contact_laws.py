#!/usr/bin/python3
"""Prints the keys of contact laws that give one impact: the peak and the restitution of a spring and damper.

    docs/studies/match_contact_laws.py

The impact: 5 kg at 0.1 m/s on 1000 N/m and 10 N s/m. Hertz' law has no damping, so it has the peak alone.
`studies/contact-laws.toml` has these numbers.
"""
import math

MASS, SPEED, STIFFNESS, DAMPING = 5.0, 0.1, 1000.0, 10.0


def impact(force):
    """(peak, restitution) of a law force(x, v, z) -> (F, dz/dt), by RK4."""
    h, x, v, z, peak = 2e-4, 0.0, SPEED, 0.0, 0.0

    def rates(x, v, z):
        f, dz = force(max(x, 0.0), v, z)
        return v, -max(f, 0.0) / MASS, dz

    while True:
        k1 = rates(x, v, z)
        if k1[1] == 0.0 and v < 0.0:
            return peak, -v / SPEED
        peak = max(peak, -k1[1] * MASS)
        k2 = rates(x + h / 2 * k1[0], v + h / 2 * k1[1], z + h / 2 * k1[2])
        k3 = rates(x + h / 2 * k2[0], v + h / 2 * k2[1], z + h / 2 * k2[2])
        k4 = rates(x + h * k3[0], v + h * k3[1], z + h * k3[2])
        x, v, z = (a + h / 6 * (p + 2 * q + 2 * r + s)
                   for a, p, q, r, s in zip((x, v, z), k1, k2, k3, k4))


def solve(miss, low, high):
    """The parameter between low and high at which a falling or rising miss is 0."""
    at_high = miss(high)
    assert miss(low) * at_high < 0.0, "no solution between these"
    for _ in range(24):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if miss(middle) * at_high > 0.0 else (middle, high)
    return low


def stiffness(law, low, high):
    return solve(lambda value: impact(law(value))[0] - PEAK, low, high)


def hunt_crossley(k, alpha):
    return lambda x, v, z: (k * x ** 1.5 * (1.0 + alpha * v), 0.0)


def layered(scale, alpha):
    """A skin of 4 mm with a third of the stiffness of what is below it."""
    def force(x, v, z):
        rest = x if x < 0.004 else 0.004 + 3.0 * (x - 0.004)
        return scale * rest * (1.0 + alpha * v), 0.0
    return force


def solid(k, tau):
    """The spring of the Maxwell arm is half as stiff as the other one."""
    return lambda x, v, z: (k * x + 0.5 * k * (x - z), (x - z) / tau if k * x + 0.5 * k * (x - z) > 0.0 else 0.0)


PEAK, RESTITUTION = impact(lambda x, v, z: (STIFFNESS * x + DAMPING * v, 0.0))


def main():
    print(f"peak {PEAK:.4f} N, restitution {RESTITUTION:.4f}")
    # The restitution of f(x) (1 + alpha v) depends on alpha times the speed alone, whatever f is.
    alpha = solve(lambda value: impact(hunt_crossley(8e3, value))[1] - RESTITUTION, 0.1, 30.0)
    k = stiffness(lambda value: hunt_crossley(value, 0.0), 2e3, 5e4)
    print(f"hertz: stiffness {k:.6g}")
    k = stiffness(lambda value: hunt_crossley(value, alpha), 2e3, 5e4)
    print(f"hunt_crossley: stiffness {k:.6g}, dissipation {alpha:.6g}")
    k = stiffness(lambda value: layered(value, alpha), 50.0, 2e3)
    print(f"layered: [[0.004, {0.004 * k:.6g}], [0.01, {0.022 * k:.6g}]], dissipation {alpha:.6g}")
    # There are two such relaxation times: the slower one, of about the duration of the impact.
    k, tau = 700.0, 0.0
    for _ in range(5):
        tau = solve(lambda value: impact(solid(k, value))[1] - RESTITUTION, 0.07, 1.0)
        k = stiffness(lambda value: solid(value, tau), 300.0, 2e3)
    print(f"standard_linear_solid: stiffness {k:.6g}, maxwell_stiffness {0.5 * k:.6g}, relaxation {tau:.6g}")


if __name__ == "__main__":
    main()
