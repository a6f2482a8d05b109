#!/usr/bin/python3
"""Makes docs/studies/published-waves*.csv and docs/pictures/published-waves.png for
docs/explanation/against-published-methods.md.

    breakwater tune studies/published-waves-tuning.toml --out FOLDER/tuned
    docs/studies/published_waves.py FOLDER [--jobs N]

Each contestant runs with its tuned values in the seas of studies/published-waves.toml. Finished sweeps are not repeated.
"""
import argparse
import statistics
import subprocess
from pathlib import Path

from contact_laws import COLOURS, holm, median_interval, plt
from contact_laws_runs import sweep
from contact_limit import read, write
from scipy.stats import wilcoxon

HERE = Path(__file__).resolve().parent
STUDY = HERE.parents[1] / "studies" / "published-waves.toml"
FLOOR, OURS = "mpc-told", "spectrum"
THESIS = ["ukf-zero-tuned"]
SEA = ["wave.significant_height_m", "wave.peak_period_s", "seed"]
METRICS = ["tracking_rmse_m", "max_error_m", "thrust_rms_N", "saturated_fraction"]
KEYS = ("controller.", "estimator.")


def found(folder):
    """{case: its tuned keys}"""
    return {row["case"]: {key: value for key, value in row.items()
                          if key.startswith(KEYS) and value and not key.endswith("gains")}
            for row in read(folder / "tuned" / "tuned.csv")}


def judge(folder, case, keys, jobs, name=None):
    out = folder / "judged" / (name or case)
    sets = [f"{key}={value}" for key, value in keys.items()]
    if "controller.horizontal_gain" in keys:
        sets.append('controller.gains="given"')
    sweep(out, [case], sets, jobs, STUDY)
    return read(out / "results.csv")


def shipped(folder, jobs):
    """Rows about the shipped cases, by the program's own comparison."""
    out = folder / "shipped"
    if not (out / "comparison.csv").exists():
        subprocess.run(["breakwater", "sweep", STUDY, "--baseline", OURS, "--out", out, "--jobs", str(jobs), "--quiet"], check=True)
    rows = [row for row in read(out / "comparison.csv") if row["metric"] == "tracking_rmse_m" and row["p_holm"]]
    won = [round(float(row["probability_better"]) * int(row["blocks"])) for row in rows]
    return [{"case": row["candidate"], "wins over spectrum": wins, "losses": int(row["blocks"]) - wins,
             "tracking [m]": f"{float(row['median']):.4f}", "of spectrum [m]": f"{float(row['reference_median']):.4f}",
             "difference [mm] (95 %)": "{:.1f} ({:.1f} to {:.1f})".format(
                 *(1e3 * float(row[key]) for key in ("difference", "difference_lower", "difference_upper"))),
             "p (Holm)": f"{float(row['p_holm']):.2g}", "verdict": row["verdict"]} for row, wins in zip(rows, won)]


def draw(ratios):
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(7, 3.2))
    for place, (case, values) in enumerate(ratios.items()):
        colour = COLOURS[0] if case.startswith(OURS) else "#777777" if case in THESIS else COLOURS[1]
        axes.plot(values, [place] * len(values), "o", color="black" if case == FLOOR else colour, alpha=0.5, markersize=5)
        axes.plot(statistics.median(values), place, "|", color="black", markersize=18)
    axes.set_yticks(range(len(ratios)), ratios)
    axes.invert_yaxis()
    axes.set_xscale("log")
    ticks = [1, 1.5, 2, 3, 5, 10, 20, 50]
    axes.set_xticks(ticks, [str(tick) for tick in ticks], minor=False)
    axes.set_xticks([], minor=True)
    axes.set_xlabel("position error over that of the floor, 12 seas; | median")
    axes.grid(axis="x", alpha=0.3)
    figure.tight_layout()
    figure.savefig(HERE.parent / "pictures" / "published-waves.png", dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    tuned = found(arguments.folder)
    write(HERE / "published-waves-tuned.csv", read(arguments.folder / "tuned" / "tuned.csv"))
    runs = {case: judge(arguments.folder, case, keys, arguments.jobs) for case, keys in tuned.items()}
    # The floor may choose its weights after the fact: its own, or those that were found for the probe.
    other = FLOOR + "-other-weights"
    judged = runs | {other: judge(arguments.folder, FLOOR, tuned["mpc-upstream"], arguments.jobs, other)}
    write(HERE / "published-waves-runs.csv", [{"case": case, **{key: row[key] for key in SEA + METRICS}}
                                       for case, rows in judged.items() for row in rows])
    error = {case: [float(row["tracking_rmse_m"] or "inf") for row in rows] for case, rows in judged.items()}
    error[FLOOR] = [min(pair) for pair in zip(error[FLOOR], error.pop(other))]
    table, pairs = [], []
    for case, rows in runs.items():
        ratio, low, high = median_interval([e / f for e, f in zip(error[case], error[FLOOR])])
        table.append({
            "case": case,
            "position error over the floor's (95 %)": f"{ratio:.2f} ({low:.2f}–{high:.2f})",
            "tracking [m]": f"{statistics.median(error[case]):.4f}",
            "thrust RMS [N]": f"{statistics.median(float(row['thrust_rms_N']) for row in rows):.2f}",
            "saturated [%]": f"{100 * statistics.median(float(row['saturated_fraction']) for row in rows):.2f}",
            "tuned values": len(tuned[case])})
    draw({case: [e / f for e, f in zip(error[case], error[FLOOR])] for case in runs})
    tests = []
    for case in runs:
        if case != OURS:
            gaps = [a - b for a, b in zip(error[case], error[OURS])]
            tests.append([case, gaps, wilcoxon(gaps, method="exact").pvalue])
    tests.sort(key=lambda test: test[-1])
    holm(tests)
    for case, gaps, p in tests:
        ratio, low, high = median_interval([a / b for a, b in zip(error[case], error[OURS])])
        pairs.append({"case": case, "wins over spectrum": sum(g < 0 for g in gaps), "losses": sum(g > 0 for g in gaps),
                      "error over that of spectrum (95 %)": f"{ratio:.2f} ({low:.2f}–{high:.2f})", "p (Holm)": f"{p:.2g}"})
    write(HERE / "published-waves-table.csv", table)
    write(HERE / "published-waves-pairs.csv", pairs)
    write(HERE / "published-waves-shipped.csv", shipped(arguments.folder, arguments.jobs))


if __name__ == "__main__":
    main()
