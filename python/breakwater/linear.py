"""Design of controllers and observers, and quadratic programs.

A matrix is anything that NumPy converts to one, with finite real numbers. An InputError names a wrong matrix.
"""

from __future__ import annotations

import concurrent.futures
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from .arguments import Rebuilt, description, filled, finite, matrix, numbers, one_of, text_or_none, vector, whole
from .errors import InputError

Matrix = npt.ArrayLike


class Regulator(NamedTuple):
    """K (m, n) of u = -K x, and S (n, n): the future cost from x is x' S x."""

    K: np.ndarray
    S: np.ndarray


class Plant(NamedTuple):
    """A (n, n), B (n, m), C (p, n) of dx/dt = A x + B u or x(k+1) = A x(k) + B u(k), y = C x."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray


class QpSolution(NamedTuple):
    """The result of a quadratic program.

    z (n). mu (m): multipliers of the constraints, > 0 at an upper and < 0 at a lower bound. status: solved,
    iteration_cap, infeasible, not_finite or inaccurate (rounding hides both a solution and a proof of
    infeasibility). iterations. kkt_residual: 0 is optimal. Units do not change it, and solved means at most 1e-8.

    If the status is infeasible, mu is the proof. Omega' mu is 0. The sum of mu times the bounds selected
    by its signs is less than 0, or 0 if the bounds of a constraint cross.
    """

    z: np.ndarray
    mu: np.ndarray
    status: str
    iterations: int
    kkt_residual: float


def _apart(work: Callable[..., Any], *arguments: object) -> Any:
    """Work in another thread, so that Ctrl-C is heard meanwhile. The thread then finishes alone."""
    if all(np.size(given) < 2500 for given in arguments if isinstance(given, np.ndarray)):
        return work(*arguments)  # it takes milliseconds
    thread = concurrent.futures.ThreadPoolExecutor(1)
    try:
        return thread.submit(work, *arguments).result()
    finally:
        thread.shutdown(wait=False)


def _matrices(**given: Matrix) -> list[np.ndarray]:
    return [matrix(value, name) for name, value in given.items()]


def dare(A: Matrix, B: Matrix, Q: Matrix, R: Matrix) -> Regulator:
    """The stabilising solution S of the discrete algebraic Riccati equation

        S = A' S A - A' S B (R + B' S B)^-1 B' S A + Q,

    and the gain K = (R + B' S B)^-1 B' S A of the regulator u = -K x. The regulator minimises the sum of x' Q x
    + u' R u for x(k+1) = A x(k) + B u(k). A (n, n), B (n, m), Q (n, n) symmetric positive semidefinite, R (m,
    m) symmetric positive definite. Method: structured doubling algorithm (Chu et al. 2004). If a mode allows no
    stabilising solution, the InputError names its eigenvalue.
    """
    return Regulator(*_apart(_core.dare, *_matrices(A=A, B=B, Q=Q, R=R)))


def lqr(A: Matrix, B: Matrix, Q: Matrix, R: Matrix) -> Regulator:
    """The linear quadratic regulator of a sampled plant: the same as dare()."""
    return dare(A, B, Q, R)


def _groups(poles: object, count: int, what: str) -> list[list[complex]]:
    try:
        rows = filled(poles, complex).tolist() if count == 1 else list(poles)  # type: ignore
        if count == 1:
            rows = [rows] if not rows or not isinstance(rows[0], list) else rows
        groups = [[complex(pole) for pole in group] for group in rows]
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"poles: must be numbers, in one list for each {what} where there are several"
        ) from None
    if len(groups) != count:
        raise InputError(f"poles: must be {count} lists, one for each {what}, are {len(groups)}")
    return groups


def place_observer_poles(
    A: Matrix, C: Matrix, poles: Sequence[complex] | Sequence[Sequence[complex]]
) -> np.ndarray:
    """L (n, p) such that A - L C has these eigenvalues.

    A (n, n), C (p, n). poles: n numbers for one output. For several outputs: a list per output with the poles
    that it places, n in total. A complex pole needs its conjugate. If the plant consists of decoupled
    chains, each keeps its own group (eigenstructure assignment, Moore 1976).
    """
    A, C = _matrices(A=A, C=C)
    return _apart(_core.place_observer_poles, A, C, _groups(poles, len(C), "output"))


def place_poles(
    A: Matrix, B: Matrix, poles: Sequence[complex] | Sequence[Sequence[complex]]
) -> np.ndarray:
    """K (m, n) such that A - B K has these eigenvalues: place_observer_poles() of the transposed."""
    A, B = _matrices(A=A, B=B)
    return _apart(_core.place_observer_poles, A.T, B.T, _groups(poles, B.shape[1], "input")).T


def zero_order_hold(A: Matrix, B: Matrix, C: Matrix, period_s: float) -> Plant:
    """The plant dx/dt = A x + B u, y = C x, sampled exactly every period_s [s] with a held input."""
    plant = _matrices(A=A, B=B, C=C)
    return Plant(*_apart(_core.zero_order_hold, *plant, finite(period_s, "period_s")))


def extend_by_disturbance_model(
    A: Matrix, B: Matrix, C: Matrix, order: int, period_s: float
) -> Plant:
    """A sampled plant with the extended state [x; d; derivatives of d up to order].

    The disturbance d opposes the input. It is a step (order 0), ramp (1) or parabola (2).
    """
    model = whole(order, "order"), finite(period_s, "period_s")
    return Plant(*_core.extend_by_disturbance_model(*_matrices(A=A, B=B, C=C), *model))


def damped_inertia(inertia: float, viscous_friction: float = 0.0) -> Plant:
    """A motor or a cart, J dv/dt = u - c v, with measured position: x = [position, velocity].

    inertia J [kg m^2 or kg], viscous_friction c [N m s/rad or N s/m]. In continuous time.
    """
    return Plant(
        *_core.damped_inertia(
            finite(inertia, "inertia"), finite(viscous_friction, "viscous_friction")
        )
    )


def observability_rank(A: Matrix, C: Matrix) -> int:
    """The rank of [C; C A; ...] with balanced columns. (A, C) is observable if it is n."""
    return _apart(_core.observability_rank, *_matrices(A=A, C=C))


class QpSolver(Rebuilt):
    """Solves quadratic programs of one shape. Each solve starts from the last solution:

        minimise z' H z / 2 + g' z   subject to   lower <= Omega z <= upper.

    H (n, n) symmetric positive definite, Omega (m, n). solver: active_set is exact (a dual active-set method).
    hildreth, the method of the thesis, is coordinate ascent on the dual with at most max_iterations sweeps.
    """

    def __init__(
        self, H: Matrix, Omega: Matrix, *, solver: str = "active_set", max_iterations: int = 1000
    ):
        H, Omega = _matrices(H=H, Omega=Omega)
        is_exact = one_of(solver, "solver", ("active_set", "hildreth")) == "active_set"
        self._qp = _apart(_core.Qp, H, Omega, is_exact, whole(max_iterations, "max_iterations"))
        self._rows, self._variables = Omega.shape
        self._hard = np.zeros(self._rows)
        self._none = self._hard - np.inf, self._hard + np.inf

    def _bounds(self, given: Matrix | None, otherwise: np.ndarray, name: str) -> np.ndarray:
        if given is None:
            return otherwise
        values = numbers(given, name)
        if values.shape != (self._rows,):
            raise InputError(f"{name}: must be {self._rows} numbers, is {description(given)}")
        if np.isnan(values).any():
            raise InputError(f"{name}: must not be nan")
        return values

    def solve(
        self,
        g: Matrix,
        lower: Matrix | None = None,
        upper: Matrix | None = None,
        softness: Matrix | None = None,
    ) -> QpSolution:
        """Solve one program.

        g (n). lower, upper (m): infinity or None means no bound. softness (m), at least 0: a constraint with
        softness s may be violated by v, which costs v^2/(2 s).
        """
        soft = self._hard if softness is None else vector(softness, "softness", self._rows)
        if (soft < 0.0).any():
            raise InputError("softness: must not be negative")
        both = self._bounds(lower, self._none[0], "lower"), self._bounds(upper, self._none[1], "upper")
        return QpSolution(*self._qp.solve(vector(g, "g", self._variables), *both, soft))

    def reset(self) -> None:
        """Forget the last solution."""
        self._qp.reset()


def solve_qp(
    H: Matrix,
    g: Matrix,
    Omega: Matrix,
    lower: Matrix | None = None,
    upper: Matrix | None = None,
    softness: Matrix | None = None,
    *,
    solver: str = "active_set",
    max_iterations: int = 1000,
) -> QpSolution:
    """Solve one quadratic program. See QpSolver."""
    return QpSolver(H, Omega, solver=solver, max_iterations=max_iterations).solve(
        g, lower, upper, softness
    )


class PlanarChain:
    """A planar serial manipulator from a URDF file: kinematics, masses and limits.

    Its tip is the frame of the one link without children. InputError, with file and line, if the file is not
    a URDF of a planar chain.
    """

    _core: _core.PlanarChain

    def __init__(self, urdf: str):
        self._core = _core.PlanarChain(text_or_none(urdf, "urdf") or "")

    @classmethod
    def _of(cls, core: _core.PlanarChain) -> PlanarChain:
        chain = cls.__new__(cls)
        chain._core = core
        return chain

    @property
    def joints(self) -> int:
        """The number n of joints."""
        return self._core.joints

    @property
    def effort_limits_Nm(self) -> np.ndarray:
        """The torque limits of the joints (n) [N m]."""
        return self._core.effort_limits_Nm

    def _angles(self, q_rad: Matrix) -> np.ndarray:
        angles = vector(q_rad, "q_rad")
        if len(angles) != self.joints:
            raise InputError(f"q_rad: must be {self.joints} angles, is {description(q_rad)}")
        return angles

    def tip_pose(self, q_rad: Matrix) -> np.ndarray:
        """The tip's x, y and angle [m, m, rad] at the joint angles q_rad (n) [rad]."""
        return self._core.tip_pose(self._angles(q_rad))

    def tip_jacobian(self, q_rad: Matrix) -> np.ndarray:
        """The derivative of the pose with respect to the angles, (3, n)."""
        return self._core.tip_jacobian(self._angles(q_rad))

    def mass_matrix(self, q_rad: Matrix) -> np.ndarray:
        """(n, n) [kg m^2], symmetric positive definite, without the motors' armature."""
        return self._core.mass_matrix(self._angles(q_rad))
