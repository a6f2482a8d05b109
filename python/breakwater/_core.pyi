"""The compiled part. The package documents the names for users."""

import os
from typing import overload

import numpy as np
import numpy.typing as npt

__version__: str

class PlanarChain:
    """A planar serial manipulator from a URDF file: kinematics, masses and limits.

    Its tip is the frame of the one link without children. InputError, with file and line, if the file is not
    a URDF of a planar chain.
    """

    def __init__(self, urdf: str) -> None: ...
    @property
    def joints(self) -> int:
        """The number n of joints."""

    @property
    def effort_limits_Nm(self) -> np.ndarray:
        """The torque limits of the joints (n) [N m]."""

    def tip_pose(self, q_rad: npt.ArrayLike) -> np.ndarray:
        """The tip's x, y and angle [m, m, rad] at the joint angles q_rad (n) [rad]."""

    def tip_jacobian(self, q_rad: npt.ArrayLike) -> np.ndarray:
        """The derivative of the pose with respect to the angles, (3, n)."""

    def mass_matrix(self, q_rad: npt.ArrayLike) -> np.ndarray:
        """(n, n) [kg m^2], symmetric positive definite, without the motors' armature."""

class OwnRun:
    """A run made by this process."""

    @property
    def scenario(self) -> str: ...
    @property
    def case(self) -> str: ...
    @property
    def config_text(self) -> str: ...
    @property
    def metrics(self) -> dict[str, float]: ...
    @property
    def absent(self) -> dict[str, str]: ...
    @property
    def costs(self) -> dict[str, float]: ...
    @property
    def failure(self) -> tuple[float, str] | None: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def signals(self) -> list[tuple[str, str, str, str, int]]: ...
    @property
    def is_cut(self) -> bool: ...
    @property
    def is_streamed(self) -> bool: ...
    def warnings(self, has_python_parts: bool) -> list[str]: ...
    def array(self, group: str, name: str) -> np.ndarray: ...
    def save(self, folder: str) -> None: ...

class SavedRun:
    """A run's folder."""

    def __init__(self, folder: str | os.PathLike[str]) -> None: ...
    @property
    def scenario(self) -> str: ...
    @property
    def case(self) -> str: ...
    @property
    def config_text(self) -> str: ...
    @property
    def metrics(self) -> dict[str, float]: ...
    @property
    def absent(self) -> dict[str, str]: ...
    @property
    def failure(self) -> tuple[float, str] | None: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def signals(self) -> list[tuple[str, str, str, str, int]]: ...
    @property
    def is_cut(self) -> bool: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    def array(self, group: str, name: str) -> np.ndarray: ...

class ArrayEstimator:
    """An estimator of a plant's state x (n) and disturbance d (m) on arrays."""

    @overload
    def __init__(self, name: str, arguments: dict[str, object], sets: list[str]) -> None: ...
    @overload
    def __init__(self, of_quadrotor: dict[str, object]) -> None: ...
    def reset(self, x0: npt.ArrayLike | None = None) -> None:
        """Start from the state x0 (n; default: zeros) without a disturbance."""

    def update(self, u: npt.ArrayLike, y: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Take one sample: the input u (m) since the last one, the measurement y (p). Returns (x, d)."""

    def filter_record(
        self,
        u: npt.ArrayLike,
        y: npt.ArrayLike,
        t: npt.ArrayLike | None,
        x0: npt.ArrayLike | None,
        time_std_s: float,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]: ...
    @property
    def x(self) -> np.ndarray:
        """A copy of the estimated state (n)."""

    @property
    def d(self) -> np.ndarray:
        """A copy of the estimated disturbance (m), which opposes the input."""

    @property
    def innovation(self) -> np.ndarray:
        """A copy of y - C x(k|k-1) (p); empty if the estimator has none."""

    @property
    def pole_matrix(self) -> np.ndarray:
        """The matrix whose eigenvalues are the poles at this sample."""

def observers() -> list[tuple[str, str, list[tuple[str, str, str, str]]]]: ...

class Qp:
    """A solver of quadratic programs of one shape."""

    def __init__(
        self, H: npt.ArrayLike, Omega: npt.ArrayLike, solver: str, max_iterations: int
    ) -> None: ...
    def solve(
        self,
        g: npt.ArrayLike,
        lower: npt.ArrayLike | None,
        upper: npt.ArrayLike | None,
        softness: npt.ArrayLike | None,
    ) -> tuple[np.ndarray, np.ndarray, str, int, float]: ...
    def reset(self) -> None: ...

def run(
    scenario: str,
    case: str | None,
    config: str | None,
    sets: list[str],
    controller: object | None,
    estimator: object | None,
    controllers: dict[str, object],
    estimators: dict[str, object],
    out: str | None,
) -> OwnRun: ...
def program(
    words: list[str],
    hash: str,
    controller: object | None,
    estimator: object | None,
    controllers: dict[str, object],
    estimators: dict[str, object],
) -> int: ...
def choices(
    target: str,
    controller: object | None,
    estimator: object | None,
    controllers: dict[str, object],
    estimators: dict[str, object],
) -> list[str]: ...
def scenarios() -> dict[str, str]: ...
def cases(scenario: str) -> list[str]: ...
def compare(
    candidates: list[str],
    metrics: dict[str, np.ndarray],
    failed: np.ndarray,
    runs: np.ndarray,
    blocks: list[int],
    metric: str,
    goal: str,
    bounds: list[tuple[str, float, float]],
    share: float,
    confidence: float,
) -> str: ...
def did_you_mean(word: str, candidates: list[str]) -> str: ...
def dare(
    A: npt.ArrayLike, B: npt.ArrayLike, Q: npt.ArrayLike, R: npt.ArrayLike
) -> tuple[np.ndarray, np.ndarray]: ...
def place_observer_poles(
    A: npt.ArrayLike, C: npt.ArrayLike, poles: list[list[complex]]
) -> np.ndarray: ...
def place_poles(
    A: npt.ArrayLike, B: npt.ArrayLike, poles: list[list[complex]]
) -> np.ndarray: ...
def zero_order_hold(
    A: npt.ArrayLike, B: npt.ArrayLike, C: npt.ArrayLike, period_s: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def extend_by_disturbance_model(
    A: npt.ArrayLike, B: npt.ArrayLike, C: npt.ArrayLike, order: int, period_s: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def damped_inertia(
    inertia: float, viscous_friction: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def observability_rank(A: npt.ArrayLike, C: npt.ArrayLike) -> int: ...
