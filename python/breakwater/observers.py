"""Estimators for arrays: sample by sample, or a whole record at once.

Each estimates the state x (n) of a plant and the disturbance d (m) that opposes its inputs,

    dx/dt = A x + B (u - d),   y = C x + error,

from the input and the measurement. `f.update(u, y)` takes one sample and returns (x, d). `f.filter(u, y)` takes
a record. A, B and C are the plant in continuous time, sampled every period_s [s] with a held input. The Kalman
filters also take a sampled plant: omit period_s, and the unit of time is then a sample.
docs/explanation/methods/disturbance-kalman-filters.md has the equations.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from .arguments import Rebuilt, checked_text, finite, matrix, not_negative, one_of, record, toml_text, vector
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

# In TOML, for keys that a scenario's file must give: "KEY" of all observers, or "NAME.KEY" of one.
_DEFAULTS = {
    "disturbance_order": "0",
    "process_noise_on": '"input"',
    "observation_noise": "1.0",
    "initial_covariance": "[1.0]",
    "lambda_min": "0.8",
    "lambda_max": "1.0",
    "derivative_cutoff_rad_s": "0.0",
    "vfakfd.process_noise": "0.0",
}


def default_of(name: str, key: str) -> str:
    """The default value that Python adds to the bindings; "" if there is none."""
    return _DEFAULTS.get(f"{name}.{key}") or _DEFAULTS.get(key, "")


_KEYS = {name: [key for key, *_ in keys] for name, _, keys in _core.observers()}


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


class _Estimator(Rebuilt):
    _core: _core.ArrayEstimator
    _inputs: int
    _outputs: int
    _states: int

    x = property(lambda self: self._core.x, doc="A copy of the estimated state (n).")
    d = property(
        lambda self: self._core.d, doc="A copy of the estimated disturbance (m), which opposes the input."
    )
    innovation = property(
        lambda self: self._core.innovation,
        doc="A copy of y - C x(k|k-1) (p); empty if the estimator has none.",
    )
    pole_matrix = property(
        lambda self: self._core.pole_matrix, doc="The matrix whose eigenvalues are the poles at this sample."
    )

    def update(self, u: Matrix, y: Matrix) -> tuple[np.ndarray, np.ndarray]:
        """Take one sample: the input u (m) since the last one, the measurement y (p). Returns (x, d).

        The first u after a reset is ignored.
        """
        return self._core.update(vector(u, "u", self._inputs), vector(y, "y", self._outputs))

    def _records(self, u: Matrix, y: Matrix) -> tuple[np.ndarray, np.ndarray]:
        inputs, outputs = record(u, self._inputs, "u"), record(y, self._outputs, "y")
        _check_length(inputs, outputs, "u")
        return inputs, outputs


def _check_length(values: np.ndarray, y: np.ndarray, name: str) -> None:
    if len(values) != len(y):
        raise InputError(f"{name}: must have as many samples as y, {len(y)}, has {len(values)}")


class Observer(_Estimator):
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
        plant = [matrix(value, key) for key, value in (("A", A), ("B", B), ("C", C))]
        self._states, self._inputs, self._outputs = len(plant[0]), plant[1].shape[1], len(plant[2])
        self._period_s = 0.0 if period_s is None else finite(period_s, "period_s")
        sensor = [vector(value, key, self._outputs) for key, value in (("delta", delta), ("sigma", sigma))]
        truncates = one_of(rounding, "rounding", ("nearest", "truncate")) == "truncate"
        for key, value in zip(("delta", "sigma"), sensor, strict=True):
            not_negative(min(value, default=0.0), key)
        drive = [
            not_negative(largest_input, "largest_input"),
            not_negative(pulses_per_revolution, "pulses_per_revolution"),
        ]
        if period_s is not None and self._period_s <= 0.0:
            raise InputError("period_s: must be positive")
        name = checked_text(str(name), "name")
        defaults = {key: default_of(name, key) for key in _KEYS.get(name, ())}
        sets = [f"observer.{key}={value}" for key, value in defaults.items() if value] + _sets(keys)
        try:
            self._core = _core.ArrayEstimator(name, sets, *plant, self._period_s, *sensor, truncates, *drive)
        except InputError as error:  # without the place of a file or of --set
            raise InputError(re.sub(r"^(set: |Observer: )?(observer\.)?", "", str(error))) from None

    def reset(self, x0: Matrix | None = None) -> None:
        """Start from the state x0 (n; default: zeros) without a disturbance."""
        self._core.reset(vector(0.0 if x0 is None else x0, "x0", self._states))

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
        inputs, outputs = self._records(u, y)
        start = None if x0 is None else vector(x0, "x0", self._states)
        if not_negative(time_std_s, "time_std_s") != 0.0 and t is None:
            raise InputError("time_std_s: needs t, the times of the samples")
        times = None if t is None else self._times(t, outputs)
        x, d, innovation, forgetting = self._core.filter(inputs, outputs, times, start, float(time_std_s))
        ones = np.ones(len(x)) if forgetting.shape[1] == 0 else forgetting[:, 0]
        return Estimates(x, d, innovation, ones)

    def _times(self, t: Matrix, y: np.ndarray) -> np.ndarray:
        times = record(t, 1, "t")[:, 0]
        _check_length(times, y, "t")
        if self._period_s == 0.0:
            raise InputError("t: needs an estimator of a plant in continuous time (period_s)")
        for k in np.flatnonzero(np.diff(times) <= 0.0):
            raise InputError(f"t: must rise; sample {k + 1} does not")
        return times


class Motions(NamedTuple):
    """Estimates for each sample: motion (samples, 12) is the pose and its rate, force (samples, 3) the
    disturbance."""

    motion: np.ndarray
    force: np.ndarray


class QuadrotorFilter(_Estimator):
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
        orders = ("none", "zero", "second", "resonator")
        names = one_of(kind, "kind", ("ukf", "ekf")), one_of(disturbance, "disturbance", orders)
        numbers = {
            "period_s": period_s,
            "position_std_m": position_std_m,
            "angle_std_rad": angle_std_rad,
            "velocity_std_m_s": velocity_std_m_s,
            "rate_std_rad_s": rate_std_rad_s,
            "disturbance_std": disturbance_std,
            "wave_frequency_rad_s": wave_frequency_rad_s,
            "estimates_wave_frequency": float(bool(estimates_wave_frequency)),
            "added_mass_coefficient": added_mass_coefficient,
        }
        not_negative(added_mass_coefficient, "added_mass_coefficient")
        self._core = _core.ArrayEstimator(*names, {key: finite(value, key) for key, value in numbers.items()})
        self._inputs, self._outputs, self._states = 4, 6, 6
        self._angles = np.zeros(3)

    def reset(self, pose: Matrix) -> None:
        """Start at rest at a pose (6) without a disturbance."""
        start = vector(pose, "pose", 6)
        self._core.reset(start)
        self._angles = start[3:]

    def update(self, u: Matrix, y: Matrix) -> tuple[np.ndarray, np.ndarray]:
        """Take one sample: the thrusts u (4) since the last one, the pose y (6). Returns (motion, force).

        The first u after a reset is ignored. Angles may jump by whole turns.
        """
        pose = vector(y, "y", 6).copy()
        pose[3:] += 2 * np.pi * np.round((self._angles - pose[3:]) / (2 * np.pi))
        self._angles = pose[3:]
        return super().update(u, pose)

    def filter(self, u: Matrix, y: Matrix) -> Motions:
        """Filter a whole record.

        u (samples, 4): thrusts from each sample on [N]. y (samples, 6): poses [x y z roll pitch yaw] [m, rad].
        The filter starts at rest at the first pose. Angles may jump by whole turns.
        """
        thrusts, poses = self._records(u, y)
        whole = np.column_stack([poses[:, :3], np.unwrap(poses[:, 3:], axis=0)])
        motion, force, *_ = self._core.filter(thrusts, whole, None, None, 0.0)
        self._angles = whole[-1, 3:] if len(whole) else np.zeros(3)
        return Motions(motion, force)


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
