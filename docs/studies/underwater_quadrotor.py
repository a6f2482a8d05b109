#!/usr/bin/python3
"""Which estimator holds the quadrotor's station: the thesis' table over seeds, a rivals' tuning, twelve seas.

    docs/studies/underwater_quadrotor.py [pattern] [tune] [seas] [change]
        [--binary build/bin/quadrotor_waves] [--jobs 1] [--print-only]

Without a name it makes all but `tune`. Each part writes underwater-quadrotor-NAME.csv beside itself,
one row a run, and prints the medians as a Markdown table; --print-only reads the CSV instead. One run of 100 s takes
1 to 2 s of a core: `seas` has 720 of them. docs/methods/underwater-quadrotor.md says what comes out.
"""
import argparse
import csv
import itertools
import json
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent

METRICS = ["converged", "tracking_rmse_m", "max_error_m", "position_estimate_rmse_m",
           "vertical_force_rmse_N", "vertical_force_rmse_of_zero_N", "horizontal_force_rmse_N",
           "horizontal_force_rmse_of_zero_N", "thrust_rms_N", "saturated_fraction", "nees_mean"]
COLUMNS = ["case", "seed", "set", *METRICS]

THESIS = ["ukf-second", "ekf-second", "ukf-zero", "ekf-zero", "ukf-none", "ekf-none"]
SAME_Q = ["ekf-second-same-q", "ekf-zero-same-q"]
RIVALS = ["ukf-second-tuned", "ukf-zero-tuned"]

PATTERN_SEEDS = range(1, 11)
CHANGE_SEEDS = range(1, 4)
TUNING_SEEDS = range(1, 21)    # the Q of the scenario file was chosen on these ...
TEST_SEEDS = range(101, 121)   # ... and is judged on these
TUNING_SHORTLIST = 5           # of the grid, after its first few seeds
TUNING_FIRST_SEEDS = 4


def pattern():
    for reading in ("reading=consistent", "reading=literal",
                    "reading=consistent wave.significant_height_m=0"):
        cases = THESIS + (SAME_Q if reading == "reading=consistent" else [])
        yield [(case, seed, reading) for case in cases for seed in PATTERN_SEEDS]


def seas():
    for height, period in itertools.product((0.5, 1, 2, 3), (6, 8, 10)):
        sea = f"wave.significant_height_m={height} wave.peak_period_s={period}"
        yield [(case, seed, sea) for case in ["resonator", *RIVALS] for seed in TEST_SEEDS]


def change():
    """T_p goes from one value to another at 40 s, the metrics being of 100 to 160 s; a wrong guess."""
    for before, after in ((8, 11), (8, 6)):
        sea = (f"run.duration_s=160 wave.peak_period_s={before} wave.change_at_s=40 "
               f"wave.change_to_period_s={after}")
        yield [("resonator", seed, f"{sea} estimator.wave_frequency={frequency}")
               for frequency in ("given", "estimated") for seed in CHANGE_SEEDS]
    for guess in (5, 12):  # of 8 s
        yield [("resonator", seed,
                f"estimator.assumed_period_s={guess} estimator.wave_frequency={frequency}")
               for frequency in ("given", "estimated") for seed in CHANGE_SEEDS]


def grid():
    """What `tune` tries: each of the walks."""
    values = {"estimator.tuned_velocity_std_m_s": (3e-3, 0.01, 0.03),
              "estimator.tuned_rate_std_rad_s": (1e-3, 3e-3, 0.01),
              "estimator.tuned_disturbance_std": (1e-3, 3e-3, 0.01, 0.03, 0.1)}
    for point in itertools.product(*values.values()):
        yield " ".join(f"{key}={value:g}" for key, value in zip(values, point))


class Runner:
    def __init__(self, binary, jobs, folder):
        self.binary, self.folder, self.numbers = binary, Path(folder), itertools.count()
        self.pool = ThreadPoolExecutor(jobs)

    def all(self, calls):
        return list(self.pool.map(lambda call: self.run(*call), calls))

    def run(self, case, seed, sets):
        out = self.folder / f"run-{next(self.numbers)}"
        done = subprocess.run(
            [self.binary, "--case", case, "--seed", str(seed), "--quiet", "--out", out] +
            [word for setting in sets.split() for word in ("--set", setting)],
            capture_output=True, text=True, check=False)
        if done.returncode not in (0, 3):
            raise RuntimeError(done.stderr)
        row = {"case": case, "seed": seed, "set": sets, "converged": 0}
        if done.returncode == 0:  # else it ran away
            metrics = json.loads((out / "metrics.json").read_text())
            row |= {key: metrics[key] for key in METRICS if key in metrics}
        subprocess.run(["rm", "-r", out], check=True)
        return {key: f"{v:.5g}" if isinstance(v, float) else v for key, v in row.items()}


def rank(rows):
    """By the number of runs that converge, then by their tracking."""
    held = [float(r["tracking_rmse_m"]) for r in rows if float(r["converged"]) == 1]
    return -len(held), statistics.median(held) if held else float("inf")


def tune(runner):
    for case in RIVALS:
        points = list(grid())

        def measure(chosen, seeds):
            calls = [(case, seed, point) for point in chosen for seed in seeds]
            rows = runner.all(calls)
            return {p: [r for r in rows if r["set"] == p] for p in chosen}

        first = measure(points, TUNING_SEEDS[:TUNING_FIRST_SEEDS])
        best = sorted(points, key=lambda p: rank(first[p]))[:TUNING_SHORTLIST]
        rest = measure(best, TUNING_SEEDS[TUNING_FIRST_SEEDS:])
        yield [row for p in points for row in first[p] + rest.get(p, [])]


def measured(runner, name):
    if name == "tune":
        return tune(runner)
    return (runner.all(calls) for calls in {"pattern": pattern, "seas": seas, "change": change}[name]())


def print_table(rows):
    """Medians over the seeds that did not fail, and how many of all converged."""
    print("| set | case | seeds | converged | tracking [m] | largest error [m] | vertical force [N] | "
          "horizontal force [N] | thrust RMS [N] | saturated |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    groups = {}
    for row in rows:
        groups.setdefault((row["set"], row["case"]), []).append(row)
    for (sets, case), runs in groups.items():
        def values(key):
            return [float(r[key]) for r in runs if r.get(key) not in (None, "")]

        def median(key, form="{:.3f}"):
            return form.format(statistics.median(values(key))) if values(key) else "–"

        held = values("tracking_rmse_m")
        spread = f" ({min(held):.3f}–{max(held):.3f})" if held else ""
        seeds = [int(r["seed"]) for r in runs]
        print(f"| `{sets}` | `{case}` | {min(seeds)}–{max(seeds)} | "
              f"{sum(float(r['converged']) for r in runs):.0f} of {len(runs)} | "
              f"{median('tracking_rmse_m')}{spread} | {median('max_error_m')} | "
              f"{median('vertical_force_rmse_N')} / {median('vertical_force_rmse_of_zero_N')} | "
              f"{median('horizontal_force_rmse_N')} / {median('horizontal_force_rmse_of_zero_N')} | "
              f"{median('thrust_rms_N', '{:.1f}')} | "
              f"{100 * statistics.median(values('saturated_fraction') or [1]):.1f} % |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="pattern|tune|seas|change")
    parser.add_argument("--binary", default=HERE.parents[1] / "build" / "bin" / "quadrotor_waves")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--print-only", action="store_true")
    wish = parser.parse_args()
    for name in wish.parts or ["pattern", "seas", "change"]:
        if name not in ("pattern", "tune", "seas", "change"):
            parser.error(f"there is no part {name}")
        file = HERE / f"underwater-quadrotor-{name}.csv"
        if wish.print_only:
            with file.open(newline="") as text:
                print_table(list(csv.DictReader(text)))
            continue
        with tempfile.TemporaryDirectory() as folder, file.open("w", newline="") as text:
            writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
            writer.writeheader()
            for rows in measured(Runner(wish.binary, wish.jobs, folder), name):
                writer.writerows(rows)
                text.flush()
                print_table(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
