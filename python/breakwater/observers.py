"""Estimators for arrays: sample by sample, or a whole record at once.

Each estimates the state x (n) of a plant and the disturbance d (m) that opposes its inputs,

    dx/dt = A x + B (u - d),   y = C x + error,

from the input and the measurement. `f.update(u, y)` takes one sample and returns (x, d). `f.filter(u, y)` takes
a record. A, B and C are the plant in continuous time, sampled every period_s [s] with a held input. The Kalman
filters also take a sampled plant: omit period_s, and the unit of time is then a sample.
docs/explanation/methods/disturbance-kalman-filters.md has the equations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from .arguments import checked_text, toml_text
from .errors import InputError

Matrix = npt.ArrayLike

_SHORT = {
    "Q": "process_noise",
    "R": "observation_noise",
    "P0": "initial_covariance",
    "noise_on": "process_noise_on",
    "order": "disturbance_order",
    "poles": "poles_rad_s",
    "cutoff_rad_s": "low_pass_cutoff_rad_s",
    "lambda_": "lambda",
}


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


class Observer(_core.ArrayEstimator):
    """Any observer of a scenario's axis, such as "vfakfd". The argument KEY is the key `observer.KEY`, which
    `breakwater reference` lists; help(bw.Vfakfd) shows those of one; "lambda" is lambda_ here. Q, R, P0, noise_on, order, poles and
    cutoff_rad_s stand for process_noise, observation_noise, initial_covariance, process_noise_on,
    disturbance_order, poles_rad_s and low_pass_cutoff_rad_s.

    A (n, n), B (n, m), C (p, n): plant. period_s [s]: sampling period. delta (p): encoder resolution; 0: not
    quantised. sigma (p): standard deviation of white noise. Both are in the unit of y. rounding: "nearest", or
    "truncate" for an encoder that truncates towards 0. largest_input: limit of the drive [N m or N]; 0: unknown.
    pulses_per_revolution: counts of the encoder in a revolution or metre; 0: unknown.
    """

    def __init__(
        self,
        name: str,
        A: Matrix,
        B: Matrix,
        C: Matrix,
        *,
        period_s: float | None = None,
        delta: Matrix = 0.0,
        sigma: Matrix = 0.0,
        rounding: str = "nearest",
        largest_input: float = 0.0,
        pulses_per_revolution: float = 0.0,
        **keys: object,
    ):
        system = {"A": A, "B": B, "C": C, "period_s": period_s, "delta": delta, "sigma": sigma}
        drive = {"largest_input": largest_input, "pulses_per_revolution": pulses_per_revolution}
        given = {**system, "rounding": str(rounding), **drive}
        super().__init__(checked_text(str(name), "name"), given, _sets(keys))

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


class Motions(NamedTuple):
    """Estimates for each sample: motion (samples, 12) is the pose and its rate, force (samples, 3) the
    disturbance."""

    motion: np.ndarray
    force: np.ndarray


class QuadrotorFilter(_core.ArrayEstimator):
    """The unscented ("ukf") or extended ("ekf") Kalman filter of the underwater quadrotor.

    disturbance: "none", "zero" or "second" order at the thrusters, or "resonator" (ukf only). The resonator
    models waves of wave_frequency_rad_s, and tracks this frequency if estimates_wave_frequency is set. The
    standard deviations are those of the random walk per sample and of the measurement noise.
    added_mass_coefficient is C_a of the run, 0 for the thesis' plant. update(u, y) takes thrusts (4) [N] and a
    pose (6), and returns the motion (12) and the force (3) of Motions.
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

    def reset(self, pose: Matrix) -> None:
        """Start at rest at a pose (6) without a disturbance."""
        super().reset(pose)

    def filter(self, u: Matrix, y: Matrix) -> Motions:
        """Filter a whole record.

        u (samples, 4): thrusts from each sample on [N]. y (samples, 6): poses [x y z roll pitch yaw] [m, rad].
        The filter starts at rest at the first pose. Angles may jump by whole turns.
        """
        return Motions(*self.filter_record(u, y, None, None, 0.0)[:2])


def _sets(keys: dict[str, object]) -> list[str]:
    sets = []
    for short, value in keys.items():
        key = _SHORT.get(short, short)
        if key in keys and key != short:
            raise InputError(f"{short}: is another name of {key}, which is given too")
        if key == "initial_covariance" and np.ndim(value) == 0:
            value = [value]
        sets.append(checked_text(f"observer.{key}={toml_text(value, short)}", short))
    return sets
