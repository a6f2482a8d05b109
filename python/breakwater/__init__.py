"""Breakwater: a headless testbed for robust model-based motion control.

    import breakwater as bw
    run = bw.run("arm_wall_contact", case="hpfc-2N", set={"wall.distance_m": 0.1})
    run.metrics["peak_force_filtered_N"]      # the metrics
    run["force_true_N"], run.time_s           # the log, as NumPy arrays without a copy
    run.to_pandas(), run.to_xarray()
    run.video("impact.mp4", speed=0.1)
    table = bw.sweep("motor_estimation", case=["idob", "stf"], vary={"encoder.bits": [6, 8, 10]}, seeds=range(1, 21))

Runs:         run, load, scenarios, cases; Run
Many runs:    sweep, tune, compare; Comparison
Your own:     Controller, Estimator; ArmSample, AxisSample, PlantSample, QuadrotorSample;
              PlanarChain
Design:       dare, lqr, place_poles, place_observer_poles, zero_order_hold, damped_inertia,
              extend_by_disturbance_model, observability_rank; QpSolver, solve_qp
On your data: identify; Identification, IdentifiedParameter; Observer, by name (also AxisObserver), or Stf, Qvff,
              Vfakfd, Fakfd, Kfd, Idob, Mdob, StateObserver; QuadrotorFilter
Errors:       InputError, RunFailed

docs/tutorials/python.md has the tutorial.
"""

from ._core import __version__
from .comparisons import Comparison, compare
from .errors import InputError
from .identification import IdentifiedParameter, Identification, identify
from .linear import (
    PlanarChain,
    Plant,
    QpSolution,
    QpSolver,
    Regulator,
    damped_inertia,
    dare,
    extend_by_disturbance_model,
    lqr,
    observability_rank,
    place_observer_poles,
    place_poles,
    solve_qp,
    zero_order_hold,
)
from .named_observers import Fakfd, Idob, Kfd, Mdob, Qvff, StateObserver, Stf, Vfakfd
from .observers import Estimates, Motions, Observer, QuadrotorFilter
from .parts import Controller, Estimator
from .runs import Run, RunFailed, cases, load, run, scenarios
from .samples import ArmSample, AxisSample, PlantSample, QuadrotorSample
from .sweeps import sweep, tune

AxisObserver = Filter = Observer

__all__ = [
    "ArmSample",
    "AxisObserver",
    "AxisSample",
    "Comparison",
    "Controller",
    "Estimates",
    "Estimator",
    "Fakfd",
    "Filter",
    "Identification",
    "IdentifiedParameter",
    "Idob",
    "InputError",
    "Kfd",
    "Mdob",
    "Motions",
    "Observer",
    "PlanarChain",
    "Plant",
    "PlantSample",
    "QpSolution",
    "QpSolver",
    "QuadrotorFilter",
    "QuadrotorSample",
    "Qvff",
    "Regulator",
    "Run",
    "RunFailed",
    "StateObserver",
    "Stf",
    "Vfakfd",
    "__version__",
    "cases",
    "compare",
    "damped_inertia",
    "dare",
    "extend_by_disturbance_model",
    "identify",
    "load",
    "lqr",
    "observability_rank",
    "place_observer_poles",
    "place_poles",
    "run",
    "scenarios",
    "solve_qp",
    "sweep",
    "tune",
    "zero_order_hold",
]
