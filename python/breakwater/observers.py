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
from typing import Any, NamedTuple

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
    "velocity_std_m_s": "tuned_velocity_std_m_s",
    "rate_std_rad_s": "tuned_rate_std_rad_s",
    "disturbance_std": "tuned_disturbance_std",
}

# In TOML, for keys that a scenario's file must give: "KEY" of all observers, or "NAME.KEY" of one.
_DEFAULTS = {
    "disturbance": '"resonator"',
    "kalman.process_noise": '"tuned"',
    "process_noise_mode": '"delta_squared"',
    "measurement_covariance": '"actual"',
    "input_noise": "0.1",
    "tuned_velocity_std_m_s": "0.03",
    "tuned_rate_std_rad_s": "3e-3",
    "tuned_disturbance_std": "0.01",
    "wave_frequency": '"given"',
    "assumed_period_s": "8.0",
    "resonator_damping": "0.08",
    "resonator_force_std_N": "0.13",
    "resonator_velocity_std_m_s": "3e-3",
    "resonator_rate_std_rad_s": "2e-3",
    "resonator_bias_std_N": "5e-4",
    "resonator_torque_std_Nm": "2e-4",
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
    _period_s: float

    def _make(self, name: str, keys: dict[str, object], *given: Any) -> None:
        defaults = {key: default_of(name, key) for key in _KEYS.get(name, ())}
        standard = [f"{key}={value}" for key, value in defaults.items() if value]
        try:
            self._core = _core.ArrayEstimator(name, (standard, _sets(keys)), *given)
        except InputError as error:  # without the place of a file or of --set
            raise InputError(re.sub(r"^(set: |Observer: )?((observer|estimator)\.)?", "", str(error))) from None

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
        self._make(checked_text(str(name), "name"), keys, *plant, self._period_s, *sensor, truncates, *drive)

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
        times = np.arange(len(outputs)) * (self._period_s or 1.0) if t is None else self._times(t, outputs)
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

    The argument KEY is the key `estimator.KEY` of quadrotor_waves. Among them is disturbance: "none", "zero" or
    "second" order at the thrusters, or "resonator" or "spectrum" of the waves (ukf only). velocity_std_m_s,
    rate_std_rad_s and disturbance_std stand for the keys with tuned_ before them. period_s [s]: sampling period.
    position_std_m and angle_std_rad: standard deviations of the measurement noise. depth_m: that of the vehicle,
    where the waves of assumed_period_s act. added_mass_coefficient is C_a of the run, 0 for the thesis' plant.
    update(u, y) takes thrusts (4) [N] and a pose (6), and returns the motion (12) and the force (3) of Motions.
    """

    def __init__(
        self,
        kind: str = "ukf",
        *,
        period_s: float = 0.01,
        position_std_m: float = 0.1,
        angle_std_rad: float = 0.01,
        added_mass_coefficient: float = 0.5,
        depth_m: float = 10.0,
        **keys: object,
    ):
        keys["filter"] = one_of(kind, "kind", ("ukf", "ekf"))
        numbers = {"period_s": period_s, "position_std_m": position_std_m, "angle_std_rad": angle_std_rad}
        self._period_s, *noise = (finite(value, name) for name, value in numbers.items())
        added_mass = not_negative(added_mass_coefficient, "added_mass_coefficient")
        self._make("kalman", keys, self._period_s, *noise, added_mass, not_negative(depth_m, "depth_m"))
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
        motion, force, *_ = self._core.filter(thrusts, whole, np.arange(len(whole)) * self._period_s, None, 0.0)
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
        sets.append(checked_text(f"{key}={toml_text(value, short)}", short))
    return sets
