#!/usr/bin/env python3
"""Forty entries of a reproduction, picked at random, recomputed from their runs' logs with NumPy.

held_out_entries.py BREAKWATER EXPERIMENTS REPRODUCED [--seed S] [--count N]

The script repeats the runs of an entry and reads their log.h5. From signals and settings alone it
computes the measured value in verdicts.csv, without any metric of the project.
"""
import argparse
import csv
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import tomllib

import h5py
import numpy as np

AGREEMENT = 1e-6  # relative
START_POSE = np.array([0.45, 0.0, 0.0])  # X_0^ref of the arm: x, y, phi


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def turns(values, band):
    """The number of reversals larger than the band, without the first movement."""
    kept = [values[0]]  # alternating extremes
    way = 0
    for value in values[1:]:
        if way == 0:
            if abs(value - kept[0]) > band:
                way = np.sign(value - kept[0])
                kept.append(value)
        elif way * (value - kept[-1]) > 0:
            kept[-1] = value
        elif way * (kept[-1] - value) > band:
            way = -way
            kept.append(value)
    return max(len(kept) - 2, 0)


class Run:
    """A run folder's log and settings, and what the rows of metrics.txt ask for."""

    def __init__(self, folder):
        self.settings = tomllib.loads((folder / "config.toml").read_text())
        with h5py.File(folder / "log.h5") as log:
            self.log = {track: {name: data[...] for name, data in log[track].items()} for track in log}
        self.signal = self.log["control"]
        self.t = self.signal["time_s"]

    def value(self, row):
        own = {name: getattr(self, name) for name in dir(self) if not name.startswith("_")}
        return eval(row, {**globals(), **own, **self.signal, "run": self})

    def at(self, key):
        table, name = key.rsplit(".", 1)
        return self.settings[table][name]

    def within(self, from_s, to_s):
        return (self.t >= from_s - 1e-9) & (self.t <= to_s + 1e-9)

    def W(self, values):
        return values[self.within(self.at("metrics.from_s"), self.at("metrics.to_s"))]

    def last(self, values):
        duration_s = self.at("run.duration_s")
        return values[self.within(duration_s - self.at("metrics.window_s"), duration_s)]

    def settling(self, error, from_s, band):
        """Time from from_s until the error stays within the band; infinite if it never does."""
        t = self.t[:len(error)]
        outside = np.flatnonzero((np.abs(error) > band) & (t >= from_s - 1e-9))
        if len(outside) == 0:
            return t[t >= from_s - 1e-9][0] - from_s
        return np.inf if outside[-1] == len(t) - 1 else t[outside[-1] + 1] - from_s

    def reach(self, values, from_s, level):
        """Time from from_s until |value| first reaches the level; infinite if it never does."""
        there = np.flatnonzero((np.abs(values) >= level) & (self.t >= from_s - 1e-9))
        return self.t[there[0]] - from_s if len(there) else np.inf

    # ---- A cart's estimate --------------------------------------------------------------------

    def lag(self):
        kind, d, d_hat = self.at("disturbance.kind"), self.signal["d_true_N"], self.signal["d_hat_N"]
        if kind == "ramp":
            return -np.mean(self.W(d_hat - d)) / self.at("disturbance.ramp_N_s")
        elapsed, omega = self.t - self.at(f"disturbance.{kind}_start_s"), self.at(f"disturbance.{kind}_rad_s")
        rate = self.at(f"disturbance.{kind}_N") * omega * np.cos(omega * elapsed) * (elapsed >= 0)
        late = self.within(self.at("metrics.noise_from_s"), self.at("metrics.noise_to_s"))
        (in_phase, of_rate), *_ = np.linalg.lstsq(np.stack([d, rate], axis=1)[late], d_hat[late], rcond=None)
        return np.arctan2(-omega * of_rate, in_phase) / omega

    # ---- The arm at the wall ------------------------------------------------------------------

    def after_switch(self, name):
        """A signal at the physics steps after the switch to force control."""
        return self.log["physics"][name][self.log["physics"]["time_s"] >= self.at("force.from_s") - 1e-9]

    def onsets(self):
        touches = self.after_switch("force_true_N") > 0.0
        return self.after_switch("time_s")[touches & ~np.concatenate(([False], touches[:-1]))]

    def force_error(self):
        t = self.after_switch("time_s")
        part = (t >= self.at("metrics.from_s") - 1e-9) & (t < self.at("metrics.to_s") - 1e-9)
        return self.at("force.reference_N") - self.after_switch("force_filtered_N")[part]

    def decay(self):
        from_s, to_s = self.at("metrics.from_s"), self.at("metrics.to_s")
        fifth_s = (to_s - from_s) / 5
        early, late = (np.std(self.signal["force_true_N"][self.within(a, b - 1e-6)], ddof=1)
                       for a, b in ((from_s, from_s + fifth_s), (to_s - fifth_s, to_s)))
        return late / early

    # ---- The arm that is pushed ---------------------------------------------------------------

    def release_s(self):
        return self.at("push.start_s") + self.at("push.rise_s") + self.at("push.hold_s")

    def past_start(self, offset):
        free = self.t >= self.release_s() - 1e-9
        side = np.sign(offset[np.flatnonzero(free)[0] - 1])
        return max(np.max(-side * offset[free]), 0.0)

    def settled(self):
        off = np.hypot(self.signal["x_true_m"] - START_POSE[0], self.signal["y_true_m"] - START_POSE[1])
        return self.settling(off, self.release_s(), self.at("metrics.settled_within_m"))

    def overshoot(self):
        offset = self.signal["q_true_rad"] - np.array(self.at("task.start_angles_rad"))
        past, left = self.past_start(offset), np.max(np.abs(offset[-1]))
        return max(past, left) if np.isfinite(self.settled()) and left > 0.2 else past


TABLES = re.split(r"^\[(\w+)\]\n", pathlib.Path(__file__).with_name("metrics.txt").read_text(), flags=re.MULTILINE)[1:]
METRICS = {scenario: dict(line.split(" | ") for line in rows.split("\n") if line)
           for scenario, rows in zip(TABLES[::2], TABLES[1::2])}
# The force metrics need the rate of the physics, which the log has only around the impact.
MORE_SETS = {"arm_wall_contact": ["record.fine_to_s=100"]}


def runs_of(experiments):
    """name: (scenario, case, sets, further sets of each repetition of the quick effort)."""
    runs = {}
    for row in (row for section in experiments["section"] for row in section.get("runs", [])):
        repetitions = [[]]
        if "seeds" in row:
            repetitions = [[f"run.seed={seed + 1}"] for seed in range(row["seeds"][1])]
        elif "spread" in row:
            key, width, (_, count) = (row["spread"][name] for name in ("key", "width", "count"))
            repetitions = [[f"{key}={width * ((i + 0.5) / count - 0.5):.17g}"] for i in range(count)]
        runs[row["name"]] = (row["scenario"], row["case"], row.get("sets", []), repetitions)
    return runs


class Recomputed:
    """Metrics of runs, with a value per repetition."""

    def __init__(self, breakwater, experiments, folder):
        self.breakwater = breakwater
        self.runs = runs_of(experiments)
        self.folder = folder

    def values(self, name, metric):
        scenario, case, sets, repetitions = self.runs[name]
        values = []
        for i, more in enumerate(repetitions):
            out = self.folder / f"{name}-{i}"
            if not out.exists():
                settings = sets + more + MORE_SETS.get(scenario, [])
                subprocess.run(
                    [self.breakwater, "run", scenario, "--case", case, "--quiet", "--out", out]
                    + (["--set", *settings] if settings else []),
                    check=True, stdout=subprocess.DEVNULL)
            values.append(self.value(Run(out), scenario, metric))
        return np.array(values)

    @staticmethod
    def value(run, scenario, metric):
        if metric.startswith("largest_"):
            return np.max(run.signal[metric.removeprefix("largest_")])
        if metric.startswith("change_"):
            return rms(run.W(np.diff(run.signal[metric.removeprefix("change_")], prepend=0.0)))
        size = re.fullmatch(r"\|(.*)\|", metric)
        value = run.value(METRICS[scenario][size[1] if size else metric])
        return abs(value) if size else value


def recompute(entry, recomputed):
    values = recomputed.values(entry["run"], entry["metric"])
    if entry["over_run"]:
        over = recomputed.values(entry["over_run"], entry["over_metric"])
        values = values / (over if entry["over_run"] == entry["run"] else np.median(over))
    values = values / float(entry["divisor"])
    return np.mean(values) if entry["statistic"] == "share" else np.median(values)


def holds(entry, value):
    """Whether a value satisfies the statement's "holds if from A, below B"."""
    bounds = dict(re.findall(r"(from|below) (\S+?)(?:,|$)", entry["holds_if"]))
    return value >= float(bounds.get("from", "-inf")) and value < float(bounds.get("below", "inf"))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("breakwater")
    parser.add_argument("experiments", type=pathlib.Path)
    parser.add_argument("reproduced", type=pathlib.Path, help="what `reproduce --quick` left")
    parser.add_argument("--seed", type=int, default=31)
    parser.add_argument("--count", type=int, default=40)
    arguments = parser.parse_args()
    experiments = tomllib.loads(arguments.experiments.read_text())
    with open(arguments.reproduced / "verdicts.csv", newline="") as lines:
        entries = [entry for entry in csv.DictReader(lines) if entry["measured"] not in ("", "inf")]
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        recomputed = Recomputed(arguments.breakwater, experiments, pathlib.Path(folder))
        for entry in random.Random(arguments.seed).sample(entries, arguments.count):
            said = float(entry["measured"])
            value = recompute(entry, recomputed)
            agrees = abs(value - said) <= AGREEMENT * max(abs(said), 1e-9)
            verdict = entry["verdict"].removeprefix("other reading: ")
            if entry["says"] and verdict != "shown":
                agrees = agrees and holds(entry, value) == (verdict in ("reproduced", "vacuous"))
            failed += not agrees
            print(f"{'agrees ' if agrees else 'DIFFERS'} {entry['section']:8} {value:.9g} "
                  f"({said:.9g}) {entry['verdict']}: {entry['table']}, {entry['row']}, {entry['column']}")
    print(f"{arguments.count - failed} of {arguments.count} entries agree (seed {arguments.seed})")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
