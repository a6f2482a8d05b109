"""Runs: made here, or read from the folder of an earlier run."""

from __future__ import annotations

import base64
import contextlib
import functools
import gzip
import html
import os
import pathlib
import re
import shutil
import sys
import tempfile
import tomllib
import types
import warnings
import weakref
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from .arguments import checked_path, did_you_mean, mapping, path_or_none, set_lines, text_or_none
from .commands import call, failure_of
from .errors import InputError
from .parts import Controller, Estimator

if TYPE_CHECKING:
    import pandas
    import xarray

_CONTROL = "control"
_FILES = ("config.toml", "metrics.json", "manifest.json", "log.h5")
_LARGEST_FRAME = 3_000_000  # characters of a replay, which a notebook stores
# The page in the frame unpacks itself. Most of it is three.js, which compresses to a quarter.
_UNPACK = """<!doctype html><script>(async () => {
const packed = Uint8Array.from(atob("PACKED"), (c) => c.charCodeAt(0));
const page = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
const text = await new Response(page).text();
document.open(); document.write(text); document.close();
})();</script>"""
_PLACE = re.compile(r"(?:(?P<group>[^/\[]+)/)?(?P<name>[^/\[]+)(?:\[(?P<index>[1-9][0-9]*)\])?")


class RunFailed(RuntimeError):
    """A run that ended early: the plant diverged, a sensor failed, or a command was not finite.

    time_s: time of the failure [s]. reason: one line. run: the run with its log so far, without metrics.
    """

    time_s: float
    reason: str
    run: Run

    def __init__(self, time_s: float, reason: str, run: Run):
        super().__init__(f"failed at t = {time_s:.6g} s: {reason}")
        self.time_s = time_s
        self.reason = reason
        self.run = run

    def __reduce__(self) -> tuple[Any, ...]:
        return RunFailed, (self.time_s, self.reason, self.run)


def checked_parts(controller: Any, estimator: Any, controllers: Any, estimators: Any) -> list[Any]:
    """The parts as _core takes them: two objects or None, and two dicts."""
    if controller is not None and estimator is not None:
        raise InputError("estimator: a controller in Python uses none: update your estimator in its update()")
    controllers, estimators = mapping(controllers, "controllers"), mapping(estimators, "estimators")
    for name, one, several in (("controller", controller, controllers), ("estimator", estimator, estimators)):
        if one is not None and several:
            raise InputError(f"{name}s: {name} is given too, for all axes: leave one of both out")
    for axis in controllers.keys() & estimators.keys():
        raise InputError(f"estimators: {axis}: its controller in Python uses none: update your estimator in its update()")
    return [
        _part(controller, Controller, "controller"),
        _part(estimator, Estimator, "estimator"),
        _parts(controllers, Controller, "controller"),
        _parts(estimators, Estimator, "estimator"),
    ]


def _part(value: Any, base: type, name: str, is_needed: bool = False) -> Any:
    if isinstance(value, base) or (value is None and not is_needed):
        return value
    hint = " (did you mean an object of it?)" if isinstance(value, type) else ""
    raise InputError(f"{name}: must be a bw.{base.__name__}, is {type(value).__name__}{hint}")


def _parts(given: Mapping[str, Any], base: type, kind: str) -> dict[str, Any]:
    axes: dict[int, str] = {}
    for axis, part in given.items():
        if (other := axes.setdefault(id(part), axis)) != axis:
            raise InputError(f"{kind}s: {axis}: its object is that of {other}: each axis needs one of its own")
    return {axis: _part(part, base, f"{kind}s: {axis}", True) for axis, part in given.items()}


class _Handle:
    """A controller or estimator for the run, with the name of its class. The handle can release the part: the
    run keeps the handle, and the part may keep the run."""

    def __init__(self, part: Any):
        self.__dict__.update(
            part=part, reset=part.reset, update=part.update, signals=part.signals
        )

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self.part, name, value)

    def let_go(self) -> None:
        self.__dict__.clear()


@functools.lru_cache(maxsize=None)
def _handle_class(name: str) -> type[_Handle]:
    return type(name, (_Handle,), {})


def _handle(part: Any) -> _Handle | None:
    return None if part is None else _handle_class(type(part).__name__)(part)


class _Metrics(dict[str, float]):
    """The metrics of a run. A missing one is a KeyError that says why."""

    def __init__(self, values: dict[str, float], run: Run):
        super().__init__(values)
        self._run = run

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)

    def __missing__(self, name: str) -> float:
        if self._run.failure is not None:
            raise KeyError(f"{name}: the run failed, and has no metrics")
        if reason := self._run.absent.get(name):
            raise KeyError(f"{name}: {reason}")
        raise KeyError(f"{name}: the run has no such metric{did_you_mean(name, list(self))}")


class Run:
    """One run: its metrics, its log, and its configuration.

    run["force_true_N"] is a signal of the log at the control rate. It is an array of shape (samples,) or
    (samples, width): a read-only view without a copy, which keeps the run alive. NAME[2] is the second value of
    a vector, GROUP/NAME a signal of another group ("physics/force_true_N"), and time_s has the times.
    """

    def __init__(self, core: Any, folder: pathlib.Path | None, warnings: list[str]):
        self._core = core
        self._folder = folder and folder.absolute()
        self._warnings = warnings
        self._config: dict[str, Any] | None = None
        self._copy: pathlib.Path | None = None
        self._arrays: dict[tuple[str, str], np.ndarray] = {}
        self._facts = types.SimpleNamespace(**core.facts)
        self._signals = {
            (group, name): (unit, description, width)
            for group, name, unit, description, width in self._facts.signals
        }

    def __reduce__(self) -> tuple[Any, ...]:
        trouble = self._trouble()
        self._check_data(trouble, "pickle")
        with self._some_folder(trouble is None) as folder:
            files = {name: (folder / name).read_bytes() for name in _FILES if (folder / name).exists()}
        return _unpickled, (files, self._folder, self._warnings)

    @property
    def scenario(self) -> str:
        """The scenario's name."""
        return self._facts.scenario

    @property
    def case(self) -> str:
        """The case's name."""
        return self._facts.case

    @property
    def metrics(self) -> dict[str, float]:
        """The metrics, with the unit in the name; empty if the run failed or was cut."""
        return _Metrics(self._facts.metrics, self)

    @property
    def absent(self) -> dict[str, str]:
        """Why the run does not have a metric, for each of the scenario's metrics that it does not have.

        Empty if the run failed or was cut, or if an older version wrote its folder.
        """
        return dict(self._facts.absent)

    @property
    def state_hash(self) -> str:
        """16 hexadecimal digits computed from all states: equal configurations give equal hashes.

        Empty if the run was cut.
        """
        return self._facts.state_hash

    @property
    def folder(self) -> pathlib.Path | None:
        """The folder of the run; None if it is not saved."""
        return self._folder

    @property
    def warnings(self) -> list[str]:
        """Warnings about the run, one line each."""
        return list(self._warnings)

    @property
    def config_text(self) -> str:
        """The effective configuration as a scenario file, which reproduces the run to the bit."""
        return self._facts.config_text

    @property
    def config(self) -> dict[str, Any]:
        """The configuration as a dict: config["wall"]["distance_m"]."""
        if self._config is None:
            self._config = tomllib.loads(self.config_text)
        return self._config

    @property
    def failure(self) -> tuple[float, str] | None:
        """Time [s] and reason of a failure, or of the end of a run that was cut; None without one."""
        return self._facts.failure

    @property
    def time_s(self) -> np.ndarray:
        """The times of the control samples, (samples,) [s]."""
        return self["time_s"]

    @property
    def signals(self) -> list[str]:
        """The names for run[...], without the times: NAME, or GROUP/NAME outside of `control`."""
        return [name if group == _CONTROL else f"{group}/{name}" for group, name in self._signals]

    @property
    def groups(self) -> list[str]:
        """The groups of the log: `control`, and in some scenarios `physics`, at the engine's rate."""
        return list(dict.fromkeys(group for group, _ in self._signals))

    def _place(self, signal: str) -> tuple[str, str, int | None]:
        match = _PLACE.fullmatch(signal) if isinstance(signal, str) else None
        if match is not None:
            group = match["group"] or _CONTROL
            name = match["name"]
            if (group, name) in self._signals or (name == "time_s" and group in self.groups):
                return group, name, int(match["index"]) if match["index"] else None
        near = did_you_mean(signal, self.signals)
        raise KeyError(f"signal: there is no {signal!r} in the log{near}")

    def __getitem__(self, signal: str) -> np.ndarray:
        group, name, index = self._place(signal)
        if (group, name) not in self._arrays:
            rows = self._core.array(group, name)
            self._arrays[group, name] = rows[:, 0] if rows.shape[1] == 1 else rows
        values = self._arrays[group, name]
        if index is None:
            return values
        width = 1 if values.ndim == 1 else values.shape[1]
        if index > width:
            raise KeyError(f"signal: {signal!r}: has {width} value{'s' if width > 1 else ''}")
        return values if values.ndim == 1 else values[:, index - 1]

    def __iter__(self) -> Iterator[str]:
        """The names of the signals."""
        return iter(self.signals)

    def __contains__(self, signal: object) -> bool:
        try:
            self._place(signal)  # type: ignore[arg-type]
        except KeyError:
            return False
        return True

    def unit(self, signal: str) -> str:
        """The unit of a signal: "N"; for a vector with different units "m, m, rad"."""
        group, name, _ = self._place(signal)
        return "s" if name == "time_s" else self._signals[group, name][0]

    def description(self, signal: str) -> str:
        """A description of a signal in one line."""
        group, name, _ = self._place(signal)
        return "time of each row" if name == "time_s" else self._signals[group, name][1]

    def _of_group(self, group: str) -> dict[str, tuple[str, str, int]]:
        if group not in self.groups:
            raise InputError(f"group: must be one of {', '.join(self.groups)}, is {group!r}")
        return {name: about for (g, name), about in self._signals.items() if g == group}

    def to_pandas(self, group: str = _CONTROL) -> pandas.DataFrame:
        """A group of the log as a DataFrame with the index time_s. A vector has columns NAME_1, NAME_2, ..."""
        import pandas

        columns = {}
        for name, (_, _, width) in self._of_group(group).items():
            values = self[f"{group}/{name}"]
            if values.ndim == 1:
                columns[name] = values
            else:
                columns.update({f"{name}_{i + 1}": values[:, i] for i in range(width)})
        return pandas.DataFrame(
            columns, index=pandas.Index(self[f"{group}/time_s"], name="time_s"), copy=True
        )

    def to_xarray(self, group: str = _CONTROL) -> xarray.Dataset:
        """A group of the log as a Dataset over time_s, with units.

        The second dimension of a vector with n values is index_n, from 1 to n.
        """
        import xarray

        variables: dict[str, Any] = {}
        coordinates: dict[str, Any] = {
            "time_s": ("time_s", self[f"{group}/time_s"], {"units": "s"})
        }
        for name, (unit, description, width) in self._of_group(group).items():
            values = self[f"{group}/{name}"]
            dimensions = ["time_s"]
            if values.ndim == 2:
                dimensions.append(f"index_{width}")
                coordinates[f"index_{width}"] = np.arange(1.0, width + 1.0)
            variables[name] = (dimensions, values, {"units": unit, "description": description})
        attributes = {
            "scenario": self.scenario,
            "case": self.case,
            "state_hash": self.state_hash,
        }
        return xarray.Dataset(variables, coordinates, attributes)

    def save(self, folder: str | os.PathLike[str]) -> pathlib.Path:
        """Write config.toml, metrics.json, manifest.json and log.h5 into a folder, and return it.

        An earlier run in the folder is replaced.
        """
        target = pathlib.Path(checked_path(folder, "folder"))
        if isinstance(self._core, _core.SavedRun):
            trouble = self._trouble()
            self._check_data(trouble, "save")
            if trouble is not None or self._folder is None or target.resolve() != self._folder.resolve():
                with self._some_folder(trouble is None) as folder:
                    _core.copy_run(folder, str(target))
        else:
            self._core.save(str(target))
        if self._folder is None:
            self._folder = target.absolute()
        return target

    def video(
        self,
        file: str | os.PathLike[str] | None = None,
        *,
        speed: float | None = None,
        from_s: float | None = None,
        to_s: float | None = None,
        camera: str | None = None,
        size: str | None = None,
        look: str | None = None,
    ) -> pathlib.Path:
        """Make a video of the run, like `breakwater video`, and return its file.

        The default file is video.mp4 in the run's folder. speed 0.1 is ten times slower than real time.

        Raises InputError for wrong arguments or a wrong folder, OSError if the file cannot be written (a full
        disk), and RuntimeError for another failure. All have the program's message.
        """
        options = {"speed": speed, "from": from_s, "to": to_s, "camera": camera, "size": size, "look": look}
        return self._picture("video", "video.mp4", file, options)

    def replay(
        self, file: str | os.PathLike[str] | None = None, *, camera: str | None = None
    ) -> pathlib.Path:
        """Make a page that plays the run in three dimensions, like `breakwater replay`, and return its file.

        The default file is replay.html in the run's folder. A notebook shows it for a run automatically.

        Raises InputError for wrong arguments or a wrong folder, OSError if the file cannot be written (a full
        disk), and RuntimeError for another failure. All have the program's message.
        """
        return self._picture("replay", "replay.html", file, {"camera": camera})

    def _picture(
        self, command: str, name: str, file: Any, options: Mapping[str, Any]
    ) -> pathlib.Path:
        if file is None and self._folder is None:
            raise InputError("file: must be given for a run that has no folder")
        trouble = self._trouble()
        self._check_data(trouble, command)
        if trouble is not None and file is None:
            raise InputError(f"file: must be given: {trouble}")
        target = path_or_none(file, "file") or str(self._folder / name)
        words = [command, "--quiet", f"--out={target}"]
        words += [f"--{option}={value}" for option, value in options.items() if value is not None]
        with self._some_folder(trouble is None) as folder:
            status, lines = call([*words, "--", str(folder)])
        if status != 0:
            raise failure_of(status, f"{command}: {' '.join(lines)}")
        return pathlib.Path(target)

    @contextlib.contextmanager
    def _some_folder(self, is_there: bool) -> Iterator[pathlib.Path]:
        """The folder of the run, or a temporary copy if the run is not saved or was replaced."""
        if self._folder is not None and is_there:
            yield self._folder
            return
        if self._copy is not None:
            yield self._copy
            return
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary) / "run"
            self._core.save(str(folder))
            yield folder

    def _check_data(self, trouble: str | None, use: str) -> None:
        """Raise InputError if the data was in a folder that no longer has it."""
        if trouble is not None and self._copy is None and isinstance(self._core, _core.SavedRun):
            raise InputError(f"{use}: {trouble}")

    def _trouble(self) -> str | None:
        """The reason why the folder no longer has the run; None if it has, or there never was one."""
        if self._folder is None:
            return None
        try:
            saved = _saved(self._folder)
        except InputError as error:
            return str(error)
        if (saved.facts["config_text"], saved.facts["state_hash"]) == (self.config_text, self.state_hash):
            return None
        return f"there is another run in {self._folder}"

    def __repr__(self) -> str:
        verb = "was cut" if self._facts.is_cut else "failed"
        state = f"{verb} at {self.failure[0]:.6g} s" if self.failure else f"{len(self.metrics)} metrics"
        if count := len(self._warnings):
            state += f", {count} warning{'' if count == 1 else 's'}"
        try:
            log = f"{len(self.time_s)} samples"
        except InputError:  # the folder is damaged
            log = "no log"
        end = f", state hash {self.state_hash}" if self.state_hash else ""
        return f"<Run {self.scenario} {self.case}: {log}, {state}{end}>"

    def _repr_html_(self) -> str:
        """The output in a notebook: the replay in a frame, or else the metrics and the reason."""
        with tempfile.TemporaryDirectory() as temporary:
            try:
                page = self.replay(pathlib.Path(temporary) / "replay.html").read_bytes()
            except (OSError, RuntimeError, ValueError) as error:
                return self._table(str(error))
        packed = base64.b64encode(gzip.compress(page, mtime=0)).decode()
        if len(packed) > _LARGEST_FRAME:
            return self._table(
                f"{1e-6 * len(packed):.1f} MB are too much for a notebook; run.replay(FILE) makes the page"
            )
        return (
            f'<iframe srcdoc="{html.escape(_UNPACK.replace("PACKED", packed))}" '
            f'title="{html.escape(repr(self))}" style="width: 100%; height: 640px; border: 0"></iframe>'
        )

    def _table(self, note: str) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{value:.6g}</td></tr>"
            for name, value in self.metrics.items()
        )
        return (
            f"<p>{html.escape(repr(self))}</p><table>{rows}</table>"
            f"<p>not in three dimensions: {html.escape(note)}</p>"
        )


def _saved(folder: pathlib.Path) -> Any:
    h5py = sys.modules.get("h5py._objects")
    # To read an older log safely the process forks. No thread may be in HDF5 then.
    with h5py.phil if h5py else contextlib.nullcontext():
        return _core.SavedRun(folder)


def _unpickled(files: dict[str, bytes], folder: pathlib.Path | None, warnings: list[str]) -> Run:
    copy = pathlib.Path(tempfile.mkdtemp(prefix="breakwater_run_"))
    for name, content in files.items():
        (copy / name).write_bytes(content)
    run = Run(_saved(copy), folder, warnings)
    run._copy = copy
    weakref.finalize(run, shutil.rmtree, copy, ignore_errors=True)
    return run


_seeds: dict[int, tuple[int, object]] = {}  # the first run of each configuration, apart from its seed
_MOST_CONFIGURATIONS = 1000


def _warn_of_seeds(finished: Run) -> None:
    """Warn, like a sweep, if two seeds gave the same run."""
    config = finished.config
    others = {**config, "run": {key: value for key, value in config["run"].items() if key != "seed"}}
    if len(_seeds) >= _MOST_CONFIGURATIONS:
        _seeds.clear()
    own = (config["run"]["seed"], (finished.state_hash, hash(repr(finished.metrics))))
    seed, results = _seeds.setdefault(hash(repr(others)), own)
    if seed != own[0] and results == own[1]:
        line = f"seed: {seed} and {own[0]} gave the same run: no noise reaches them"
        finished._warnings.append(line)
        warnings.warn(line, stacklevel=3)


def run(
    scenario: str | os.PathLike[str],
    case: str | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    seed: int | None = None,
    duration: float | None = None,
    config: str | os.PathLike[str] | None = None,
    controller: Controller | None = None,
    estimator: Estimator | None = None,
    controllers: Mapping[str, Controller] | None = None,
    estimators: Mapping[str, Estimator] | None = None,
    out: str | os.PathLike[str] | None = None,
) -> Run:
    """Run a case of a scenario, and return the run. `scenario` is a name or a scenario file, "mine.toml".

    The same case, keys and seed give the same state hash as `breakwater run`.

    case: one of bw.cases(scenario); default: that of the scenario file. set: keys that replace those of the
    case, {"wall.distance_m": 0.1}. seed, duration [s]: the same as set={"run.seed": ..., "run.duration_s":
    ...}. config: another scenario file, such as the config.toml of a run. controller, estimator: objects of
    your own classes, which replace those of the case. A controller uses no estimator, so give one of both.
    controllers, estimators: the same for single axes of a plant, {"AXIS": object}. Each axis needs an object of
    its own, and takes one of both. out: folder for the run; by default nothing is written. With set={"record.stream": True} and out, the
    log is written during the run and read from the folder.

    The run's warnings are Python warnings too. Raises InputError for wrong arguments, keys and values, and
    RunFailed if the run ends early. Exceptions of your controller or estimator pass through. Ctrl-C stops the run.
    """
    sets = set_lines(set)
    if seed is not None:
        sets += set_lines({"run.seed": seed})
    if duration is not None:
        sets += set_lines({"run.duration_s": duration})
    *both, of_controllers, of_estimators = checked_parts(controller, estimator, controllers, estimators)
    parts = [_handle(part) for part in both]
    of_axes = [
        {axis: _handle(part) for axis, part in given.items()} for given in (of_controllers, of_estimators)
    ]
    folder = path_or_none(out, "out")
    core = _core.run(
        checked_path(scenario, "scenario"),
        text_or_none(case, "case"),
        path_or_none(config, "config"),
        sets,
        (*parts, *of_axes),
        folder,
    )
    parts += [part for given in of_axes for part in given.values()]
    lines = core.warnings(any(parts))
    if controller is not None:
        lines += [
            f"set: {key}: has no effect: a controller in Python uses no estimator"
            for key in set or {}
            if key in ("observer.name", "estimator.name")
        ]
    for line in lines:
        warnings.warn(line, stacklevel=2)
    for part in parts:
        if part is not None:
            part.let_go()
    data = _saved(pathlib.Path(folder)) if folder is not None and core.is_streamed else core
    finished = Run(data, None if folder is None else pathlib.Path(folder), lines)
    if any(line.startswith("run.seed=") for line in sets):
        _warn_of_seeds(finished)
    if finished.failure is not None:
        raise RunFailed(*finished.failure, finished)
    return finished


def load(folder: str | os.PathLike[str]) -> Run:
    """Read the folder of a run from any program. Its signals are read on demand.

    Raises InputError if the folder is damaged or not from a run. A run that failed or was cut has `failure` and
    no metrics.
    """
    path = pathlib.Path(checked_path(folder, "folder"))
    saved = _saved(path)
    return Run(saved, path, saved.notes + saved.warnings)


def scenarios() -> dict[str, str]:
    """The scenarios with their purpose."""
    return _core.scenarios()


def cases(scenario: str | os.PathLike[str]) -> list[str]:
    """The cases of a scenario or of a scenario file."""
    return _core.cases(checked_path(scenario, "scenario"))
