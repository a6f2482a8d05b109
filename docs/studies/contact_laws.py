#!/usr/bin/python3
"""Which orderings of the arm's controllers hold under every contact law, and which turn.

    breakwater sweep studies/contact-laws.toml
    docs/studies/contact_laws.py [studies/contact-laws/results.csv]

Writes contact-laws-table.csv (medians) and contact-laws-pairs.csv (paired differences of the peak) beside itself, and
docs/pictures/contact-laws.png. Pairs are runs of the same world; p is Wilcoxon's exact signed-rank test, with
Holm's correction over all pairs and contacts.
"""
import csv
import statistics
import sys
from itertools import combinations
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from scipy.stats import wilcoxon

HERE = Path(__file__).resolve().parent
METRIC = "peak_force_filtered_N"
NAMES = {"proposed-2N": "proposed", "hpfc-2N": "HPFC", "drac-2N": "DRAC", "tlsc-2N": "TLSC"}
COLOURS = {"proposed-2N": "#1b6ca8", "hpfc-2N": "#2a9d5c", "drac-2N": "#d1495b", "tlsc-2N": "#e09f3e"}
CONTACTS = ["kelvin_voigt", "kelvin_voigt_clipped", "hertz", "hunt_crossley", "layered", "standard_linear_solid",
            "moving wall", "giving wall", "sensor chain"]


def contact_of(row):
    if float(row["sensor.force_delay_s"]) > 0.0:
        return "sensor chain"
    return {"sine": "moving wall", "free": "giving wall"}.get(row["wall.motion"], row["contact.law"])


def world_of(row):
    return row["wall.distance_m"], row["plant.friction_Nm"]


def read(path):
    """value[contact][case][world] of the peak and of the free-motion time."""
    peaks, times = {}, {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if not row[METRIC]:
                continue
            for values, metric in ((peaks, METRIC), (times, "free_motion_time_s")):
                values.setdefault(contact_of(row), {}).setdefault(row["case"], {})[world_of(row)] = float(row[metric])
    return peaks, times


def pairs_of(peaks):
    """(contact, one, other, number of worlds, worlds in which one is softer, median difference, p)."""
    pairs = []
    for contact in CONTACTS:
        for one, other in combinations(NAMES, 2):
            a, b = peaks[contact][one], peaks[contact][other]
            differences = [a[world] - b[world] for world in a.keys() & b.keys()]
            p = wilcoxon(differences, method="exact").pvalue
            pairs.append([contact, one, other, len(differences), sum(d < 0.0 for d in differences),
                          statistics.median(differences), p])
    largest = 0.0
    for rank, pair in enumerate(sorted(pairs, key=lambda pair: pair[-1])):
        largest = max(largest, min(1.0, (len(pairs) - rank) * pair[-1]))
        pair[-1] = largest
    return pairs


def draw(peaks, path):
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axis = plt.subplots(figsize=(8.0, 3.9), constrained_layout=True)
    for number, case in enumerate(NAMES):
        for place, contact in enumerate(CONTACTS):
            values = sorted(peaks[contact][case].values())
            x = place + 0.16 * (number - 1.5)
            axis.plot([x, x], [values[0], values[-1]], color=COLOURS[case], lw=1.2, alpha=0.6)
            axis.plot(x, statistics.median(values), "o", color=COLOURS[case], ms=6,
                      label=NAMES[case] if place == 0 else None)
    axis.axhline(2.0, color="0.4", lw=0.8, ls="--", label="reference")
    axis.axvline(5.5, color="0.8", lw=0.8)
    axis.set(yscale="log", ylabel="filtered peak force [N]")
    axis.set_yticks([2, 3, 4, 6, 8, 10, 15], ["2", "3", "4", "6", "8", "10", "15"])
    axis.minorticks_off()
    labels = [contact.replace("kelvin_voigt_clipped", "kelvin_voigt\n_clipped")
              .replace("standard_linear_solid", "standard_\nlinear_solid").replace("hunt_crossley", "hunt_\ncrossley")
              for contact in CONTACTS]
    axis.set_xticks(range(len(CONTACTS)), labels)
    axis.tick_params(axis="x", labelsize=8)
    axis.grid(axis="y", alpha=0.25)
    axis.legend(frameon=False, ncols=5, loc="upper center", bbox_to_anchor=(0.5, 1.12))
    figure.savefig(path, dpi=120)


def main():
    peaks, times = read(sys.argv[1] if len(sys.argv) > 1 else "studies/contact-laws/results.csv")
    with open(HERE / "contact-laws-table.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["contact"] + [f"{NAMES[case]}: peak [N], free motion [s]" for case in NAMES])
        for contact in CONTACTS:
            table.writerow([contact] + [f"{statistics.median(peaks[contact][case].values()):.2f}, "
                                        f"{statistics.median(times[contact][case].values()):.2f}" for case in NAMES])
    with open(HERE / "contact-laws-pairs.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["contact", "one", "other", "median difference of the peak [N]", "one softer in", "p (Holm)"])
        for contact, one, other, count, softer, difference, p in pairs_of(peaks):
            table.writerow([contact, NAMES[one], NAMES[other], f"{difference:+.2f}".replace("-", "−"),
                            f"{softer} of {count}", f"{p:.2g}"])
    draw(peaks, HERE.parent / "pictures/contact-laws.png")


if __name__ == "__main__":
    main()
