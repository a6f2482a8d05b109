"""The measurements of a controller: arrays with names for their entries."""

from __future__ import annotations

import numpy as np


class _Sample(np.ndarray):
    _behind = 0  # entries that stand behind its own

    def _own(self) -> np.ndarray:
        return self[: self.size - self._behind].view(np.ndarray)


class _WithForce(_Sample):
    _behind = 2

    @property
    def force_N(self) -> float:
        """Low-pass filtered force at the tip [N]. That of the arm is positive towards +x."""
        return self.item(-2)

    @property
    def raw_force_N(self) -> float:
        """Force at the tip before the low-pass filter [N]."""
        return self.item(-1)


class ArmSample(_WithForce):
    """y of the arm: [q (n); F_x; F_x before its low-pass], angles [rad] and the tip's force [N]."""

    @property
    def q_rad(self) -> np.ndarray:
        """Joint angles from the encoders, n [rad]."""
        return self._own()


class AxisSample(_Sample):
    """y of one axis, a motor [rad] or a cart [m].

    It has the measured position and, in some scenarios, the true position and velocity.
    """

    @property
    def position(self) -> float:
        """Measured position [rad or m]."""
        return self.item(0)

    @property
    def true_position(self) -> float:
        """True position [rad or m]. IndexError if the scenario does not provide it."""
        return self._own().item(1)

    @property
    def true_velocity(self) -> float:
        """True velocity [rad/s or m/s]. IndexError if the scenario does not provide it."""
        return self._own().item(2)


class PlantSample(_Sample):
    """y of a plant with named axes: the measured position of each axis, in the order of setup.names [rad or m].

    With sensor.true_state it has all true positions after them, then all true velocities: y.reshape(3, -1).
    """

    @property
    def positions(self) -> np.ndarray:
        """Measured positions of all axes; with sensor.true_state then the true ones and the true velocities [rad or m]."""
        return self._own()


class AxisForceSample(_WithForce, AxisSample):
    """y of an axis of a plant with a [tip]: AxisSample, then its force and that before the low-pass [N]."""


class PlantForceSample(_WithForce, PlantSample):
    """y of a plant with a [tip]: PlantSample, then its force and that before the low-pass [N]."""


class QuadrotorSample(np.ndarray):
    """y of the quadrotor: [x y z roll pitch yaw], z up [m, rad]."""

    @property
    def position_m(self) -> np.ndarray:
        """Measured x, y, z [m]."""
        return self[:3].view(np.ndarray)

    @property
    def attitude_rad(self) -> np.ndarray:
        """Measured roll, pitch, yaw [rad]."""
        return self[3:].view(np.ndarray)
