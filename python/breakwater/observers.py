"""Estimators for arrays: sample by sample, or a whole record at once.

Each estimates the state x (n) of a plant and the disturbance d (m) that opposes its inputs,

    dx/dt = A x + B (u - d),   y = C x + error,

from the input and the measurement. `f.update(u, y)` takes one sample and returns (x, d). `f.filter(u, y)` takes
a record. A, B and C are the plant in continuous time, sampled every period_s [s] with a held input. The Kalman
filters also take a sampled plant: omit period_s, and the unit of time is then a sample.
docs/explanation/methods/disturbance-kalman-filters.md has the equations.
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
    """Estimates for each sample k of a record.

    x (samples, n), d (samples, m). innovation (samples, p): y - C x(k|k-1). forgetting (samples,): the factor
    that divided the covariance, 1 without forgetting. For an estimator without them the last two have the
    shape (samples, 0) and are ones (samples,).
    """

    x: np.ndarray
    d: np.ndarray
    innovation: np.ndarray
    forgetting: np.ndarray


class Filter(_core.ArrayEstimator):
    """The common part of all estimators."""

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

        u (samples,) or (samples, m): u[k] acts from sample k to the next one, as in a log. y (samples,) or
        (samples, p): y[k] is measured at sample k. t (samples,): increasing times [s]. The model then uses the
        true length of each interval, and the estimator predicts over gaps with linearly interpolated inputs.
        Without t the samples are period_s apart. time_std_s: standard deviation of the times, if y was measured
        slightly earlier or later. x0 (n): initial state; by default the smallest one that gives y[0]. Other
        Python threads continue meanwhile.
        """
        x, d, innovation, forgetting = self.filter_record(u, y, t, x0, time_std_s)
        ones = np.ones(len(x)) if forgetting.shape[1] == 0 else forgetting[:, 0]
        return Estimates(x, d, innovation, ones)


class StateObserver(Filter):
    """State observer with placed poles and without a disturbance: d = 0.

    poles: continuous [1/s], n in total. For several outputs, one list each with the poles
    that it places: those of an axis' position, velocity and disturbance belong to that axis. The estimate of
    sample k uses y up to k - 1.
    """

    def __init__(self, A: Matrix, B: Matrix, C: Matrix, *, poles: Poles, period_s: float):
        groups = _groups(poles, _rows(C, "C", 0), "output")
        super().__init__(
            "state_observer", {"A": A, "B": B, "C": C, "poles": groups, "period_s": period_s}
        )


class Idob(Filter):
    """Identity disturbance observer with placed poles.

    poles: continuous [1/s], n + m in total. For several outputs, one list each with the
    poles that it places: those of an axis' position, velocity and disturbance belong to that axis. The
    estimate of sample k uses y up to k - 1.
    """

    def __init__(self, A: Matrix, B: Matrix, C: Matrix, *, poles: Poles, period_s: float):
        groups = _groups(poles, _rows(C, "C", 0), "output")
        super().__init__("idob", {"A": A, "B": B, "C": C, "poles": groups, "period_s": period_s})


class Mdob(Filter):
    """Minimal-order disturbance observer of one axis, J dv/dt = u - d.

    inertia J [kg m^2 or kg]. cutoff_rad_s: cutoff of the low-pass. derivative_cutoff_rad_s: cutoff of the
    pseudo-derivative; None means the raw difference.
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

    Q: a number q, which enters by noise_on: "input" (B q B'), "all" (q I) or "disturbance" (the DKF). Or the
    whole matrix (N, N) with N = n + m (order + 1). R (p, p): measurement noise. P0 (N, N): covariance of the
    first estimate. A number means a multiple of I, a vector a diagonal. Only the ratios matter.
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
    """The Kfd with fixed forgetting factors, both at least 1: gamma for all states, and gamma_d in addition for
    the disturbance."""

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
    """The Kfd with a variable forgetting factor.

    The factor is lambda_max minus the squared innovation divided by alpha (p), but at least lambda_min. A dead
    zone (p) first reduces the innovation.
    """

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
    """The Vfakfd with parameters from the sensor's error.

    delta (p): encoder resolution. sigma (p): standard deviation of white noise. Both are in the unit of y.
    """

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
    """Strong tracking filter: a Kalman filter that raises its covariance if the sensor's error does not explain
    the innovation.

    delta (p): encoder resolution; 0 means no quantisation. sigma (p): standard deviation of white noise. Both
    are in the unit of y. rounding: "nearest", or "truncate" for an encoder that truncates towards 0.
    """

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
    """Any observer of a scenario's axis, such as "qbank". The argument KEY is the key `observer.KEY`, which
    `breakwater reference` lists.

    A, B, C: plant with one input and the states position and velocity; the position is measured (damped_inertia).
    delta, sigma, rounding: sensor, as for Stf. largest_input: limit of the drive; 0: unknown.
    pulses_per_revolution: counts of the encoder in a revolution; 0: unknown.
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
    """Estimates for each sample: motion (samples, 12) is the pose and its rate, force (samples, 3) the
    disturbance."""

    motion: np.ndarray
    force: np.ndarray


class QuadrotorFilter(_core.ArrayQuadrotorFilter):
    """The unscented ("ukf") or extended ("ekf") Kalman filter of the underwater quadrotor.

    disturbance: "none", "zero" or "second" order at the thrusters, or "resonator" (ukf only). The resonator
    models waves of wave_frequency_rad_s, and tracks this frequency if estimates_wave_frequency is set. The
    standard deviations are those of the random walk per sample and of the measurement noise.
    added_mass_coefficient is C_a of the run, 0 for the thesis' plant.
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
        added_mass_coefficient: float = 0.5,
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
                "added_mass_coefficient": added_mass_coefficient,
            }
        )

    def filter(self, u: Matrix, y: Matrix) -> Motions:
        """Filter a whole record.

        u (samples, 4): thrusts from each sample on [N]. y (samples, 6): poses [x y z roll pitch yaw] [m, rad].
        The filter starts at rest at the first pose. Angles may jump by whole turns.
        """
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
