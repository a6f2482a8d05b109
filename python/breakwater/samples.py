"""What a controller measures: arrays whose entries also have names."""

from __future__ import annotations

import numpy as np


class ArmSample(np.ndarray):
    """y of the arm: [q (n); F_x; F_x before its low-pass], angles [rad] and the tip's force [N]."""

    @property
    def q_rad(self) -> np.ndarray:
        """Joint angles as the encoders tell them, n [rad]."""
        return self[:-2].view(np.ndarray)

    @property
    def force_N(self) -> float:
        """Force at the tip behind its low-pass [N], positive when it presses towards +x."""
        return self.item(-2)

    @property
    def raw_force_N(self) -> float:
        """The same before the low-pass [N]."""
        return self.item(-1)


class AxisSample(np.ndarray):
    """y of one axis, a motor [rad] or a cart [m]: [measured position], in some scenarios followed by
    [position; velocity] as they really are."""

    @property
    def position(self) -> float:
        """As measured [rad or m]."""
        return self.item(0)

    @property
    def true_position(self) -> float:
        """As it is [rad or m]. IndexError where the scenario does not tell it."""
        return self.item(1)

    @property
    def true_velocity(self) -> float:
        """As it is [rad/s or m/s]. IndexError where the scenario does not tell it."""
        return self.item(2)


class QuadrotorSample(np.ndarray):
    """y of the quadrotor: [x y z roll pitch yaw], z up [m, rad]."""

    @property
    def position_m(self) -> np.ndarray:
        """x, y, z as measured [m]."""
        return self[:3].view(np.ndarray)

    @property
    def attitude_rad(self) -> np.ndarray:
        """Roll, pitch, yaw as measured [rad]."""
        return self[3:].view(np.ndarray)
