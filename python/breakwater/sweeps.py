"""Studies with many runs, and tunings, as one table."""

from __future__ import annotations

import errno
import operator
import os
import pathlib
import re
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _core
from .arguments import did_you_mean, mapping, path_or_none, set_lines, text_or_none, toml_text
from .commands import call, call_copy, failure_of
from .errors import InputError, as_argument
from .parts import Controller, Estimator
from .runs import checked_parts

if TYPE_CHECKING:
    import pandas

_DISTRIBUTIONS = ("uniform", "log_uniform", "normal")
_RULE = re.compile(r"(lin|log)\(")
_WARNING = re.compile(r"^(?:sweep|tune): warning: ")
_MOST_JOBS = 4096


def _kind(value: Any) -> str:
    return repr(value) if isinstance(value, str) else f"of type {type(value).__name__}"


def _values(value: Any, name: str, wish: str) -> list[Any]:
    """A list, range or array as a list with at least one entry."""
    if not isinstance(value, (list, tuple, range)):
        array = np.asanyarray(value) if hasattr(value, "__array__") else None
        if array is None or array.ndim == 0:
            raise InputError(f"{name}: must be {wish}, is {_kind(value)}")
        value = array.tolist()
    if len(value) == 0:
        raise InputError(f"{name}: is empty")
    return list(value)


def _names(value: Any, name: str) -> str:
    """One or several words as a comma-separated list for the command line."""
    words = [value] if isinstance(value, str) else _values(value, name, "a str or a list of them")
    for word in words:
        if not isinstance(word, str):
            raise InputError(f"{name}: must be a str or a list of them, has one {_kind(word)}")
        if not word or "," in word:
            raise InputError(f"{name}: there is no {word!r}")
    return ",".join(words)


def _whole(value: Any, name: str) -> int:
    try:
        if not isinstance(value, (bool, np.bool_)):
            number = operator.index(value)
            str(number)
            return number
    except TypeError:
        pass
    except ValueError:  # Python does not write so many digits
        raise InputError(f"{name}: is too large") from None
    raise InputError(f"{name}: must be a whole number, is {_kind(value)}")


def _seeds(value: Any) -> str:
    if isinstance(value, range) and value.step == 1 and len(value) > 0:
        return f"{value[0]}..{value[-1]}"
    seeds = _values(value, "seeds", "a range or a list of whole numbers")
    return ",".join(str(_whole(seed, "seeds")) for seed in seeds)


def _varied(value: Any, name: str) -> str:
    """The values of a varied key for the command line."""
    if isinstance(value, str) and _RULE.match(value):
        return value
    if isinstance(value, Mapping):
        if len(value) != 1:
            raise InputError(f"{name}: must be one distribution, has {len(value)}")
        ((kind, numbers),) = value.items()
        if kind not in _DISTRIBUTIONS:
            near = did_you_mean(kind, list(_DISTRIBUTIONS))
            raise InputError(f"{name}: there is no distribution {kind!r}{near}")
        both = _values(numbers, f"{name}: {kind}", "two numbers")
        return f"{kind}({','.join(toml_text(number, name) for number in both)})"
    wish = 'a list of values, "lin(a,b,n)", "log(a,b,n)" or {"uniform": [a, b]}'
    return ",".join(toml_text(entry, name) for entry in _values(value, name, wish))


def _keys(values: Any, name: str) -> Mapping[str, Any]:
    for key in mapping(values, name):
        if not key or "=" in key:
            raise InputError(f"{name}: there is no key {key!r}")
    return mapping(values, name)


def _table(file: pathlib.Path) -> pandas.DataFrame:
    """Read a table of a study without loss of digits."""
    import pandas

    columns = list(pandas.read_csv(file, nrows=0).columns)
    texts = [name for name in ("point", "case", "status", "state_hash") if name in columns]
    metrics = columns[columns.index("state_hash") + 1 :] if "state_hash" in columns else []
    table = pandas.read_csv(
        file,
        dtype=dict.fromkeys(texts, str) | dict.fromkeys(metrics, np.float64),
        keep_default_na=False,
        na_values=[""],
        float_precision="round_trip",
    )
    table[texts] = table[texts].fillna("")
    return table


def sweep(
    study: str | os.PathLike[str],
    *,
    case: str | Sequence[str] | None = None,
    vary: Mapping[str, Any] | None = None,
    seeds: npt.ArrayLike | range | None = None,
    set: Mapping[str, Any] | None = None,
    duration: float | None = None,
    config: str | os.PathLike[str] | None = None,
    method: str | None = None,
    samples: int | None = None,
    sampling_seed: int | None = None,
    baseline: str | None = None,
    metrics: str | Sequence[str] | None = None,
    goal: Mapping[str, str] | None = None,
    worlds: str | None = None,
    keep: str | None = None,
    jobs: int | None = None,
    out: str | os.PathLike[str] | None = None,
    rerun: bool = False,
    controller: Controller | None = None,
    estimator: Estimator | None = None,
    controllers: Mapping[str, Controller] | None = None,
    estimators: Mapping[str, Estimator] | None = None,
) -> pandas.DataFrame:
    """Run a study on all cores, and return its results.csv.

    The table has a row for each combination of values, in it for each seed, in it for each case. Columns:
    `point`, `case`, `seed`, the varied keys, `status`, `state_hash`, and every metric (NaN if a run lacks it).

    study: a scenario, a scenario file, a study file ("study.toml"), or the folder of a study, which is then continued. The other
       arguments have priority over a study file.
    case: one case, several to compare, or "all".
    vary: keys with their values: [6, 8, 10] or an array, "lin(a,b,n)", "log(a,b,n)". Random methods also take
       {"uniform": [a, b]}, {"log_uniform": [a, b]}, {"normal": [mean, deviation]}.
    seeds: integers, the same for each sample and case.
    set, duration [s], config: for every run, as in bw.run().
    method: "grid" (every combination, the default), "list", "random", "lhs", "sobol" or "saltelli". Random
       methods draw `samples` samples with `sampling_seed`.
    jobs: number of parallel runs; default: all cores.
    out: the study's folder, with the same bytes as from `breakwater sweep`. An existing study is continued, and
       may grow by seeds, values, cases or samples; rerun=True begins again. The folder has report.html and, for several cases, comparison.csv. By default
       nothing is kept.
    baseline: the case that the others are compared with.
    metrics: the compared metrics; default: all.
    goal: the better direction of metrics, {"peak_force_filtered_N": "min"}.
    worlds: the blocks of the comparison: "samples" (repeated by the seeds; without varied keys the seeds), or
       "seeds" (each seed of every sample).
    keep: the run folders to keep as runs/POINT: "metrics" (none), "failed" or "all".

    Failed runs are rows with `status` "failed". Python warnings report ineffective keys, seeds that change
    nothing, and metrics that some runs lack. Raises InputError for wrong arguments, keys, values or folders
    before anything runs. It is also raised if results cannot be written (a full disk) or points were left
    undone; repeat the call to continue. Raises RuntimeError if a run failed and the study file demands to stop
    then. Ctrl-C stops the study and keeps the finished runs in out.

    controller, estimator, controllers, estimators: objects of your own classes for every run, as in bw.run(). Each
    run has a copy of this process, and so begins with the objects as you gave them. Later changes of them stay
    there. An exception of them ends the study with InputError. A folder is continued by the same classes and data.
    """
    import pandas  # raises ImportError before the runs, not after

    parts = checked_parts(controller, estimator, controllers, estimators)
    target = path_or_none(study, "study")
    if target is None:
        raise InputError("study: must be a scenario, a scenario file, a study file or a study's folder, is None")
    is_folder = target not in _core.scenarios() and pathlib.Path(target).is_dir()
    folder = path_or_none(out, "out")
    of_folder = {"baseline": baseline, "metrics": metrics, "goal": goal, "worlds": worlds, "keep": keep}
    for name, value in of_folder.items():
        if value is not None and folder is None and not is_folder:
            raise InputError(f"{name}: says what is left in the study's folder: give out=")

    lines = set_lines(set)
    if duration is not None:
        lines += set_lines({"run.duration_s": duration})
    varied = _keys(vary, "vary")
    goals = _keys(goal, "goal")
    if jobs is not None and not 1 <= _whole(jobs, "jobs") <= _MOST_JOBS:
        raise InputError(f"jobs: must be 1 to {_MOST_JOBS}, is {jobs}")
    options = [
        ("case", None if case is None else _names(case, "case")),
        ("config", path_or_none(config, "config")),
        *(("set", line) for line in lines),
        *(("vary", f"{key}={_varied(value, f'vary: {key}')}") for key, value in varied.items()),
        ("seeds", None if seeds is None else _seeds(seeds)),
        ("method", text_or_none(method, "method")),
        ("samples", None if samples is None else _whole(samples, "samples")),
        ("sampling-seed", None if sampling_seed is None else _whole(sampling_seed, "sampling_seed")),
        ("baseline", text_or_none(baseline, "baseline")),
        ("metrics", None if metrics is None else _names(metrics, "metrics")),
        *(("goal", f"{key}={text_or_none(value, f'goal: {key}')}") for key, value in goals.items()),
        ("worlds", text_or_none(worlds, "worlds")),
        ("keep", text_or_none(keep, "keep")),
        ("jobs", None if jobs is None else _whole(jobs, "jobs")),
    ]
    for name, value in (("study", target), ("out", folder), *options):
        if value == "":
            raise InputError(f"{name}: is empty")
    words = ["sweep", "--quiet", *(f"--{name}={value}" for name, value in options if value is not None)]
    if rerun:
        words.append("--rerun")
    return _run(words, target, folder, is_folder, parts, "results.csv")


def tune(
    tuning: str | os.PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    duration: float | None = None,
    jobs: int | None = None,
    out: str | os.PathLike[str] | None = None,
    rerun: bool = False,
    controller: Controller | None = None,
    estimator: Estimator | None = None,
    controllers: Mapping[str, Controller] | None = None,
    estimators: Mapping[str, Estimator] | None = None,
) -> pandas.DataFrame:
    """Search for the best values of some keys, like `breakwater tune`, and return the table of what it found.

    The table is front.csv: a row for each point of the Pareto front of each case. With one objective it is
    tuned.csv: a row for each tuned case, the best first.

    tuning: a tuning's file ("tune.toml"), or the folder of a tuning, which is then continued. set, duration [s],
    jobs, out, rerun and objects of your own: as in bw.sweep(). Raises InputError like bw.sweep(), and RuntimeError
    if no candidate met the constraints.
    """
    import pandas  # raises ImportError before the runs, not after

    parts = checked_parts(controller, estimator, controllers, estimators)
    target = path_or_none(tuning, "tuning")
    if target is None:
        raise InputError("tuning: must be a tuning's file or a tuning's folder, is None")
    lines = set_lines(set)
    if duration is not None:
        lines += set_lines({"run.duration_s": duration})
    if jobs is not None and not 1 <= _whole(jobs, "jobs") <= _MOST_JOBS:
        raise InputError(f"jobs: must be 1 to {_MOST_JOBS}, is {jobs}")
    words = ["tune", "--quiet", *(f"--set={line}" for line in lines)]
    if jobs is not None:
        words.append(f"--jobs={jobs}")
    if rerun:
        words.append("--rerun")
    is_folder = pathlib.Path(target).is_dir()
    return _run(words, target, path_or_none(out, "out"), is_folder, parts, "front.csv", "tuned.csv")


def _run(
    words: list[str], target: str, out: str | None, is_folder: bool, parts: list[Any], *tables: str
) -> pandas.DataFrame:
    """Call a command, and read the first of the tables that its folder has."""
    if any(parts):
        words.append("--isolate")
        if not is_folder:
            words += [f"--set={line}" for line in _core.choices(target, tuple(parts))]
    if out is not None or is_folder:
        words += [] if out is None else [f"--out={out}"]
        return _read(words, target, pathlib.Path(out or target), parts, tables)
    with tempfile.TemporaryDirectory(prefix="breakwater_study_") as temporary:
        return _read([*words, f"--out={temporary}"], target, pathlib.Path(temporary), parts, tables)


def _read(
    words: list[str], target: str, folder: pathlib.Path, parts: list[Any], tables: tuple[str, ...]
) -> pandas.DataFrame:
    words += ["--", target]
    try:
        status, lines = call_copy(words, parts) if any(parts) else call(words)
    except OSError as error:
        if error.errno != errno.E2BIG:
            raise
        raise InputError("vary: has too many values for a command: write a study file") from None
    lines = [as_argument(_WARNING.sub("", line)) for line in lines]
    if status < 0:
        raise RuntimeError(f"{words[0]}: the program was ended by signal {-status}")
    if status != 0:
        raise failure_of(status, lines[-1] if lines else f"{words[0]}: exit status {status}")
    for line in lines:
        warnings.warn(line, stacklevel=4)
    return _table(next(file for name in tables if (file := folder / name).exists()))
