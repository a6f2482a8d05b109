"""Observers by the names of their methods. Their arguments are the rows of the bindings' table."""

from __future__ import annotations

import inspect
import keyword
import tomllib

from . import _core
from .linear import damped_inertia
from .observers import Observer, default_of

_TABLE = {
    name: (summary, [(key, text, takes, value or default_of(name, key)) for key, text, takes, value in keys])
    for name, summary, keys in _core.observers()
}


def _signature(name: str) -> inspect.Signature:
    """That of Observer, with the keys of the observer in place of **keys."""
    *common, _ = list(inspect.signature(Observer.__init__).parameters.values())
    given = {parameter.name for parameter in common}
    own = []
    for key, _, _, value in _TABLE[name][1]:
        default = tomllib.loads(f"x = {value}")["x"] if value else inspect.Parameter.empty
        if key not in given:
            argument = key + "_" * keyword.iskeyword(key)
            own.append(inspect.Parameter(argument, inspect.Parameter.KEYWORD_ONLY, default=default))
    return inspect.Signature([p for p in common if p.name not in ("self", "name")] + own)


def _class(name: str, title: str) -> type[Observer]:
    summary, keys = _TABLE[name]

    def make(self: Observer, *plant: object, **arguments: object) -> None:
        Observer.__init__(self, name, *plant, **arguments)

    rows = [f"{key}: {text}. Takes {takes}" + (f"; {value} without it." if value else ".")
            for key, text, takes, value in keys]
    words = "\n".join([f"Observer(\"{name}\", …): {summary}.", "", *rows])
    return type(title, (Observer,), {"name": name, "__init__": make, "__doc__": words, "__module__": __name__,
                                     "__signature__": _signature(name)})


StateObserver = _class("state_observer", "StateObserver")
Idob = _class("idob", "Idob")
Kfd = _class("kfd", "Kfd")
Fakfd = _class("fakfd", "Fakfd")
Vfakfd = _class("vfakfd", "Vfakfd")
Qvff = _class("qvff", "Qvff")
Stf = _class("stf", "Stf")


def Mdob(inertia: float, **arguments: object) -> Observer:
    """Observer("mdob", …) of J dv/dt = u - d with the inertia J [kg m^2 or kg]."""
    return Observer("mdob", *damped_inertia(inertia), **arguments)
