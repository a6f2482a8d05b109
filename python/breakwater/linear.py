"""Design of controllers and observers, and quadratic programs.

A matrix is anything that NumPy converts to one, with finite real numbers. An InputError names a wrong matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from .arguments import filled, finite
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


def dare(A: Matrix, B: Matrix, Q: Matrix, R: Matrix) -> Regulator:
    """The stabilising solution S of the discrete algebraic Riccati equation

        S = A' S A - A' S B (R + B' S B)^-1 B' S A + Q,

    and the gain K = (R + B' S B)^-1 B' S A of the regulator u = -K x. The regulator minimises the sum of x' Q x
    + u' R u for x(k+1) = A x(k) + B u(k). A (n, n), B (n, m), Q (n, n) symmetric positive semidefinite, R (m,
    m) symmetric positive definite. Method: structured doubling algorithm (Chu et al. 2004). If a mode allows no
    stabilising solution, the InputError names its eigenvalue.
    """
    return Regulator(*_core.dare(A, B, Q, R))


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


def _rows(matrix: Matrix, name: str, axis: int) -> int:
    shape = np.shape(matrix)
    if len(shape) not in (0, 2):
        raise InputError(f"{name}: must be a matrix, of two dimensions, is of shape {shape}")
    return shape[axis] if shape else 1


def place_observer_poles(
    A: Matrix, C: Matrix, poles: Sequence[complex] | Sequence[Sequence[complex]]
) -> np.ndarray:
    """L (n, p) such that A - L C has these eigenvalues.

    A (n, n), C (p, n). poles: n numbers for one output. For several outputs: a list per output with the poles
    that it places, n in total. A complex pole needs its conjugate. If the plant consists of decoupled
    chains, each keeps its own group (eigenstructure assignment, Moore 1976).
    """
    return _core.place_observer_poles(A, C, _groups(poles, _rows(C, "C", 0), "output"))


def place_poles(
    A: Matrix, B: Matrix, poles: Sequence[complex] | Sequence[Sequence[complex]]
) -> np.ndarray:
    """K (m, n) such that A - B K has these eigenvalues: place_observer_poles() of the transposed."""
    return _core.place_poles(A, B, _groups(poles, _rows(B, "B", 1), "input"))


def zero_order_hold(A: Matrix, B: Matrix, C: Matrix, period_s: float) -> Plant:
    """The plant dx/dt = A x + B u, y = C x, sampled exactly every period_s [s] with a held input."""
    return Plant(*_core.zero_order_hold(A, B, C, finite(period_s, "period_s")))


def extend_by_disturbance_model(
    A: Matrix, B: Matrix, C: Matrix, order: int, period_s: float
) -> Plant:
    """A sampled plant with the extended state [x; d; derivatives of d up to order].

    The disturbance d opposes the input. It is a step (order 0), ramp (1) or parabola (2).
    """
    return Plant(
        *_core.extend_by_disturbance_model(A, B, C, _whole(order, "order"), finite(period_s, "period_s"))
    )


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
    return _core.observability_rank(A, C)


def _whole(value: object, name: str) -> int:
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return int(value)
    raise InputError(f"{name}: must be a whole number, is {type(value).__name__}")


class QpSolver:
    """Solves quadratic programs of one shape. Each solve starts from the last solution:

        minimise z' H z / 2 + g' z   subject to   lower <= Omega z <= upper.

    H (n, n) symmetric positive definite, Omega (m, n). solver: active_set is exact (a dual active-set method).
    hildreth, the method of the thesis, is coordinate ascent on the dual with at most max_iterations sweeps.
    """

    def __init__(
        self, H: Matrix, Omega: Matrix, *, solver: str = "active_set", max_iterations: int = 1000
    ):
        self._qp = _core.Qp(H, Omega, str(solver), _whole(max_iterations, "max_iterations"))

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
        return QpSolution(*self._qp.solve(g, lower, upper, softness))

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
