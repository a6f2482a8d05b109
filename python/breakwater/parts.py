"""Controllers and estimators of your own."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import numpy.typing as npt


class Controller:
    """A sampled-data control law: derive from it, and pass an object of yours as `controller=`.

    `update` is called at each control instant, t = 0 included, and decides the command until the next
    one; `reset` once before, with the first sample. `self.setup` is then what the law may know of the
    plant. What `update` returns, and which fields y has:

    ========== =============================== ==================================================
    plant      u                               y
    ========== =============================== ==================================================
    arm        torques, one a joint [N m]      ArmSample: q_rad (n), force_N, raw_force_N
    motor      one torque [N m]                AxisSample: position; where told true_position, true_velocity
    cart       one force [N]                   the same
    quadrotor  four thrusts [N]                QuadrotorSample: position_m (3), attitude_rad (3)
    ========== =============================== ==================================================

    y is a NumPy array of its own at every sample: keep it if you like. The plant saturates u itself.

    `self.setup` of the arm: period_s, chain (tip_pose, tip_jacobian, mass_matrix of angles [rad]),
    torque_limit_Nm, nominal_inertia_kgm2, start_angles_rad, start_pose (x, y, phi),
    force_control_from_s, force_reference_N, convert_gain_N_m. Of an axis: period_s, A, B, C (continuous),
    force_limit, quantum, noise_std, start_state, reference(t). Of the quadrotor: period_s, reference_m,
    mass_kg, inertia_kgm2, net_weight_N, thrust_limit_N, thruster_matrix, position_std_m, angle_std_rad.

    An exception ends the run and leaves bw.run() with its own traceback.
    """

    setup: SimpleNamespace

    def reset(self, t: float, y: np.ndarray) -> None:
        """Called once before the first update, with the first sample at t [s]."""

    def update(self, t: float, y: np.ndarray) -> npt.ArrayLike:
        """One sampling instant at t [s]: y is what was measured, the result u until the next one."""
        raise NotImplementedError(f"{type(self).__name__} has no update(self, t, y)")

    def signals(self) -> dict[str, tuple[str, str, np.ndarray]]:
        """What others may see, in the log and in pictures: NAME: (unit, description, array).

        The name has the unit at its end ("x_ref_m"). The array, of float64, is one that `update` writes
        in place (`self.x_ref[0] = ...`): the run copies from it after each sample.
        """
        return {}


class Estimator:
    """An estimator of an axis, of the arm's joints or of the quadrotor, passed as `estimator=`: the controller
    of the run works with what it tells. The arm's first joint has the object itself, each other one a deep copy.

    `reset(x0)` starts it: at [position, velocity] of an axis, at a pose (6) of the quadrotor. `update(u,
    y)` is called at each sample: u (1 or 4) is what acted since the last one (0 at the first), y, as a
    controller gets it, what is measured now. It returns the estimate of this sample,

        axis:       [position, velocity, d], where the disturbance d opposes the drive,
        quadrotor:  [pose (6), its rate (6), disturbing force (3)].

    `self.setup` is as that of a controller, for an axis or a joint without start_state and reference, and
    with joint, which one it is, from 0 on.
    """

    setup: SimpleNamespace

    def reset(self, x0: np.ndarray) -> None:
        """Starts from x0, without a disturbance."""

    def update(self, u: np.ndarray, y: np.ndarray) -> npt.ArrayLike:
        """One sample: what acted since the last one, and what is measured now."""
        raise NotImplementedError(f"{type(self).__name__} has no update(self, u, y)")

    def signals(self) -> dict[str, tuple[str, str, np.ndarray]]:
        """As Controller.signals(); of an axis alone."""
        return {}
