#!/usr/bin/python3
"""Tables and the figure of docs/explanation/against-published-methods.md, estimators behind an encoder.

    docs/studies/encoder_estimators_table.py [studies/encoder-estimators]

FOLDER is that of encoder_estimators.py. Writes encoder-estimators-{rows,pairs,table,tuned,converged}.csv beside itself and
docs/pictures/encoder-estimators.png. A multiple is an RMSE over that of the floor,
both over all blocks of a row. Pairs are equal rows: Wilcoxon's signed-rank test of the logarithms, with Holm's correction
over all pairs, both quantities and both sets of rows. Ends with an error if an estimator is below the floor.
"""
import csv
import math
import shutil
import sys
import tomllib
from itertools import combinations
from pathlib import Path

import numpy as np
from contact_laws import COLOURS, holm, plt
from scipy.stats import wilcoxon

HERE = Path(__file__).resolve().parent
COST = tomllib.loads((HERE / "encoder-estimators.toml").read_text(encoding="utf-8"))["cost"]

QUANTITIES = {"rmse_velocity_rad_s": "velocity", "rmse_disturbance_Nm": "disturbance"}
OURS = ["qbank", "qbank-tuned", "stf", "qvff"]
THESIS = ["vfakfd", "idob", "mdob", "kfd", "dkf", "fakfd"]
SETS = {"QBANK's study": "QBANK's rows", "unseen": "unseen rows"}
SMALLEST = 1e-9  # [rad/s]; such a velocity error is arithmetic
FLOOR_ERROR = 0.05  # of the particle filter's RMSE by its finite number of particles


def read(path):
    """errors[quantity][set][row][estimator] = RMSEs of the blocks, and {row: (class, disturbance)}."""
    errors, names = {q: {s: {} for s in SETS} for q in QUANTITIES}, {}
    with open(path, newline="", encoding="utf-8") as file:
        for line in csv.DictReader(file):
            row = int(line["row"])
            names[row] = line["class"], line["disturbance"]
            for quantity in QUANTITIES:
                rows = errors[quantity][line["set"]]
                rows.setdefault(row, {}).setdefault(line["estimator"], []).append(float(line[quantity]))
    return errors, names


def multiples(rows):
    """{estimator: an array of the rows' multiples}, without the rows whose floor is 0."""
    found = {}
    for errors in rows.values():
        mean = {case: math.sqrt(np.mean(np.square(e))) for case, e in errors.items()}
        for case, value in mean.items():
            if mean["floor"] > SMALLEST and case != "floor":
                found.setdefault(case, []).append(value / mean["floor"])
    return {case: np.array(values) for case, values in found.items()}


def below_floor(rows):
    """(row, estimator, difference of the logarithms, its standard error) where it is clearly negative."""
    for number, errors in rows.items():
        for case, e in errors.items():
            if case == "floor" or max(errors["floor"]) < SMALLEST or not np.all(np.isfinite(e)):
                continue
            d = np.log(np.array(e) / np.array(errors["floor"]))
            error = math.hypot(np.std(d, ddof=1), FLOOR_ERROR) / math.sqrt(len(d))
            if np.mean(d) < -3.0 * error:
                yield number, case, np.mean(d), error


def interval(values):
    """Bootstrap interval, 95 %, of the median over rows."""
    draws = np.random.default_rng(1).integers(0, len(values), (2000, len(values)))
    return np.percentile(np.median(values[draws], axis=1), [2.5, 97.5], method="nearest")


def pairs_of(found):
    """{(quantity, set, one, other): [rows where one is better, where the other is, corrected p]}."""
    pairs = {}
    for (quantity, rows), values in found.items():
        for one, other in combinations(values, 2):
            with np.errstate(invalid="ignore"):
                d = np.log(values[one]) - np.log(values[other])
            d = np.where(np.isnan(d), 0.0, np.clip(d, -99.0, 99.0))
            p = 1.0 if not np.any(d) else wilcoxon(d).pvalue
            pairs[quantity, rows, one, other] = [int(np.sum(d < 0.0)), int(np.sum(d > 0.0)), p]
    holm(pairs.values())
    return pairs


def against(pairs, quantity, rows, case, other):
    """Wins and losses of case against other, and Holm's p."""
    if (quantity, rows, case, other) in pairs:
        return pairs[quantity, rows, case, other]
    wins, losses, p = pairs[quantity, rows, other, case]
    return [losses, wins, p]


def rounded(x):
    return "unstable" if not math.isfinite(x) else f"{x:.3g}"


def draw(found, order, path):
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, panels = plt.subplots(1, 2, figsize=(9.0, 5.2), sharey=True)
    for panel, quantity in zip(panels, QUANTITIES):
        for y, case in enumerate(order):
            colour = COLOURS[0] if case in OURS else "#777777" if case in THESIS else COLOURS[1]
            for rows, dy, face in (("unseen", -0.15, colour), ("QBANK's study", 0.15, "white")):
                values = np.minimum(found[quantity, rows][case], 1e6)
                low, middle, high = np.percentile(values, [10, 50, 90])
                panel.plot([low, high], [y + dy] * 2, color=colour, lw=1.2, alpha=0.6)
                panel.plot(middle, y + dy, "o", color=colour, mfc=face, ms=5)
        panel.axvline(1.0, color="black", lw=1.0)
        panel.set(xscale="log", xlabel=f"RMSE of the {QUANTITIES[quantity]}, as a multiple of the floor",
                  xlim=(0.9, 15.0 if quantity == "rmse_velocity_rad_s" else 40.0))
        ticks = [1, 2, 3, 5, 10, 20]
        panel.set_xticks(ticks, [str(tick) for tick in ticks])
        panel.set_xticks([], minor=True)
        panel.grid(axis="x", alpha=0.25)
    panels[0].set_yticks(range(len(order)), order)
    panels[0].invert_yaxis()
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def main():
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "studies/encoder-estimators")
    errors, names = read(folder / "results.csv")
    wrong = [one for q in QUANTITIES for s in SETS for one in below_floor(errors[q][s])]
    found = {(q, s): multiples(errors[q][s]) for q in QUANTITIES for s in SETS}
    pairs = pairs_of(found)
    cases = list(found["rmse_velocity_rad_s", "unseen"])
    middle = {case: np.mean([np.median(np.log(np.minimum(found[q, s][case], 1e6)))
                             for q in QUANTITIES for s in SETS]) for case in cases}
    order = sorted(cases, key=middle.get)
    with open(HERE / "encoder-estimators-rows.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["row", "encoder", "disturbance", "floor", *order])
        for q, name in QUANTITIES.items():
            for s in SETS:
                for number, row in errors[q][s].items():
                    mean = {case: math.sqrt(np.mean(np.square(e))) for case, e in row.items()}
                    table.writerow([f"{number}, {name}", *names[number], rounded(mean["floor"])] +
                                   [rounded(mean[c] / mean["floor"]) if mean["floor"] > SMALLEST else ""
                                    for c in order])
    with open(HERE / "encoder-estimators-pairs.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["quantity", "rows", "first", "second", "first better", "second better", "p (Holm)"])
        for (q, s, one, other), (wins, losses, p) in pairs.items():
            table.writerow([QUANTITIES[q], SETS[s], one, other, wins, losses, f"{p:.2g}"])
    for name in ("tuned", "converged"):
        shutil.copyfile(folder / f"{name}.csv", HERE / f"encoder-estimators-{name}.csv")
    with open(folder / "tuned.csv", newline="", encoding="utf-8") as file:
        tuned = {line["estimator"]: len(line["keys"].split()) for line in csv.DictReader(file)}
    with open(HERE / "encoder-estimators-table.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["estimator", "tuned values", "cost", "velocity, QBANK's rows", "disturbance, QBANK's rows",
                        "velocity, unseen", "disturbance, unseen", "velocity, won : lost", "disturbance, won : lost"])
        for case in order:
            cells = [f"`{case}`", f"{tuned[case]}", f"{COST[case]:g}"]
            for s in SETS:
                for q in QUANTITIES:
                    values = found[q, s][case]
                    low, high = interval(values)
                    cells.append(f"{np.median(values):.3g} ({low:.3g} to {high:.3g})")
            for q in QUANTITIES:
                if case == "qbank":
                    cells.append("")
                    continue
                wins, losses, p = against(pairs, q, "unseen", case, "qbank")
                cells.append(f"{wins} : {losses}" + (" **(p < 0.05)**" if p < 0.05 else ""))
            table.writerow(cells)
    draw(found, order, HERE.parent / "pictures/encoder-estimators.png")
    for number, case, value, error in wrong:
        print(f"row {number}: {case} is below the floor: {value:.3f} +- {error:.3f}", file=sys.stderr)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
