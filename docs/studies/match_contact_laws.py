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


def matched():
    """For each law its keys as (value, power of the stiffness): keys of lengths go with -1/2, those of times too."""
    # The restitution of f(x) (1 + alpha v) depends on alpha times the speed alone, whatever f is.
    alpha = solve(lambda value: impact(hunt_crossley(8e3, value))[1] - RESTITUTION, 0.1, 30.0)
    hertz = stiffness(lambda value: hunt_crossley(value, 0.0), 2e3, 5e4)
    crossley = stiffness(lambda value: hunt_crossley(value, alpha), 2e3, 5e4)
    skin = stiffness(lambda value: layered(value, alpha), 50.0, 2e3)
    # There are two such relaxation times: the slower one, of about the duration of the impact.
    k, tau = 700.0, 0.0
    for _ in range(5):
        tau = solve(lambda value: impact(solid(k, value))[1] - RESTITUTION, 0.07, 1.0)
        k = stiffness(lambda value: solid(value, tau), 300.0, 2e3)
    spring = {"stiffness_N_m": (STIFFNESS, 1.0), "damping_Ns_m": (DAMPING, 0.5)}
    dissipation = {"dissipation_s_m": (alpha, 0.0)}
    return {
        "kelvin_voigt": spring,
        "kelvin_voigt_clipped": spring,
        "hertz": {"stiffness_N_m": (hertz, 1.25)},
        "hunt_crossley": {"stiffness_N_m": (crossley, 1.25)} | dissipation,
        "layered": {"layers": [[(0.004, -0.5), (0.004 * skin, 0.5)], [(0.01, -0.5), (0.022 * skin, 0.5)]]} | dissipation,
        "standard_linear_solid": {"stiffness_N_m": (k, 1.0), "maxwell_stiffness_N_m": (0.5 * k, 1.0),
                                  "relaxation_s": (tau, -0.5)},
    }


def contact_keys(stiffness_N_m):
    """For each law its lines of a scenario file, for walls that match this spring with the same damping ratio.

    At a stiffness r times as high, all laws stay matched if forces are multiplied by sqrt(r), and lengths and
    times divided by it.
    """
    ratio = stiffness_N_m / STIFFNESS

    def text(value):
        if isinstance(value, list):
            return "[" + ", ".join(text(item) for item in value) + "]"
        return f"{value[0] * ratio ** value[1]:.6g}"

    return {law: [f'contact.law="{law}"'] + [f"contact.{key}={text(value)}" for key, value in keys.items()]
            for law, keys in matched().items()}


def main():
    print(f"peak {PEAK:.4f} N, restitution {RESTITUTION:.4f} at {STIFFNESS:g} N/m")
    for stiffness_N_m in (1000.0, 5000.0):
        print(f"{stiffness_N_m:g} N/m")
        for lines in contact_keys(stiffness_N_m).values():
            print("  " + " ".join(lines))


if __name__ == "__main__":
    main()
