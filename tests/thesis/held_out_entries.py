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


class Run:
    """A run folder's log and settings."""

    def __init__(self, folder):
        self.settings = tomllib.loads((folder / "config.toml").read_text())
        with h5py.File(folder / "log.h5") as log:
            self.log = {track: {name: data[...] for name, data in log[track].items()} for track in log}
        self.t = self.log["control"]["time_s"]

    def __getitem__(self, signal):
        return self.log["control"][signal]

    def get(self, key):
        table, name = key.rsplit(".", 1)
        return self.settings[table][name]

    def between(self, from_s, to_s):
        return (self.t >= from_s - 1e-9) & (self.t <= to_s + 1e-9)

    def window(self):
        return self.between(self.get("metrics.from_s"), self.get("metrics.to_s"))


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def settling(t, error, from_s, band):
    """Time from from_s until the error stays within the band; infinite if it never does."""
    outside = np.flatnonzero((np.abs(error) > band) & (t >= from_s - 1e-9))
    if len(outside) == 0:
        return t[t >= from_s - 1e-9][0] - from_s
    return np.inf if outside[-1] == len(t) - 1 else t[outside[-1] + 1] - from_s


def reach(t, values, from_s, level):
    """Time from from_s until |value| first reaches the level; infinite if it never does."""
    there = np.flatnonzero((np.abs(values) >= level) & (t >= from_s - 1e-9))
    return t[there[0]] - from_s if len(there) else np.inf


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


def motor():
    def error(run, what, unit):
        return run[f"{what}_hat_{unit}"] - run[f"{what}_true_{unit}"]

    def raw_velocity(run):
        raw = np.diff(run["position_measured_rad"], prepend=0.0) / (run.t[1] - run.t[0])
        return rms((raw - run["velocity_true_rad_s"])[run.window()])

    start = "disturbance.start_s"
    return {
        "rmse_velocity_rad_s": lambda r: rms(error(r, "velocity", "rad_s")[r.window()]),
        "rmse_raw_velocity_rad_s": raw_velocity,
        "rmse_disturbance_Nm": lambda r: rms(error(r, "d", "Nm")[r.window()]),
        "transient_rmse_disturbance_Nm": lambda r: rms(
            error(r, "d", "Nm")[r.between(r.get(start), r.get("metrics.from_s"))]),
        "disturbance_settling_time_s": lambda r: settling(
            r.t, error(r, "d", "Nm"), r.get(start),
            r.get("metrics.settled_within") * abs(r.get("disturbance.amplitude_Nm"))),
        "slowest_pole_continuous_rad_s": lambda r: np.mean(
            np.max(r["poles_continuous_re_rad_s"], axis=1)[r.window()]),
        "lambda_min_1": lambda r: np.min(r["lambda"]),
    }


def cart_estimation():
    def error(run):
        return run["d_hat_N"] - run["d_true_N"]

    def noise_window(run):
        return run.between(run.get("metrics.noise_from_s"), run.get("metrics.noise_to_s"))

    def rate(run):
        kind = run.get("disturbance.kind")
        elapsed = run.t - run.get(f"disturbance.{kind}_start_s")
        if kind == "ramp":
            return run.get("disturbance.ramp_N_s") * (elapsed >= 0)
        omega = run.get(f"disturbance.{kind}_rad_s")
        return run.get(f"disturbance.{kind}_N") * omega * np.cos(omega * elapsed) * (elapsed >= 0)

    def lag(run):
        if run.get("disturbance.kind") == "ramp":
            return -np.mean(error(run)[run.window()]) / run.get("disturbance.ramp_N_s")
        settled = noise_window(run)
        columns = np.stack([run["d_true_N"], rate(run)], axis=1)[settled]
        (_, delay), *_ = np.linalg.lstsq(columns, run["d_hat_N"][settled], rcond=None)
        return -delay

    def deviation(run):
        noise = run["d_hat_noise_N"][run.window()]
        return np.max(np.abs(noise - np.mean(noise)))

    return {
        "relative_rmse_disturbance": lambda r: rms(error(r)[r.window()]) / rms(r["d_true_N"][r.window()]),
        "settling_time_5pct_s": lambda r: settling(
            r.t, error(r), r.get("disturbance.step_start_s"), 0.05 * abs(r.get("disturbance.step_N"))),
        "reach_time_99pct_s": lambda r: reach(
            r.t, r["d_hat_N"], r.get("disturbance.step_start_s"), 0.99 * abs(r.get("disturbance.step_N"))),
        "disturbance_lag_s": lag,
        "max_noise_deviation_N": deviation,
        "rms_noise_N": lambda r: rms(r["d_hat_noise_N"][noise_window(r)]),
        "steady_state_error_m": lambda r: np.mean((r["reference_m"] - r["position_true_m"])[r.window()]),
    }


def cart_position():
    def missing(run):
        return run["reference_m"] - run["position_true_m"]

    return {
        "steady_state_error_m": lambda r: np.mean(missing(r)[r.window()]),
        "settling_time_s": lambda r: settling(
            r.t, missing(r), r.get("task.reference_from_s"),
            r.get("metrics.settled_within") * abs(r.get("task.reference_m"))),
        "estimate_rise_time_s": lambda r: reach(
            r.t, r["d_hat_N"], r.get("task.reference_from_s"),
            (1.0 - np.exp(-1.0)) * r.get("plant.coulomb_friction_N")),
        "rms_highpass_disturbance_N": lambda r: rms(r["d_hat_highpass_N"]),
        "rms_input_step_N": lambda r: rms(np.diff(r["applied_N"], prepend=0.0)[r.window()]),
        "max_position_m": lambda r: np.max(r["position_true_m"]),
        "qp_unsolved_count": lambda r: np.sum(r["qp_status"] > 0),
    }


def cart_offset_free():
    def before(run):
        start_s = run.get("disturbance.start_s")
        return (run.t >= run.get("reference.start_s") - 1e-9) & (run.t < start_s - 1e-9)

    def settled(run):
        error = run["position_measured_m"] - run["reference_m"]
        early = run.t < run.get("disturbance.start_s") - 1e-9
        return settling(run.t[early], error[early], run.get("reference.start_s"),
                        run.get("metrics.settled_within") * abs(run.get("reference.position_m")))

    return {
        "steady_state_error_m": lambda r: np.mean(
            (r["position_measured_m"] - r["reference_m"])[r.window()]),
        "true_position_error_m": lambda r: np.mean((r["position_true_m"] - r["reference_m"])[r.window()]),
        "settling_time_s": settled,
        "max_speed_m_s": lambda r: np.max(np.abs(r["velocity_true_m_s"])),
        "max_input_N": lambda r: np.max(np.abs(r["command_N"])),
        "max_position_m": lambda r: np.max(r["position_true_m"]),
        "std_position_m": lambda r: np.std(r["position_true_m"][r.window()], ddof=1),
        "rms_position_estimate_error_m": lambda r: rms(r["position_hat_m"] - r["position_true_m"]),
        "max_early_disturbance_estimate_N": lambda r: np.max(np.abs(r["d_hat_N"][before(r)])),
        "mean_disturbance_estimate_N": lambda r: np.mean(r["d_hat_N"][r.window()]),
        "rms_disturbance_error_N": lambda r: rms((r["d_hat_N"] - r["d_true_N"])[r.window()]),
    }


def cart_constrained():
    def pushed_from(run):
        return run.get("disturbance.start_s") if run.settings["condition"] in "BC" else 0.0

    return {
        "final_position_m": lambda r: r["position_true_m"][-1],
        "max_speed_m_s": lambda r: np.max(np.abs(r["velocity_true_m_s"])),
        "max_estimated_speed_m_s": lambda r: np.max(np.abs(r["velocity_hat_m_s"])),
        "rms_velocity_estimate_error_m_s": lambda r: rms(r["velocity_hat_m_s"] - r["velocity_true_m_s"]),
        "velocity_estimate_travel_m_s": lambda r: np.sum(np.abs(np.diff(r["velocity_hat_m_s"]))),
        "max_input_N": lambda r: np.max(np.abs(r["command_N"])),
        "qp_unsolved_count": lambda r: np.sum(r["qp_status"] > 0),
        "settling_time_s": lambda r: settling(
            r.t, r["position_true_m"], pushed_from(r), r.get("metrics.settled_within_m")),
    }


def arm_wall_contact():
    def after_switch(run):
        """Physics steps after the switch to force control: time, force, filtered force."""
        track = run.log["physics"]
        later = track["time_s"] >= run.get("force.from_s") - 1e-9
        return [track[name][later] for name in ("time_s", "force_true_N", "force_filtered_N")]

    def onsets(run):
        t, force, _ = after_switch(run)
        touches = force > 0.0
        return t[touches & ~np.concatenate(([False], touches[:-1]))]

    def force_error(run):
        t, _, filtered = after_switch(run)
        part = (t >= run.get("metrics.from_s") - 1e-9) & (t < run.get("metrics.to_s") - 1e-9)
        return run.get("force.reference_N") - filtered[part]

    def of_pose(run, signal, start):
        return np.max(np.abs(run[signal] - start)[run.t >= run.get("force.from_s") - 1e-9])

    def is_saturated(run):
        return run["saturated"] > 0

    def decay(run):
        from_s, to_s = run.get("metrics.from_s"), run.get("metrics.to_s")
        fifth_s = (to_s - from_s) / 5
        early, late = (np.std(run["force_true_N"][run.between(a, b - 1e-6)], ddof=1)
                       for a, b in ((from_s, from_s + fifth_s), (to_s - fifth_s, to_s)))
        return late / early

    return {
        "force_decay_ratio": decay,
        "free_motion_time_s": lambda r: onsets(r)[0] - r.get("force.from_s"),
        "peak_force_filtered_N": lambda r: np.max(after_switch(r)[2]),
        "mean_force_error_N": lambda r: np.mean(force_error(r)),
        "std_force_error_N": lambda r: np.std(force_error(r), ddof=1),
        "bounce_count": lambda r: len(onsets(r)) - 1,
        "saturated_time_s": lambda r: r.get("control.period_s")
        * np.sum(is_saturated(r) & (r.t >= r.get("force.from_s") - 1e-9)),
        "saturated_share": lambda r: np.mean(
            is_saturated(r)[r.between(r.get("metrics.from_s"), r.get("metrics.to_s") - 1e-6)]),
        "max_y_error_m": lambda r: of_pose(r, "y_true_m", START_POSE[1]),
        "max_posture_error_rad": lambda r: of_pose(r, "phi_true_rad", START_POSE[2]),
    }


def arm_push():
    def release_s(run):
        return run.get("push.start_s") + run.get("push.rise_s") + run.get("push.hold_s")

    def is_free(run):
        return run.t >= release_s(run) - 1e-9

    def past_start(run, offset):
        free = is_free(run)
        side = np.sign(offset[np.flatnonzero(free)[0] - 1])
        return max(np.max(-side * offset[free]), 0.0)

    def overshoot(run):
        offset = run["q_true_rad"] - np.array(run.get("task.start_angles_rad"))
        past = past_start(run, offset)
        left = np.max(np.abs(offset[-1]))
        return max(past, left) if np.isfinite(settled(run)) and left > 0.2 else past

    def settled(run):
        off = np.hypot(run["x_true_m"] - START_POSE[0], run["y_true_m"] - START_POSE[1])
        return settling(run.t, off, release_s(run), run.get("metrics.settled_within_m"))

    return {
        "overshoot_rad": overshoot,
        "x_overshoot_m": lambda r: past_start(r, r["x_true_m"] - START_POSE[0]),
        "y_overshoot_m": lambda r: past_start(r, r["y_true_m"] - START_POSE[1]),
        "posture_overshoot_rad": lambda r: past_start(r, r["phi_true_rad"] - START_POSE[2]),
        "settling_time_s": settled,
        "reversal_count": lambda r: max(turns(q, 0.02) for q in r["q_true_rad"][is_free(r)].T),
        "saturated_time_s": lambda r: r.get("control.period_s")
        * np.sum((r["saturated"] > 0) & (r.t >= r.get("push.start_s") - 1e-9)),
    }


def quadrotor_waves():
    def last(run):
        duration_s = run.get("run.duration_s")
        return run.between(duration_s - run.get("metrics.window_s"), duration_s)

    def converged(run):
        error = run["error_m"][last(run)]
        is_near = np.all(np.sqrt(np.mean(error**2, axis=0)) < 0.5)
        return float(is_near and np.max(np.linalg.norm(error, axis=1)) < 2.0)

    force = "wave_force_N"
    return {
        "tracking_rmse_m": lambda r: rms(r["error_m"][last(r)]),
        "converged": converged,
        "vertical_force_rmse_N": lambda r: rms((r["force_estimate_N"] - r[force])[last(r), 2]),
        "vertical_force_rmse_of_zero_N": lambda r: rms(r[force][last(r), 2]),
        "roll_rate_rmse_rad_s": lambda r: rms((r["motion_estimate"] - r["motion_true"])[last(r), 9]),
        "roll_rate_rmse_of_zero_rad_s": lambda r: rms(r["motion_true"][last(r), 9]),
    }


METRICS = {
    kind.__name__ + ("_estimation" if kind is motor else ""): kind()
    for kind in (motor, cart_estimation, cart_position, cart_offset_free, cart_constrained,
                 arm_wall_contact, arm_push, quadrotor_waves)
}
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
            return np.max(run[metric.removeprefix("largest_")])
        if metric.startswith("change_"):
            return rms(np.diff(run[metric.removeprefix("change_")], prepend=0.0)[run.window()])
        size = re.fullmatch(r"\|(.*)\|", metric)
        value = METRICS[scenario][size[1] if size else metric](run)
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
