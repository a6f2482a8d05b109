#!/usr/bin/python3
"""The controllers at the wall against the least free-motion time, and TLSC against each of the others.

    docs/studies/published_impact_runs.py [FOLDER]      # makes the runs
    docs/studies/published_impact.py [FOLDER]           # studies/published-impact

Writes published-impact-table.csv, published-impact-pairs.csv and published-impact-ranges.csv beside itself, and
docs/pictures/published-impact.png. A run without contact, or in which the arm does not keep its posture, has failed: it
is behind every other. Intervals of medians are between order statistics. p is the exact sign test over test
conditions, with Holm's correction over all pairs of a measure.
"""
import csv
import re
import sys
from pathlib import Path

import numpy as np
from contact_laws import COLOURS, LARGEST_POSTURE_ERROR_rad, holm, median_interval, plt, write
from contact_limit import SPEED_m_s, START_m, STIFF_N_m, Arm, Wall, time_to_wall, time_under
from published_impact_runs import LONGEST_s, TOLD
from scipy.stats import binomtest

HERE = Path(__file__).resolve().parent
NAMES = {"tlsc": "TLSC", "proposed": "proposed", "hpfc": "HPFC", "energy": "energy, admittance",
         "impact-qp": "impact-aware QP", TOLD: "contact MPC (told the place)"}
MARKS = dict(zip(NAMES, "*osv^D"))
LOOKS = dict(zip(NAMES, COLOURS))
ROWS = {"fixed": "fixed wall", "moving": "moving wall", "place": "error of the told place",
        "stiffness": "unknown stiffness", "exact": "fixed wall, tuned for the exact place"}
PEAKS_N = np.geomspace(1.0, 40.0, 16)
PLACES_m = np.linspace(START_m, START_m + 0.135, 6)
WORLD = ["wall.distance_m", "plant.friction_Nm", "contact.stiffness_N_m", "contact.damping_Ns_m", "wall.speed_m_s"]


def read(folder, row, force_N, name):
    """(worlds, times, peaks) of a controller's runs; without a value (inf) where one failed."""
    if row == "place" and name != TOLD:
        row = "fixed"
    file = folder / "tested" / f"{row}-{force_N}N" / f"{name}-{force_N}N" / "results.csv"
    if not file.exists():
        return None
    with open(file, newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    whole = [row["status"] == "complete" and row["free_motion_time_s"] != ""
             and float(row["max_posture_error_rad"]) <= LARGEST_POSTURE_ERROR_rad for row in rows]
    values = [[float(row[metric]) if ok else np.inf for row, ok in zip(rows, whole)]
              for metric in ("free_motion_time_s", "peak_force_filtered_N")]
    return np.array([[float(row[key]) for key in WORLD] for row in rows]), *np.array(values)


def floors(worlds, hardest=None):
    """Least times (worlds x PEAKS_N), for the worlds' own walls or for the hardest wall of a range."""
    distance, friction, *contact = worlds.T
    caps = Arm(friction[:, None, None]).contact_speed(
        PLACES_m[None, None], PEAKS_N[None, :, None], [hardest or Wall(*(value[:, None, None] for value in contact))])
    drives = [Arm(value).drive(PLACES_m[-1]) for value in friction]
    return np.array([[time_to_wall(drive, np.column_stack([PLACES_m, cap]), way, away) for cap in of_peak]
                     for drive, of_peak, way, away in zip(drives, caps, distance, worlds[:, -1])])


def least_at_known_places(worlds, peaks):
    """The least time of each run to a standing wall at a known place, for its own peak."""
    ends, frictions, *contact = START_m + worlds[:, 0], worlds[:, 1], *worlds.T[2:]
    speeds = Arm(frictions).contact_speed(ends, np.array(peaks), [Wall(*contact)])
    times = []
    for end, friction, speed in zip(ends, frictions, speeds):
        arm = Arm(friction)
        times.append(time_under(arm.drive(end + 0.01), arm.brake_to(end, speed), end))
    return np.array(times)


def multiples(times, peaks, least, force_N):
    """(time, peak) as multiples of the floor: of the least time for the peak, of the least peak for the time."""
    least_time = np.array([np.interp(peak, PEAKS_N, row) for peak, row in zip(peaks, least)])
    least_peak = np.array([np.interp(time, row[::-1], PEAKS_N[::-1]) for time, row in zip(times, least)])
    return times / least_time, peaks / np.maximum(least_peak, force_N)


def median(values):
    return float(np.median(values))


def interval(values):
    """Median with its interval, as text."""
    middle, *ends = median_interval(values)
    return f"{middle:.2f} [{', '.join(f'{end:.2f}' if np.isfinite(end) else '∞' for end in ends)}]"


def compare(ours, theirs):
    """[wins of ours, losses, p] where less is better."""
    wins, losses = int(np.sum(ours < theirs)), int(np.sum(ours > theirs))
    return [wins, losses, binomtest(wins, wins + losses).pvalue if wins + losses else 1.0]


def number_of_values(name):
    text = (HERE.parents[1] / "studies/published-impact-tuning.toml").read_text(encoding="utf-8")
    section = re.search(rf"\[for_each\.{name}-2N\](.*?)\n\[", text, flags=re.DOTALL)[1]
    return len(re.findall(r"^[a-z]\S+ = ", section, flags=re.MULTILINE))


def draw(results, curves, path):
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 2, figsize=(9.6, 7.2), sharex=True, sharey=True, constrained_layout=True)
    for axis, row in zip(axes.flat, list(ROWS)[:4]):
        if row not in curves:
            continue
        axis.plot(1e3 * curves[row], PEAKS_N, color="0.25", lw=1.5, label="floor" if row == "fixed" else None)
        for (one, force_N, name), (times, peaks, *_) in results.items():
            if one != row or not np.isfinite(median(peaks)):
                continue
            x, y = 1e3 * median(times), median(peaks)
            quarters = np.abs(np.quantile(peaks, [0.25, 0.75], method="nearest") - y)
            axis.errorbar(x, y, quarters[:, None], color=LOOKS[name], lw=1, marker=MARKS[name],
                          ms=10 if name == "tlsc" else 6, mfc=LOOKS[name] if force_N == 2 else "white",
                          label=NAMES[name] if row == "fixed" and force_N == 2 else None)
        axis.set_title(ROWS[row], loc="left", fontsize=10)
        axis.grid(alpha=0.25)
    axes[0, 0].set(yscale="log", xlim=(200, 900), ylim=(1.8, 40))
    axes[0, 0].set_yticks([2, 3, 5, 10, 20, 40], ["2", "3", "5", "10", "20", "40"])
    axes[0, 0].minorticks_off()
    for axis in axes[1]:
        axis.set_xlabel("free-motion time [ms]")
    for axis in axes[:, 0]:
        axis.set_ylabel("filtered peak force [N]")
    figure.legend(frameon=False, ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    figure.savefig(path, dpi=110, bbox_inches="tight")


def main():
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "studies/published-impact")
    results, least, known, curves, ranges = {}, {}, {}, {}, []
    for row in ROWS:
        for force_N in LONGEST_s:
            for name in NAMES:
                runs = read(folder, row, force_N, name)
                if runs is None:
                    continue
                worlds, times, peaks = runs
                key = worlds.tobytes()
                if key not in least:
                    least[key] = floors(worlds)
                curves[row] = np.median(least[key], axis=0)
                results[row, force_N, name] = times, peaks, *multiples(times, peaks, least[key], force_N)
                if name == TOLD and row != "moving":
                    known[row, force_N, name] = interval(times / least_at_known_places(worlds, peaks))
                hardest = {"moving": Wall(speed_m_s=-SPEED_m_s),
                           "stiffness": Wall(STIFF_N_m, 10.0 * (STIFF_N_m / 1000.0) ** 0.5)}.get(row)
                if hardest and np.isfinite(peaks).any():
                    whole = np.isfinite(peaks)
                    if (key, row) not in least:
                        least[key, row] = floors(worlds, hardest)
                    worst = np.full(len(peaks), peaks[whole].max())
                    over = multiples(times, worst, least[key, row], force_N)[0]
                    ranges.append([ROWS[row], force_N, NAMES[name], f"{worst[0]:.1f}", f"{median(times):.2f}",
                                   interval(over), len(peaks) - int(whole.sum())])

    write("published-impact-table.csv",
          ["walls", "reference [N]", "controller", "tuned values", "free motion [s]", "peak [N]", "time / floor",
           "peak / floor", "time / floor of a known place", "failed"],
          [[ROWS[row], force_N, NAMES[name], number_of_values(name), f"{median(times):.2f}", f"{median(peaks):.2f}",
            interval(slower), interval(harder), known.get((row, force_N, name), ""), int(np.sum(~np.isfinite(peaks)))]
           for (row, force_N, name), (times, peaks, slower, harder) in results.items()])
    write("published-impact-ranges.csv",
          ["walls", "reference [N]", "controller", "largest peak [N]", "free motion [s]",
           "time / floor of the range", "failed"], ranges)

    pairs = [[measure, row, force_N, name, *compare(results[row, force_N, "tlsc"][which], theirs[which])]
             for which, measure in ((1, "peak"), (2, "time / floor"))
             for (row, force_N, name), theirs in results.items() if name != "tlsc" and row != "exact"]
    for measure in {pair[0] for pair in pairs}:
        holm([pair for pair in pairs if pair[0] == measure])
    cells = {}
    for measure, row, force_N, name, wins, losses, p in pairs:
        verdict = "" if p >= 0.05 else " **won**" if wins > losses else " **lost**"
        cells.setdefault((measure, ROWS[row], force_N), {})[name] = f"{wins} : {losses}, {p:.2g}{verdict}"
    others = list(NAMES)[1:]
    write("published-impact-pairs.csv", ["measure", "walls", "reference [N]"] + [NAMES[name] for name in others],
          [[*key, *(cell.get(name, "–") for name in others)] for key, cell in cells.items()])
    draw(results, curves, HERE.parent / "pictures/published-impact.png")


if __name__ == "__main__":
    main()
