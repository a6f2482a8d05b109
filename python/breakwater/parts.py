"""Base classes for your own controllers and estimators."""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable
from types import SimpleNamespace, TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from . import samples
from .arguments import checked_text, description, finite, numbers
from .errors import InputError
from .linear import PlanarChain

_FLOAT = np.dtype(np.float64)


class Controller:
    """A sampled-data control law. Derive a class from it, and pass an object as `controller=`.

    The run calls `reset` once with the first sample, and `update` at each control instant from t = 0 on.
    `update` returns the command until the next instant. `self.setup` has data of the plant. Commands and fields
    of y:

    ========== =============================== ==================================================
    plant      u                               y
    ========== =============================== ==================================================
    arm        torques, one a joint [N m]      ArmSample: q_rad (n), force_N, raw_force_N
    motor      one torque [N m]                AxisSample: position; maybe true_position, true_velocity
    cart       one force [N]                   the same
    plant      one force a driven axis         PlantSample: positions; maybe true ones, true velocities;
                                               with a [tip] also force_N, raw_force_N
    quadrotor  four thrusts [N]                QuadrotorSample: position_m (3), attitude_rad (3)
    ========== =============================== ==================================================

    y is a new NumPy array at every sample, so you may keep it. The plant saturates u itself.

    `self.setup` of the arm: period_s, chain (tip_pose, tip_jacobian, mass_matrix as functions of the angles
    [rad]), torque_limit_Nm, nominal_inertia_kgm2, start_angles_rad, start_pose (x, y, phi),
    force_control_from_s, force_reference_N, convert_gain_N_m. For an axis: period_s, A, B, C (continuous),
    force_limit, quantum, noise_std, start_state, reference(t). The reference is on the side of y, the encoder's, and
    with nominal.model = "spring" at the load. For a plant: names (of its axes), period_s, A, B, C,
    pose, to_states, held_input, force_limit, quantum, noise_std, reference(t). The arrays have one entry for each axis or
    driven axis. A, B and C are the nominal plant linearised about its pose, in continuous time. The state x has the
    deviations of all joints, then their rates. to_states @ (y - pose) is the state at rest at y. reference(t) has
    the sides of y, as pose. pose includes the twist of loaded springs, and reference(t) does not. So the wanted
    deviations are reference(t) - reference(0), if no reference steps at 0. The forces held_input hold the pose. For
    a plant with a [tip], force_reference(t) [N]. For
    the quadrotor: period_s, reference_m, mass_kg (with the added mass), inertia_kgm2, net_weight_N, thrust_limit_N, thruster_matrix,
    position_std_m, angle_std_rad.

    An exception ends the run and leaves bw.run() with its traceback.
    """

    setup: SimpleNamespace

    def reset(self, t: float, y: np.ndarray) -> None:
        """Called once before the first update, with the first sample at t [s]."""

    def update(self, t: float, y: np.ndarray) -> npt.ArrayLike:
        """Called at each sampling instant t [s] with the measurement y. Returns u until the next instant."""
        raise NotImplementedError(f"{type(self).__name__} has no update(self, t, y)")

    def signals(self) -> dict[str, tuple[str, str, np.ndarray]]:
        """Signals for the log and for pictures: NAME: (unit, description, array).

        The name ends with the unit ("x_ref_m"). `update` writes into the float64 array (`self.x_ref[0] = ...`),
        and the run copies it after each sample.
        """
        return {}


class Estimator:
    """An estimator of an axis, of the arm's joints or of the quadrotor, passed as `estimator=`.

    The controller of the run uses its estimates. A controller in Python uses none. The first joint of the arm has the object itself, each other
    joint a deep copy.

    `reset(x0)` starts it. x0 is [position, velocity] of an axis, the deviations and rates of all joints of a
    plant, or a pose (6) of the quadrotor. `update(u, y)` is called at each sample. u is the input since the last
    sample, 0 at the first, with one entry for each driven axis or thruster. y is the present measurement, as for
    a controller. It returns the estimate for this sample:

        axis:       [position, velocity, d], where the disturbance d opposes the drive,
        plant:      [deviations of all joints (n), their rates (n), d of each driven axis],
        quadrotor:  [pose (6), its rate (6), disturbing force (3)].

    `self.setup` is that of a controller. For an axis or joint it lacks start_state and reference, and has
    `joint`, the index of the joint from 0.
    """

    setup: SimpleNamespace

    def reset(self, x0: np.ndarray) -> None:
        """Start from x0, without a disturbance."""

    def update(self, u: np.ndarray, y: np.ndarray) -> npt.ArrayLike:
        """Take one sample: the input since the last one, and the present measurement."""
        raise NotImplementedError(f"{type(self).__name__} has no update(self, u, y)")

    def signals(self) -> dict[str, tuple[str, str, np.ndarray]]:
        """The same as Controller.signals(). The quadrotor's log does not have them."""
        return {}


def _of_time(reference: Callable[[float], float] | list[Callable[[float], float]]) -> Callable[[float], Any]:
    def at(t: float) -> Any:
        t = finite(t, "t")
        return np.array([one(t) for one in reference]) if isinstance(reference, list) else reference(t)

    return at


class Link:
    """A run calls it in place of a part. It gives the part its `setup`, and takes what it returns and publishes.
    `signals` are (name, unit, description, array), with the part's values after each call."""

    def __init__(self, part: Any, sample_class: str, what: str, setup: dict[str, Any]):
        if "force_reference" in setup:
            sample_class = sample_class.replace("Sample", "ForceSample")
        self.sample_class = getattr(samples, sample_class)
        for name in {"reference", "force_reference"} & setup.keys():
            setup[name] = _of_time(setup[name])
        if "chain" in setup:
            setup["chain"] = PlanarChain._of(setup["chain"])
        part.setup = SimpleNamespace(**setup)
        self._name = type(part).__name__
        published = part.signals()
        if not isinstance(published, dict):
            raise InputError(f"{self._name}.signals(): must return a dict, is {description(published)}")
        entries = [(name, *self._entry(name, entry)) for name, entry in published.items()]
        self.signals = [(str(name), unit, text, array.copy()) for name, unit, text, array in entries]
        self._pairs = [(name, own[-1], copy[-1]) for (name, *own), copy in zip(entries, self.signals, strict=True)]
        self._part_reset = part.reset
        self.update = self._update(part.update, what)

    def _entry(self, name: Any, entry: Any) -> tuple[str, str, np.ndarray]:
        place = f"{self._name}.signals()"
        where = f"{place}: {checked_text(str(name), place)}"
        if not (isinstance(entry, tuple) and len(entry) == 3):
            raise InputError(f"{where}: must be a tuple (unit, description, array), is {description(entry)}")
        unit, text, array = checked_text(str(entry[0]), where), checked_text(str(entry[1]), where), entry[2]
        is_plain = isinstance(array, np.ndarray) and not isinstance(array, np.ma.MaskedArray)
        if not (is_plain and array.ndim == 1 and array.dtype == np.float64 and array.flags.c_contiguous):
            wish = "an array of float64 of one dimension that is written in place"
            raise InputError(f"{where}: must be {wish}, is {description(array)}")
        return unit, text, array

    def _publish(self) -> None:
        for name, array, copy in self._pairs:
            if array.shape != copy.shape or array.dtype is not _FLOAT:
                wish = f"keep its {len(copy)} numbers of float64"
                raise InputError(f"{self._name}.signals(): {name}: must {wish}, is {description(array)}")
            copy[:] = array

    def reset(self, *first: Any) -> None:
        self._part_reset(*first)
        self._publish()

    def _update(self, update: Callable[[Any, np.ndarray], Any], what: str) -> Callable[[Any, np.ndarray, int], Any]:
        pairs, publish = self._pairs, self._publish
        what = f"{self._name}.update() returned {what}"
        kinds = (np.ndarray, self.sample_class)

        def updated(first: Any, y: np.ndarray, size: int) -> Any:
            """`size` numbers, as an array or one float."""
            value = update(first, y)
            if pairs:
                publish()
            if type(value) in kinds and value.dtype is _FLOAT and value.shape == (size,):
                return value
            if type(value) is float and size == 1:
                return value
            values = numbers(value, what) if value is not None else np.empty(0)
            if value is None or values.size != size or values.ndim > 1:
                wish = f"{size} number{'' if size == 1 else 's'}"
                raise InputError(f"{what}: must be {wish}, is {description(value)}")
            return values

        return updated


def line_of(error: BaseException, trace: TracebackType | None) -> str:
    """One line for an exception: "ZeroDivisionError: division by zero (law.py:12)"."""
    line = f"{type(error).__name__}: {error}"
    for frame in traceback.extract_tb(trace)[-1:]:
        line += f" ({os.path.basename(frame.filename)}:{frame.lineno})"
    return line
