"""Identification of an axis from recorded data: `breakwater identify` on arrays, DataFrames or files."""

from __future__ import annotations

import json
import os
import pathlib
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from .arguments import filled, finite, path_or_none, set_lines, text_or_none
from .commands import call, failure_of
from .errors import InputError

_COLUMNS = ("time_s", "u", "y")
_NOT_TO_BE_USED = 3  # exit status: not converged, or the held-out records disagree
_WARNING = "identify: warning: "


@dataclass(frozen=True)
class IdentifiedParameter:
    """A value with its 95 % interval. If it is not identifiable, `reason` and `excitation` say why and what would help."""

    value: float
    low: float
    high: float
    identifiable: bool
    reason: str = ""
    excitation: str = ""
    given: bool = False
    """Whether it is the given inertia."""
    too_narrow: bool = False
    """Whether the residuals are not white, so that the interval is too narrow."""


class Identification:
    """The result of bw.identify()."""

    def __init__(self, folder: pathlib.Path) -> None:
        entries = json.loads((folder / "identified.json").read_text(encoding="utf-8"))
        self.fit: dict[str, Any] = entries.pop("fit")
        """Errors, whiteness, noise, quantum and notes of the fit."""
        self.parameters: dict[str, IdentifiedParameter] = {
            key: IdentifiedParameter(**entry) for key, entry in entries.items()
        }
        """By their names in identified.json: "inertia_kgm2", "coulomb_Nm", …"""
        self._toml = (folder / "identified.toml").read_text(encoding="utf-8")
        self._report = (folder / "report.html").read_text(encoding="utf-8")

    @property
    def converged(self) -> bool:
        """Whether the fit ended at a maximum of the likelihood."""
        return self.fit["converged"]

    @property
    def holds(self) -> bool:
        """Whether the held-out records agree with the fit; True without such records."""
        return self.fit.get("holds", True)

    def to_toml(self, file: str | os.PathLike[str] | None = None) -> str:
        """The scenario file of motor_estimation, or of two_inertia, with this plant. It is also written to `file`, if given."""
        return _written(self._toml, file)

    def report(self, file: str | os.PathLike[str] | None = None) -> str:
        """The page with fit and residuals, as HTML. It is also written to `file`, if given."""
        return _written(self._report, file)

    def __repr__(self) -> str:
        lines = [
            f"{key} = {p.value:.6g} [{p.low:.6g}, {p.high:.6g}]" + ("" if p.identifiable else ", not identifiable")
            for key, p in self.parameters.items()
        ]
        return "\n".join(lines)


def identify(
    data: Any,
    *,
    holdout: Any = None,
    model: str = "axis",
    friction: str = "coulomb",
    inertia: float | None = None,
    set: Mapping[str, Any] | None = None,
    out: str | os.PathLike[str] | None = None,
) -> Identification:
    """Find inertia, friction, offset and delay of an axis in recorded data, with 95 % intervals.

    data, holdout: a DataFrame, a dict, the name of a table, or a list of these. The columns are time_s [s],
       u [N m] and y [rad]. The held-out records check the fit, which does not use them.
    model: "axis", or "two_inertia": a motor and a load with a spring and backlash. friction: "coulomb", or
       "stribeck" for an axis.
    inertia: the known inertia [kg m²], with "two_inertia" that of the motor. The torque constant is then found
       instead.
    set: keys of table and encoder, such as {"csv.input_scale": 0.068, "encoder.quantum": 0.0}.
    out: the folder for identified.json, identified.toml, draws.csv, estimate.toml and report.html. By default nothing is kept.

    A fit that did not converge, or that the held-out records contradict, gives a Python warning; see .converged
    and .holds. So do repairs of a table, and parameters that are not identifiable. Raises InputError for wrong
    arguments or records.
    """
    lines = set_lines(set)
    with tempfile.TemporaryDirectory(prefix="breakwater_identify_") as temporary:
        folder = pathlib.Path(temporary)
        result, copy = folder / "result", path_or_none(out, "out")
        words = ["identify", f"--model={text_or_none(model, 'model')}"]
        words += [f"--friction={text_or_none(friction, 'friction')}", f"--out={result}"]
        words += [f"--set={line}" for line in lines]
        if inertia is not None:
            words.append(f"--inertia={finite(inertia, 'inertia')!r}")
        if holdout is not None:
            words += [f"--holdout={file}" for file in _files(holdout, "holdout", folder)]
        status, said = call([*words, "--", *_files(data, "data", folder)])
        said = [line.removeprefix(_WARNING).replace(f"{folder}/", "") for line in said]
        if status not in (0, _NOT_TO_BE_USED) or not (result / "identified.json").exists():
            raise failure_of(status, said[-1] if said else f"identify: exit status {status}")
        for line in said:
            warnings.warn(line, stacklevel=2)
        if copy is not None:
            _core.copy_run(result, copy)
        return Identification(result)


def _written(text: str, file: Any) -> str:
    if file is not None:
        pathlib.Path(path_or_none(file, "file")).write_text(text, encoding="utf-8")
    return text


def _files(data: Any, name: str, folder: pathlib.Path) -> list[str]:
    records = data if isinstance(data, Sequence) and not isinstance(data, (str, bytes)) else [data]
    return [_file(record, folder / f"{name}_{i}.csv", name) for i, record in enumerate(records, 1)]


def _file(record: Any, file: pathlib.Path, name: str) -> str:
    if isinstance(record, (str, bytes, os.PathLike)):
        return path_or_none(record, name)
    try:
        columns = [filled(record[column], float) for column in _COLUMNS]
        table = np.column_stack(columns)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputError(f"{name}: must have the columns time_s, u and y of equal length: {error}") from None
    np.savetxt(file, table, fmt="%.17g", delimiter=",", header=",".join(_COLUMNS), comments="")
    return str(file)
