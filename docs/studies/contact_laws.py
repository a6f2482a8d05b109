#!/usr/bin/python3
"""Which orderings of the arm's controllers hold under every contact, and which turn.

    docs/studies/contact_laws_runs.py [FOLDER]      # makes the runs
    docs/studies/contact_laws.py [FOLDER]           # studies/contact-laws

Writes contact-laws-table.csv (medians) and contact-laws-pairs.csv (paired differences of the peak) beside itself,
and docs/pictures/contact-laws.png. A run in which the arm does not keep its posture has failed. Pairs are runs of
the same test condition; p is Wilcoxon's exact signed-rank test, with Holm's correction over all pairs and contacts.
"""
import csv
import statistics
import sys
from itertools import combinations
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from scipy.stats import binom, wilcoxon

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))
from figures import COLOURS  # noqa: E402

NAMES = {"proposed-2N": "proposed", "hpfc-2N": "HPFC", "drac-2N": "DRAC", "tlsc-2N": "TLSC"}
LOOKS = dict(zip(NAMES, COLOURS))
MARKS = dict(zip(NAMES, "osv^"))
PAIRED = ["proposed-2N", "hpfc-2N", "tlsc-2N"]
LAWS = ["kelvin_voigt", "kelvin_voigt_clipped", "hertz", "hunt_crossley", "layered", "standard_linear_solid"]
GROUPS = {"fixed wall, 1000 N/m": [f"{law}-1000" for law in LAWS],
          "fixed wall, 5000 N/m": [f"{law}-5000" for law in LAWS],
          "moving wall": ["kelvin_voigt-moving", "hunt_crossley-moving"],
          "giving wall": ["kelvin_voigt-giving", "hunt_crossley-giving"],
          "sensor chain": ["kelvin_voigt-sensor", "hunt_crossley-sensor"]}
CONTACTS = {contact: group for group, contacts in GROUPS.items() for contact in contacts}
LARGEST_POSTURE_ERROR_rad = 0.5
USES = {"tested": "tuned", "shipped": "shipped"}


def read(files):
    """{case: {test condition: (peak, free-motion time)}} of the runs that did not fail."""
    runs = {}
    for path in files:
        with open(path, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                values = runs.setdefault(row["case"], {})
                if row["peak_force_filtered_N"] and float(row["max_posture_error_rad"]) <= LARGEST_POSTURE_ERROR_rad:
                    values[row["wall.distance_m"]] = (float(row["peak_force_filtered_N"]),
                                                      float(row["free_motion_time_s"]))
    return runs


def read_all(folder):
    """[(use, contact, its runs)]."""
    found = [(use, contact, read(sorted((folder / use / contact).glob("**/results.csv"))))
             for use in USES for contact in CONTACTS]
    return [entry for entry in found if entry[-1]]


def medians(runs, case):
    values = list(runs.get(case, {}).values())
    if not values:
        return "–"
    peak_N, time_s = (statistics.median(column) for column in zip(*values))
    failed = f" ({12 - len(values)} failed)" if len(values) < 12 else ""
    return f"{peak_N:.2f}, {time_s:.2f}{failed}"


def compare(runs, one, other):
    """(median difference of the peak, in how many conditions one is softer, conditions, p)."""
    differences = [runs[one][world][0] - runs[other][world][0] for world in runs[one].keys() & runs[other].keys()]
    return [statistics.median(differences), sum(d < 0.0 for d in differences), len(differences),
            wilcoxon(differences, method="exact").pvalue]


def holm(pairs):
    """Corrects the p of each pair, its last element."""
    largest = 0.0
    for rank, pair in enumerate(sorted(pairs, key=lambda pair: pair[-1])):
        largest = max(largest, min(1.0, (len(pairs) - rank) * pair[-1]))
        pair[-1] = largest


def median_interval(values):
    """The median, and the order statistics that contain it with 95 % or more for any distribution."""
    ranked = sorted(values)
    rank = int(binom.ppf(0.025, len(ranked), 0.5))
    return statistics.median(ranked), ranked[rank - 1], ranked[-rank]


def label(contact):
    return f"{contact.rsplit('-', 1)[0]}, {CONTACTS[contact]}"


def write(name, header, rows):
    with open(HERE / name, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([header] + rows)


def draw(entries, path):
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 1, figsize=(9.6, 7.0), sharex=True, sharey=True, constrained_layout=True)
    places, ticks, at = {}, [], 0.0
    for group, contacts in GROUPS.items():
        places |= {contact: at + number for number, contact in enumerate(contacts)}
        ticks.append((at + 0.5 * (len(contacts) - 1), group))
        at += len(contacts) + 0.6
    for axis, use in zip(axes, USES):
        for number, case in enumerate(NAMES):
            for group in GROUPS:
                points = []
                for one, contact, runs in entries:
                    if one != use or CONTACTS[contact] != group or not runs.get(case):
                        continue
                    peaks = [peak for peak, _ in runs[case].values()]
                    x = places[contact] + 0.12 * (number - 1.5)
                    axis.plot([x, x], [min(peaks), max(peaks)], color=LOOKS[case], lw=1.0, alpha=0.45)
                    points.append((x, statistics.median(peaks)))
                if points:
                    axis.plot(*zip(*points), "-" + MARKS[case], color=LOOKS[case], ms=5, lw=1.2)
            axis.plot([], [], "-" + MARKS[case], color=LOOKS[case], label=NAMES[case])
        axis.axhline(2.0, color="0.4", lw=0.8, ls="--", label="reference")
        axis.set(yscale="log", ylabel="filtered peak force [N]")
        axis.set_yticks([2, 3, 4, 6, 10, 20, 40], ["2", "3", "4", "6", "10", "20", "40"])
        axis.minorticks_off()
        axis.grid(axis="y", alpha=0.25)
    axes[0].set_title("tuned for the law, at most 0.7 s to the wall", loc="left", fontsize=10)
    axes[1].set_title("shipped cases", loc="left", fontsize=10)
    axes[0].legend(frameon=False, ncols=5, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    axes[1].set_xticks(list(places.values()), [contact.rsplit("-", 1)[0] for contact in places], rotation=40,
                       ha="right", rotation_mode="anchor", fontsize=8)
    for x, group in ticks:
        axes[1].text(x, -0.42, group, ha="center", transform=axes[1].get_xaxis_transform(), fontsize=9)
    figure.savefig(path, dpi=110)


def main():
    entries = read_all(Path(sys.argv[1] if len(sys.argv) > 1 else "studies/contact-laws"))
    write("contact-laws-table.csv",
          ["controllers", "contact"] + [f"{NAMES[case]}: peak [N], free motion [s]" for case in NAMES],
          [[USES[use], label(contact)] + [medians(runs, case) for case in NAMES] for use, contact, runs in entries])

    pairs = [[use, contact, pair, *compare(runs, *pair)]
             for use, contact, runs in entries for pair in combinations(PAIRED, 2)]
    for use in USES:
        holm([pair for pair in pairs if pair[0] == use])
    cells = {}
    for use, contact, pair, difference, softer, count, p in pairs:
        cells.setdefault((use, contact), []).append(
            f"{difference:+.2f}, {softer} of {count}, {p:.2g}".replace("-", "−"))
    write("contact-laws-pairs.csv",
          ["controllers", "contact"] + [f"{NAMES[one]} less {NAMES[other]}" for one, other in combinations(PAIRED, 2)],
          [[USES[use], label(contact), *row] for (use, contact), row in cells.items()])
    draw(entries, HERE.parent / "pictures/contact-laws.png")


if __name__ == "__main__":
    main()
