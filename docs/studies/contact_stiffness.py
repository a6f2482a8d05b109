#!/usr/bin/python3
"""How the impact of arm_wall_contact depends on the contact's stiffness; where it starts to bounce.

    docs/studies/contact_stiffness.py [--binary build/bin/arm_wall_contact] [--jobs 2] [--plot-only]

Runs the scenario over stiffness, damping, wall distance, timestep and force filter, and writes
contact-stiffness.csv beside itself and ../pictures/contact-stiffness.png. About 10 minutes on two
cores. Needs Debian's python3-numpy, python3-h5py and python3-matplotlib. contact-stiffness.md says
what comes out.
"""
import argparse
import csv
import itertools
import json
import math
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
CSV = HERE / "contact-stiffness.csv"
PLOT = HERE.parent / "pictures" / "contact-stiffness.png"

CASES = [f"{name}-{force}N" for force in (2, 5) for name in ("proposed", "hpfc", "drac")]
STIFFNESS = [200, 500, 1000, 2000, 5000, 10000, 20000, 50000, 100000]

# Where the contact is called settled; contact-stiffness.md explains it.
SMALL_ERROR = 0.01  # of F_ref, the standard deviation of the force error over 50-100 s
DECAYED = 0.5       # std of the force in the last 10 s over that in the first 10 s of the window
RESOLUTION = 1.10   # of the stiffness at which a limit cycle starts

IMPACT_s = 33.0     # long enough for the impact
SHORT_s = 31.5      # the same where the blow is short, and before a controller can run away
LATE_s = 100.0      # long enough for the window of the force error

METRICS = ["peak_force_raw_N", "peak_force_filtered_N", "free_motion_time_s", "contact_impulse_Ns",
           "impact_velocity_m_s", "bounce_count", "std_force_error_N", "saturated_time_s"]
COLUMNS = ["study", "case", "stiffness_N_m", "damping_Ns_m", "changed", "duration_s", *METRICS,
           "late_bounces", "late_std_ratio", "late_frequency_Hz", "free_inertia_kg",
           "closed_form_peak_N", "behaviour"]


def damping_of(stiffness):
    """A constant damping ratio through the default, 10 N s/m at 1000 N/m."""
    return 10.0 * math.sqrt(stiffness / 1000.0)


def reference_N(case):
    return 5.0 if case.endswith("5N") else 2.0


def free_inertia_kg(q):
    """1 / (J M^-1 J^T)_xx: what a short blow along x at the tip meets, all joints free to recoil."""
    bodies = [(0, .1, .22, 7.3333333e-4), (0, .2, .77, 3e-4), (1, .1, .22, 7.3333333e-4),
              (1, .2, .77, 3e-4), (2, .09, .2, 5.4e-4), (2, .19, .02, 8e-7)]  # models/arm.xml
    angle = np.cumsum(q)
    along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    joints = np.vstack([np.zeros(2), np.cumsum(0.2 * along, axis=0)])

    def jacobian(link, distance):
        J = np.zeros((3, 3))
        for k in range(link + 1):
            r = joints[link] + distance * along[link] - joints[k]
            J[:, k] = -r[1], r[0], 1.0
        return J

    M = 0.8125 * np.eye(3)  # the armatures
    for link, distance, mass, inertia in bodies:
        J = jacobian(link, distance)
        M += mass * J[:2].T @ J[:2] + inertia * np.outer(J[2], J[2])
    J = jacobian(2, 0.2)
    return 1.0 / (J[0] @ np.linalg.solve(M, J[0]))


class Runner:
    def __init__(self, binary, jobs, folder):
        self.binary, self.folder, self.numbers = binary, Path(folder), itertools.count()
        self.pool = ThreadPoolExecutor(jobs)

    def all(self, calls):
        return list(self.pool.map(lambda call: self.run(*call), calls))

    def run(self, study, case, stiffness, damping, duration, changed=None):
        changed = changed or {}
        out = self.folder / f"run-{next(self.numbers)}"
        sets = {"contact.stiffness_N_m": stiffness, "contact.damping_Ns_m": damping,
                "run.duration_s": duration, "record.fine_to_s": 29.9,  # no log at the physics rate
                **changed}
        done = subprocess.run(
            [self.binary, "--case", case, "--quiet", "--out", out] +
            [word for key, value in sets.items() for word in ("--set", f"{key}={value}")],
            capture_output=True, text=True, check=False)
        if done.returncode not in (0, 3):
            raise RuntimeError(done.stderr)
        row = {"study": study, "case": case, "stiffness_N_m": stiffness, "damping_Ns_m": damping,
               "duration_s": duration,
               "changed": " ".join(f"{key}={value}" for key, value in changed.items())}
        if done.returncode == 3:
            row["behaviour"] = "runs away"
        else:
            metrics = json.loads((out / "metrics.json").read_text())
            row |= {key: metrics[key] for key in METRICS if key in metrics}
            with h5py.File(out / "log.h5") as log:
                self.look_at(log["control"], row)
        subprocess.run(["rm", "-r", out], check=True)
        print(*(f"{v:.5g}" if isinstance(v, float) else v for v in row.values()), flush=True)
        return row

    @staticmethod
    def look_at(log, row):
        t = log["time_s"][()]
        contact = np.searchsorted(t, 30.0 + row["free_motion_time_s"])
        m = free_inertia_kg(log["q_true_rad"][contact])
        K, B = row["stiffness_N_m"], row["damping_Ns_m"]
        zeta = B / (2.0 * math.sqrt(K * m))
        row["free_inertia_kg"] = m
        if zeta < 1.0:
            # Largest K x + B dx/dt after dx/dt = v at x = 0 (on the way in, zeta < 1/2).
            wd = math.sqrt(1.0 - zeta * zeta)
            row["closed_form_peak_N"] = (math.sqrt(K * m) * row["impact_velocity_m_s"] *
                                         math.exp(-zeta / wd * math.atan2(
                                             wd * (1 - 4 * zeta * zeta),
                                             zeta * (3 - 4 * zeta * zeta))))
        if "std_force_error_N" not in row:
            return
        force = log["force_true_N"][()]

        def window(a, b):
            return force[(t >= a) & (t < b)]

        late, touches = window(50, 100), window(50, 100) > 0
        row["late_bounces"] = int(np.count_nonzero(touches[1:] & ~touches[:-1]))
        row["late_std_ratio"] = float(window(90, 100).std() / window(50, 60).std())
        above = late > late.mean()
        row["late_frequency_Hz"] = np.count_nonzero(above[1:] & ~above[:-1]) / 50.0
        small = row["std_force_error_N"] <= SMALL_ERROR * reference_N(row["case"])
        if row["late_bounces"] > 0:
            row["behaviour"] = "bounces"
        elif small or row["late_std_ratio"] < DECAYED:
            row["behaviour"] = "settles"
        else:
            row["behaviour"] = "oscillates"

    def start(self, study, case, damping, low, high, changed):
        """Bisects to where the contact stops settling, from a stiffness that settles or from a
        bracket (low settles, high does not)."""
        rows = []

        def settles(K):
            rows.append(self.run(study, case, K, damping(K), LATE_s, changed))
            return rows[-1]["behaviour"] == "settles"

        while high is None and low < 1e5:
            low, high = (2.0 * low, None) if settles(2.0 * low) else (low, 2.0 * low)
        while high is not None and high / low > RESOLUTION:
            middle = float(f"{math.sqrt(low * high):.3g}")
            low, high = (middle, high) if settles(middle) else (low, middle)
        return rows

    def starts(self, study, brackets, damping=damping_of, changed=None):
        found = self.pool.map(
            lambda case: self.start(study, case, damping, *brackets[case], changed), brackets)
        return [row for rows in found for row in rows]


def bracket(late, case):
    """The last stiffness of the grid before, and the first at which, the contact does not settle."""
    first = min(r["stiffness_N_m"] for r in late
                if r["case"] == case and r["behaviour"] != "settles")
    return STIFFNESS[STIFFNESS.index(first) - 1], first


def measure(runner):
    yield runner.all([("impact", c, K, damping_of(K), IMPACT_s if K < 50000 else SHORT_s)
                      for c in CASES for K in STIFFNESS])
    late = runner.all([("late", c, K, damping_of(K), LATE_s) for c in CASES for K in STIFFNESS])
    yield late
    brackets = {case: bracket(late, case) for case in CASES}
    yield runner.starts("start", brackets)
    # Is the physics converged?
    yield runner.all([("timestep", c, 1e5, damping_of(1e5), 31.5, {"physics.timestep_s": dt})
                      for c in CASES for dt in (1e-4, 5e-5)])
    yield runner.all([("closed form", c, K, damping_of(K), 31.5, {"physics.timestep_s": 2.5e-5})
                      for c in CASES for K in (1e6, 1e7, 1e8)])
    # B at K = 1000 N/m, the wall's place, B fixed.
    yield runner.all([("damping", c, 1000, B, IMPACT_s) for c in CASES for B in (1, 3, 10, 30, 100)])
    yield runner.all([("distance", c, 1000, 10.0, IMPACT_s, {"wall.distance_m": d})
                      for c in CASES for d in (0.087, 0.091)])
    yield runner.starts("start, B = 10", brackets, lambda K: 10.0)


def plot(rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    colours = {"proposed": "#0b6e99", "hpfc": "#2e8b57", "drac": "#c8551b"}
    figure, axes = plt.subplots(2, 2, figsize=(9.6, 7.2), sharex=True, sharey="row")
    for column, force in enumerate(("2N", "5N")):
        for name, colour in colours.items():
            case = f"{name}-{force}"

            def series(study, key):
                chosen = [r for r in rows if r["study"] == study and r["case"] == case and r.get(key)]
                return ([float(r["stiffness_N_m"]) for r in chosen],
                        [float(r[key]) for r in chosen])

            top, bottom = axes[0][column], axes[1][column]
            top.plot(*series("impact", "peak_force_raw_N"), "-o", color=colour, ms=3.5, label=f"{name}, raw")
            top.plot(*series("impact", "peak_force_filtered_N"), "--s", color=colour, ms=3,
                     label=f"{name}, filtered")
            K, line = series("impact", "closed_form_peak_N")
            top.plot(K, line, ":", color=colour, lw=1)
            K, std = series("late", "std_force_error_N")
            bottom.plot(K, [s / float(force[0]) for s in std], "-o", color=colour, ms=3.5, label=name)
            starts = [r for r in rows if r["study"] == "start" and r["case"] == case]
            first = min(float(r["stiffness_N_m"]) for r in starts if r["behaviour"] != "settles")
            bottom.axvline(first, color=colour, lw=1, ls="-.")
        top.set_title(f"F_ref = {force[0]} N")
        bottom.axhline(SMALL_ERROR, color="0.5", lw=0.8)
        bottom.text(205, SMALL_ERROR * 1.15, "criterion: 1 % of F_ref", color="0.35", fontsize=8)
        bottom.set_xlabel("contact stiffness K [N/m]")
    for axis in axes.flat:
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.grid(True, which="major", color="0.88")
    axes[0][0].set_ylabel("peak force [N]")
    axes[1][0].set_ylabel("std of force error, 50–100 s, / F_ref")
    axes[0][0].plot([], [], ":", color="0.3", lw=1, label="closed form, raw")
    axes[1][0].plot([], [], "-.", color="0.3", lw=1, label="no longer settles")
    axes[0][0].legend(fontsize=8)
    axes[1][0].legend(fontsize=8, loc="upper left")
    figure.tight_layout()
    figure.savefig(PLOT, dpi=85)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--binary", default=HERE.parents[1] / "build/bin/arm_wall_contact")
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--plot-only", action="store_true", help="from the CSV there is")
    options = arguments.parse_args()
    if not options.plot_only:
        rows = []
        with tempfile.TemporaryDirectory() as folder:
            for part in measure(Runner(options.binary, options.jobs, folder)):
                rows += part
                with CSV.open("w", newline="") as file:
                    writer = csv.DictWriter(file, COLUMNS, restval="")
                    writer.writeheader()
                    for row in rows:
                        writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value
                                         for key, value in row.items()})
    with CSV.open() as file:
        plot(list(csv.DictReader(file)))


if __name__ == "__main__":
    main()
