"""The paired comparison of candidates in a table of runs."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from .arguments import did_you_mean, finite, mapping
from .errors import InputError

if TYPE_CHECKING:
    import pandas

_OF_A_SWEEP = ("point", "case", "seed", "status", "state_hash")


class Comparison:
    """The result of compare().

    sentence: the answer.
    table: a row for each candidate, the best first: place (0: not ranked) and median with its interval. `conditions` is
       their number; in `failed` of them it failed, and in `met` it met the bounds. `missing` of its complete runs lack the
       metric.
    pairs: a row for each pair of ranked candidates: the difference with its interval, p, and p after Holm's correction.
    notes: metrics that some complete runs of a candidate lack, in the words of `breakwater sweep`.
    data: the same as ranking.json of a study.
    """

    def __init__(self, data: dict[str, Any], notes: Sequence[str] = ()) -> None:
        import pandas

        self.notes = list(notes)
        paragraphs = [textwrap.fill(note, 100, break_on_hyphens=False) for note in notes]
        self._text = "\n".join([data.pop("text").rstrip("\n"), *paragraphs])
        self.data = data
        self.sentence: str = data["sentence"]

        def rows(name: str) -> pandas.DataFrame:
            table = pandas.json_normalize(data[name], sep="_")
            return table.rename(columns=lambda column: column.removesuffix("_value"))

        self.table = rows("candidates")
        self.pairs = rows("pairs")

    def __repr__(self) -> str:
        return self._text


def _columns(table: pandas.DataFrame, value: Any, name: str) -> list[str]:
    columns = [value] if isinstance(value, str) else list(value) if isinstance(value, (list, tuple)) else None
    if not columns:
        raise InputError(f"{name}: must be a column or a list of them")
    for column in columns:
        if column not in table.columns:
            near = did_you_mean(column, [str(one) for one in table.columns])
            raise InputError(f"{name}: there is no column {column!r}{near}")
    return columns


def _numbers(table: pandas.DataFrame, column: str, name: str) -> np.ndarray:
    try:
        values = table[column].to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError):
        raise InputError(f"{name}: the column {column!r} must have numbers") from None
    if np.isinf(values).any():
        raise InputError(f"{name}: the column {column!r} has infinite numbers")
    return values


def _bounds(table: pandas.DataFrame, require: Mapping[str, Any] | None) -> list[tuple[str, float, float]]:
    bounds = []
    for metric, bound in mapping(require, "require").items():
        name = f"require: {metric}"
        _columns(table, metric, "require")
        if not isinstance(bound, Mapping) or not bound or not set(bound) <= {"min", "max"}:
            raise InputError(f'{name}: must be {{"min": A}}, {{"max": B}} or both')
        low = finite(bound["min"], f"{name}: min") if "min" in bound else -math.inf
        high = finite(bound["max"], f"{name}: max") if "max" in bound else math.inf
        if low > high:
            raise InputError(f"{name}: min {low:g} is above max {high:g}")
        bounds.append((metric, low, high))
    return bounds


def compare(
    df: pandas.DataFrame,
    metric: str,
    by: str | Sequence[str],
    *,
    on: str | Sequence[str] | None = None,
    blocks: str | Sequence[str] | None = None,
    goal: str = "min",
    require: Mapping[str, Mapping[str, float]] | None = None,
    share: float = 1.0,
    confidence: float = 0.95,
) -> Comparison:
    """Rank candidates by a metric, in the same test conditions: the ranking of `breakwater sweep`, for any runs.

    df: a row for each run, such as the table of bw.sweep(). Conditions that not all candidates have are left out. A run
       that lacks the metric (NaN) is not compared.
    by: the column, or columns, that name the candidate.
    on: the columns that name a test condition, such as ["seed", "wall.distance_m"]. Default for a table of bw.sweep(): its
       seed and varied keys.
    blocks: those of `on` that make independent conditions; rows that differ in the others repeat them. Default: all but
       "seed", if there are others.
    goal: "min" or "max".
    require: bounds such as {"free_motion_time_s": {"max": 0.6}}. A candidate is ranked if the share of its blocks that meet
       all bounds is at least `share`. The interval of this share has the level `confidence`.

    Columns "status" and "state_hash" of bw.sweep() are used: failed runs count as failed, equal runs count once. Raises
    InputError in one line.
    """
    import pandas

    if not isinstance(df, pandas.DataFrame):
        raise InputError(f"df: must be a pandas.DataFrame, is of type {type(df).__name__}")
    if df.empty:
        raise InputError("df: has no rows")
    if not isinstance(metric, str):
        raise InputError("metric: must be the name of a column")
    _columns(df, metric, "metric")
    candidate_columns = _columns(df, by, "by")
    if goal not in ("min", "max"):
        raise InputError(f'goal: must be "min" or "max", is {goal!r}')
    if on is None:
        if not set(_OF_A_SWEEP) <= set(df.columns):
            raise InputError("on: say which columns name a test condition")
        places = list(df.columns)
        keys = places[places.index("seed") : places.index("status")]
        on = [key for key in keys if key not in candidate_columns]
    condition_columns = _columns(df, on, "on")
    others = [column for column in condition_columns if column != "seed"]
    block_columns = (others or condition_columns) if blocks is None else _columns(df, blocks, "blocks")
    for column in block_columns:
        if column not in condition_columns:
            raise InputError(f"blocks: {column!r} is not among on")
    bounds = _bounds(df, require)
    if not 0.0 < finite(share, "share") <= 1.0:
        raise InputError(f"share: must be above 0 and at most 1, is {share:g}")
    if not 0.5 <= finite(confidence, "confidence") <= 0.9999:
        raise InputError(f"confidence: must be from 0.5 to 0.9999, is {confidence:g}")

    labels = df[candidate_columns].astype(str).agg(", ".join, axis=1).to_numpy()
    candidate, names = pandas.factorize(labels)
    if len(names) < 2:
        raise InputError(f"by: {', '.join(candidate_columns)} names fewer than two candidates")
    condition = df.groupby(condition_columns, dropna=False).ngroup().to_numpy()
    block = df.groupby(block_columns, dropna=False).ngroup().to_numpy()
    shape = (condition.max() + 1, len(names))
    count = np.zeros(shape, dtype=int)
    np.add.at(count, (condition, candidate), 1)
    if (count > 1).any():
        name = names[np.argwhere(count > 1)[0][1]]
        raise InputError(f"on: {name} has two rows with the same {', '.join(condition_columns)}")
    common = np.flatnonzero((count == 1).all(axis=1))
    if len(common) == 0:
        raise InputError(f"on: no condition is common to {', '.join(names)}")

    def grid(values: np.ndarray) -> np.ndarray:
        cells = np.zeros(shape, dtype=np.float64)
        cells[condition, candidate] = values
        return cells[common]

    places = np.zeros((shape[0], len(condition_columns)))
    for i, column in enumerate(condition_columns):
        places[condition, i] = pandas.factorize(df[column])[0]
    blocks_of = np.zeros(shape[0], dtype=int)
    blocks_of[condition] = block
    order = np.argsort(blocks_of[common], kind="stable")
    metrics = {column: _numbers(df, column, "metric" if column == metric else "require")
               for column in dict.fromkeys([metric, *(bound[0] for bound in bounds)])}
    failed = (df["status"] != "complete").to_numpy() if "status" in df.columns else np.zeros(len(df))
    runs = np.arange(len(df))
    if "state_hash" in df.columns:
        own = df["state_hash"].fillna("").astype(str).to_numpy()
        cells = np.column_stack([own, failed.astype(str), *(values.astype(str) for values in metrics.values())])
        texts = ["|".join(row) if row[0] or failed[i] else f"row {i}" for i, row in enumerate(cells)]
        runs = pandas.factorize(np.array(texts, dtype=object))[0]
    of_metrics = {column: grid(values)[order] for column, values in metrics.items()}
    has_failed = grid(failed)[order]
    answer = _core.compare(
        list(names),
        of_metrics,
        has_failed,
        grid(runs)[order],
        blocks_of[common][order],
        places[common][order].tolist(),
        metric,
        goal == "max",
        bounds,
        float(share),
        float(confidence),
    )
    has_ended = has_failed == 0.0
    counts = {column: (has_ended & ~np.isnan(values)).sum(axis=0) for column, values in of_metrics.items()}
    notes = _core.missing_lines(list(names), counts, has_ended.sum(axis=0))
    return Comparison(json.loads(answer), notes)
