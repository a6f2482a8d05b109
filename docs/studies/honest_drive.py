#!/usr/bin/python3
"""Which rankings of the motor's estimators change with a real drive.

    breakwater sweep studies/honest-drive.toml
    docs/studies/honest_drive.py [studies/honest-drive/results.csv]

Writes honest-drive-table.csv (medians) and honest-drive-turns.csv (the pairs of estimators whose verdict changes)
beside itself, and docs/pictures/honest-drive.png. Pairs are runs of the same world; p is Wilcoxon's exact
signed-rank test, with Holm's correction over all pairs and drives of a metric.
"""
import csv
import math
import statistics
import sys
from itertools import combinations
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from scipy.stats import wilcoxon

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))
from figures import COLOURS  # noqa: E402

METRICS = {"rms_position_rad": "angle", "rmse_velocity_rad_s": "velocity"}
CASES = ["mdob", "idob", "kfd", "dkf", "fakfd-095", "fakfd-0998", "vfakfd", "qvff", "stf", "qbank"]
DRIVES = ["ideal", "friction", "backlash", "current loop", "jitter", "all"]
SIGNIFICANT = 0.05


def drive_of(row):
    parts = [name for name, is_on in (("friction", row["friction.law"] != "coulomb"),
                                      ("backlash", float(row["transmission.stiffness_Nm_rad"]) > 0.0),
                                      ("current loop", float(row["drive.current_bandwidth_rad_s"]) > 0.0),
                                      ("jitter", float(row["control.jitter_s"]) > 0.0)) if is_on]
    return "ideal" if not parts else parts[0] if len(parts) == 1 else "all"


def read(path):
    """value[metric][drive][case][world]. A run that failed is worse than each other."""
    values = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            world = row["disturbance.frequency_rad_s"], row["disturbance.amplitude_Nm"]
            for metric in METRICS:
                values.setdefault(metric, {}).setdefault(drive_of(row), {}).setdefault(row["case"], {})[world] = \
                    float(row[metric]) if row[metric] else math.inf
    return values


def differences(one, other):
    return [one[world] - other[world] for world in one if math.isfinite(one[world]) or math.isfinite(other[world])]


def pairs_of(values):
    """{(drive, one, other): [worlds in which one is better, worlds, corrected p]} of a metric."""
    pairs = {}
    for drive in DRIVES:
        for one, other in combinations(CASES, 2):
            d = differences(values[drive][one], values[drive][other])
            p = wilcoxon(d, method="exact").pvalue
            pairs[drive, one, other] = [sum(x < 0.0 for x in d), len(d), p]
    largest = 0.0
    for rank, pair in enumerate(sorted(pairs.values(), key=lambda pair: pair[-1])):
        largest = max(largest, min(1.0, (len(pairs) - rank) * pair[-1]))
        pair[-1] = largest
    return pairs


def verdict(pair):
    """1: the first is better, -1: the second, 0: no difference is shown."""
    better, count, p = pair
    return 0 if p >= SIGNIFICANT else 1 if 2 * better > count else -1


def draw(values, path):
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, panels = plt.subplots(1, 2, figsize=(9.0, 4.4))
    for panel, (metric, unit) in zip(panels, (("rms_position_rad", "rms of the angle [rad]"),
                                              ("rmse_velocity_rad_s", "RMSE of the velocity [rad/s]"))):
        for number, case in enumerate(CASES):
            medians = [statistics.median(values[metric][drive][case].values()) for drive in DRIVES]
            dashes, mark = ("-", "o") if number < len(COLOURS) else ("--", "s")
            panel.plot(range(len(DRIVES)), medians, dashes + mark, color=COLOURS[number % len(COLOURS)], ms=4, lw=1.2,
                       label=case)
        panel.set(yscale="log", ylabel=unit)
        panel.set_xticks(range(len(DRIVES)), [drive.replace(" ", "\n") for drive in DRIVES])
        panel.grid(axis="y", alpha=0.25)
    figure.subplots_adjust(left=0.08, right=0.98, top=0.84, bottom=0.13, wspace=0.25)
    figure.legend(*panels[0].get_legend_handles_labels(), frameon=False, ncols=5, loc="upper center",
                  bbox_to_anchor=(0.5, 1.0))
    figure.savefig(path, dpi=120)


def main():
    values = read(sys.argv[1] if len(sys.argv) > 1 else "studies/honest-drive/results.csv")
    with open(HERE / "honest-drive-table.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["estimator"] + [f"{drive}: angle [mrad], velocity [rad/s]" for drive in DRIVES])
        for case in CASES:
            median = {metric: {drive: statistics.median(values[metric][drive][case].values()) for drive in DRIVES}
                      for metric in METRICS}
            table.writerow([case] + ["unstable" if math.isinf(median["rms_position_rad"][drive])
                                     else f"{1e3 * median['rms_position_rad'][drive]:.3g}, "
                                          f"{median['rmse_velocity_rad_s'][drive]:.3g}" for drive in DRIVES])
    with open(HERE / "honest-drive-turns.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["quantity", "drive", "pair", "better with an ideal drive", "better with this drive",
                        "first better in", "p (Holm)"])
        for metric, name in METRICS.items():
            pairs = pairs_of(values[metric])
            for (drive, one, other), pair in pairs.items():
                before, now = verdict(pairs["ideal", one, other]), verdict(pair)
                if before != now:
                    names = {1: one, -1: other, 0: "no difference shown"}
                    table.writerow([name, drive, f"{one}, {other}", names[before], names[now],
                                    f"{pair[0]} of {pair[1]}", f"{pair[2]:.2g}"])
    draw(values, HERE.parent / "pictures/honest-drive.png")


if __name__ == "__main__":
    main()
