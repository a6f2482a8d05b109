"""The library's estimators on arrays: step by step, or a whole record at once.

Each estimates the state x (n) of a plant and the disturbance d (m) that opposes its inputs,

    dx/dt = A x + B (u - d),   y = C x + error,

from what acted and what was measured. `f.update(u, y)` is one sample and returns (x, d); `f.filter(u, y)`
is a record. A, B and C are the plant in continuous time, sampled every period_s [s] under a held input.
The Kalman filters also take a plant that is sampled already: without period_s, and time then counts in
samples. docs/explanation/methods/disturbance-kalman-filters.md has the equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from .arguments import toml_text
from .linear import _groups, _rows, _whole

Matrix = npt.ArrayLike
Poles = Sequence[complex] | Sequence[Sequence[complex]]


class Estimates(NamedTuple):
    """Of each sample k of a record: x (samples, n), d (samples, m); the innovation y - C x(k|k-1)
    (samples, p); and forgetting (samples,), the factor that the covariance was divided by, 1 where nothing is
    forgotten. The last two are of shape (samples, 0) and (samples,) of ones where the estimator has none.
    """

    x: np.ndarray
    d: np.ndarray
    innovation: np.ndarray
    forgetting: np.ndarray


class Filter(_core.ArrayEstimator):
    """What all of them do."""

    def filter(
        self,
        u: Matrix,
        y: Matrix,
        t: Matrix | None = None,
        *,
        x0: Matrix | None = None,
        time_std_s: float = 0.0,
    ) -> Estimates:
        """Estimates of a whole record, after a reset.

        u (samples,) or (samples, m): u[k] acts from sample k until the next one, as a log has it. y
        (samples,) or (samples, p): y[k] is measured at sample k. t (samples,): when, rising [s]; the model is
        then taken over each interval as long as it is, and gaps are predicted over, with inputs on the line
        between those beside them. Without t samples are period_s apart. time_std_s: standard deviation of the
        times, where y was really measured a little before or after. x0 (n): the state to start from; without
        it the least one that gives y[0]. The other threads of Python go on meanwhile.
        """
        x, d, innovation, forgetting = self.filter_record(u, y, t, x0, time_std_s)
        ones = np.ones(len(x)) if forgetting.shape[1] == 0 else forgetting[:, 0]
        return Estimates(x, d, innovation, ones)


class StateObserver(Filter):
    """By poles, without a disturbance: d = 0. poles: continuous [1/s], n in all, for several outputs one list
    each. Its estimate of sample k has seen y up to k - 1."""

    def __init__(self, A: Matrix, B: Matrix, C: Matrix, *, poles: Poles, period_s: float):
        groups = _groups(poles, _rows(C, "C", 0), "output")
        super().__init__(
            "state_observer", {"A": A, "B": B, "C": C, "poles": groups, "period_s": period_s}
        )


class Idob(Filter):
    """Identity disturbance observer: by poles, continuous [1/s], n + m in all, for several outputs one list
    each. Its estimate of sample k has seen y up to k - 1."""

    def __init__(self, A: Matrix, B: Matrix, C: Matrix, *, poles: Poles, period_s: float):
        groups = _groups(poles, _rows(C, "C", 0), "output")
        super().__init__("idob", {"A": A, "B": B, "C": C, "poles": groups, "period_s": period_s})


class Mdob(Filter):
    """Minimal-order disturbance observer of one axis, J dv/dt = u - d.

    inertia J [kg m^2 or kg]; cutoff_rad_s of its low-pass; derivative_cutoff_rad_s of the
    pseudo-derivative, None: the raw difference.
    """

    def __init__(
        self,
        inertia: float,
        *,
        cutoff_rad_s: float,
        derivative_cutoff_rad_s: float | None = None,
        period_s: float,
    ):
        super().__init__(
            "mdob",
            {
                "inertia": inertia,
                "cutoff_rad_s": cutoff_rad_s,
                "derivative_cutoff_rad_s": derivative_cutoff_rad_s,
                "period_s": period_s,
            },
        )


class Kfd(Filter):
    """Kalman filter with a disturbance model of order 0 (step), 1 (ramp) or 2 (parabola).

    Q: a number q and where it enters, noise_on = "input" (B q B'), "all" (q I) or "disturbance" (the DKF); or
    the whole matrix (N, N), N = n + m (order + 1). R (p, p) of the measurement, P0 (N, N) of the first
    estimate; a number is that times I, a vector a diagonal. Only their ratios matter.
    """

    def __init__(
        self,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        Q: Matrix,
        R: Matrix = 1.0,
        P0: Matrix = 1.0,
        noise_on: str = "input",
        order: int = 0,
        period_s: float | None = None,
    ):
        super().__init__("kfd", _kalman(A, B, C, Q, R, P0, noise_on, order, period_s))


class Fakfd(Filter):
    """The Kfd with fixed forgetting factors: gamma of all states, gamma_d of the disturbance on top, both 1
    or more."""

    def __init__(
        self,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        Q: Matrix,
        R: Matrix = 1.0,
        P0: Matrix = 1.0,
        gamma: float = 1.0,
        gamma_d: float = 1.0,
        noise_on: str = "input",
        order: int = 0,
        period_s: float | None = None,
    ):
        arguments = _kalman(A, B, C, Q, R, P0, noise_on, order, period_s)
        super().__init__("fakfd", {**arguments, "gamma": gamma, "gamma_d": gamma_d})


class Vfakfd(Filter):
    """The Kfd with a variable forgetting factor, lambda_max less the innovation squared over alpha (p), not
    below lambda_min. The innovation is first brought nearer to 0 by the dead zone (p)."""

    def __init__(
        self,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        alpha: Matrix,
        Q: Matrix = 0.0,
        P0: Matrix = 1.0,
        dead_zone: Matrix = 0.0,
        lambda_min: float = 0.8,
        lambda_max: float = 1.0,
        noise_on: str = "input",
        order: int = 0,
        period_s: float | None = None,
    ):
        arguments = _kalman(A, B, C, Q, 1.0, P0, noise_on, order, period_s)
        limits = {"lambda_min": lambda_min, "lambda_max": lambda_max}
        super().__init__(
            "vfakfd", {**arguments, "alpha": alpha, "dead_zone": dead_zone, **limits}
        )


class Qvff(Filter):
    """The Vfakfd, designed by what the sensor cannot see: delta (p), what one count is worth, and sigma (p),
    the standard deviation of its white noise, in y's unit."""

    def __init__(
        self,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        delta: Matrix,
        sigma: Matrix = 0.0,
        lambda_min: float = 0.8,
        lambda_max: float = 1.0,
        order: int = 0,
        period_s: float | None = None,
    ):
        super().__init__(
            "qvff",
            {
                **_plant(A, B, C, order, period_s),
                "delta": delta,
                "sigma": sigma,
                "lambda_min": lambda_min,
                "lambda_max": lambda_max,
            },
        )


class Stf(Filter):
    """Strong tracking filter: a Kalman filter whose covariance is inflated where the innovation is more than
    the sensor's error explains. delta (p): what one count of the encoder is worth, 0: not quantised; sigma
    (p): the standard deviation of white noise; both in y's unit. rounding: "nearest", or "truncate" of an
    encoder that truncates towards 0."""

    def __init__(
        self,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        delta: Matrix,
        sigma: Matrix = 0.0,
        rounding: str = "nearest",
        order: int = 0,
        period_s: float | None = None,
    ):
        super().__init__(
            "stf",
            {
                **_plant(A, B, C, order, period_s),
                "delta": delta,
                "sigma": sigma,
                "rounding": str(rounding),
            },
        )


class AxisObserver(Filter):
    """Any observer that `observer.name` of a scenario with an axis takes, "qbank" say, with its keys: `observer.KEY`
    is the argument KEY. `breakwater reference` lists them.

    A, B, C: position and velocity under one input, the position measured (damped_inertia); delta, sigma and
    rounding as of Stf. largest_input: of the drive, 0: not known; pulses_per_revolution: of the encoder, 0: not
    known.
    """

    def __init__(
        self,
        name: str,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        period_s: float,
        delta: Matrix = 0.0,
        sigma: Matrix = 0.0,
        rounding: str = "nearest",
        largest_input: float = 0.0,
        pulses_per_revolution: float = 0.0,
        **keys: object,
    ):
        keys = {"name": str(name), **keys}
        super().__init__(
            "axis",
            {
                **_plant(A, B, C, 0, period_s),
                "delta": delta,
                "sigma": sigma,
                "rounding": str(rounding),
                "largest_input": largest_input,
                "pulses_per_revolution": pulses_per_revolution,
                "keys": [f"observer.{key}={toml_text(value, key)}" for key, value in keys.items()],
            },
        )


class Motions(NamedTuple):
    """Of each sample: motion (samples, 12), the pose and its rate, and the disturbing force (samples, 3)."""

    motion: np.ndarray
    force: np.ndarray


class QuadrotorFilter(_core.ArrayQuadrotorFilter):
    """The unscented ("ukf") or extended ("ekf") Kalman filter of the underwater quadrotor.

    disturbance: "none", "zero" or "second" order at the thrusters, or "resonator" (ukf): waves of
    wave_frequency_rad_s, which is tracked if estimates_wave_frequency. The deviations are those of the walk at
    each sample, and of the measurement's noise.
    """

    def __init__(
        self,
        kind: str = "ukf",
        *,
        disturbance: str = "resonator",
        period_s: float = 0.01,
        position_std_m: float = 0.1,
        angle_std_rad: float = 0.01,
        velocity_std_m_s: float = 0.03,
        rate_std_rad_s: float = 3e-3,
        disturbance_std: float = 0.01,
        wave_frequency_rad_s: float = 0.8,
        estimates_wave_frequency: bool = False,
    ):
        super().__init__(
            {
                "kind": str(kind),
                "disturbance": str(disturbance),
                "period_s": period_s,
                "position_std_m": position_std_m,
                "angle_std_rad": angle_std_rad,
                "velocity_std_m_s": velocity_std_m_s,
                "rate_std_rad_s": rate_std_rad_s,
                "disturbance_std": disturbance_std,
                "wave_frequency_rad_s": wave_frequency_rad_s,
                "estimates_wave_frequency": bool(estimates_wave_frequency),
            }
        )

    def filter(self, u: Matrix, y: Matrix) -> Motions:
        """A whole record: u (samples, 4), the thrusts from each sample on [N], y (samples, 6), the poses [x y z
        roll pitch yaw] [m, rad]. It starts at rest at the first pose."""
        return Motions(*self.filter_record(u, y))


def _plant(A: Matrix, B: Matrix, C: Matrix, order: int, period_s: float | None) -> dict[str, object]:
    return {"A": A, "B": B, "C": C, "order": _whole(order, "order"), "period_s": period_s}


def _kalman(
    A: Matrix,
    B: Matrix,
    C: Matrix,
    Q: Matrix,
    R: Matrix,
    P0: Matrix,
    noise_on: str,
    order: int,
    period_s: float | None,
) -> dict[str, object]:
    return {
        **_plant(A, B, C, order, period_s),
        "Q": Q,
        "R": R,
        "P0": P0,
        "noise_on": str(noise_on),
    }
