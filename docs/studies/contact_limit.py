#!/usr/bin/python3
"""The least free-motion time of the arm for a given peak force, and every controller against it.

    docs/studies/contact_limit.py [--binary build/bin/arm_wall_contact] [--jobs 2] [--plot-only]

Computes the limits from the arm's masses, torques and friction. Runs the cases over seeds with force noise.
Writes contact-limit.csv, contact-limit-runs.csv beside itself and ../pictures/contact-limit.png.
About three minutes on two cores. Needs Debian's python3-numpy and python3-matplotlib.
least-free-motion-time.md has the derivation.
"""
import argparse
import csv
import functools
import json
import math
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

HERE = Path(__file__).resolve().parent
LIMITS = HERE / "contact-limit.csv"
RUNS = HERE / "contact-limit-runs.csv"
PLOT = HERE.parent / "pictures" / "contact-limit.png"

# models/arm.xml: (link, along it [m], mass [kg], inertia [kg m^2]), armature, torque limits.
BODIES = [(0, .1, .22, 7.3333333e-4), (0, .2, .77, 3e-4), (1, .1, .22, 7.3333333e-4),
          (1, .2, .77, 3e-4), (2, .09, .2, 5.4e-4), (2, .19, .02, 8e-7)]
LINK_m = 0.2
ARMATURE_kgm2 = 0.8125
LIMIT_Nm = np.array([20.736, 20.736, 12.672])
# arm_wall_contact.toml
START_m, DISTANCE_m = 0.45, 0.089
LAG_s = 0.05
# The ranges of the walls of studies/published-impact.toml.
SOFT_N_m, STIFF_N_m, SPEED_m_s = 500.0, 4000.0, 0.02

STEP_s = 2e-4
PEAKS_N = (1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0)
SHAPE = np.array([1.0, -2.0, 1.0])  # q = SHAPE * theta holds y = 0 and phi = 0

CASES = [f"{name}-{force}N" for force in (2, 5) for name in ("proposed", "tuned", "hpfc", "drac", "tlsc")]
SEEDS = range(1, 4)
METRICS = ["free_motion_time_s", "peak_force_filtered_N", "impact_velocity_m_s", "bounce_count"]


def mass_matrix(q):
    angle = np.cumsum(q)
    across = np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    M = ARMATURE_kgm2 * np.eye(3)
    for link, where, mass, inertia in BODIES:
        J = np.zeros((2, 3))
        turns = np.zeros(3)
        for joint in range(link + 1):
            for k in range(joint, link + 1):
                J[:, joint] += (LINK_m if k < link else where) * across[k]
            turns[joint] = 1.0
        M += mass * J.T @ J + inertia * np.outer(turns, turns)
    return M


def path_terms(theta):
    """Terms of tau = m theta'' + c theta'^2 + friction + F j: m, c and the tip's j = dx/dq, on the path."""
    q, h = SHAPE * theta, 1e-5
    slopes = [(mass_matrix(q + h * e) - mass_matrix(q - h * e)) / (2 * h) for e in np.eye(3)]
    moved = sum(slopes[k] * SHAPE[k] for k in range(3)) @ SHAPE
    c = moved - 0.5 * np.array([SHAPE @ slopes[i] @ SHAPE for i in range(3)])
    angle = np.cumsum(q)
    j = np.array([-LINK_m * np.sum(np.sin(angle[i:])) for i in range(3)])
    return np.concatenate([mass_matrix(q) @ SHAPE, c, j])


@dataclass(frozen=True)
class Wall:
    """A wall, or walls as arrays, whose place is not part of it."""

    stiffness_N_m: float = 1000.0
    damping_Ns_m: float = 10.0
    speed_m_s: float = 0.0  # away from the arm


@functools.cache
def path():
    """Places of the tip [m], and the path_terms() there."""
    places = np.linspace(0.40, 0.599, 400)
    return places, np.array([path_terms(math.acos((x - LINK_m) / (2 * LINK_m))) for x in places])


class Arm:
    """The arm on the path y = 0, phi = 0, as a function of x and its speed."""

    def __init__(self, friction_Nm=4.0):
        self.friction_Nm = np.asarray(friction_Nm)[..., None]
        self.x, self.terms = path()
        self.step = self.x[1] - self.x[0]

    def acceleration(self, x, v, force, sign):
        """The largest (sign +1) or smallest x'' that the torques allow, under a force of the wall."""
        x = np.minimum(x, self.x[-1])
        at = np.clip((x - self.x[0]) / self.step, 0.0, len(self.x) - 2.0)
        i = at.astype(int)
        m, c, j = np.split(self.terms[i] + (at - i)[..., None] * (self.terms[i + 1] - self.terms[i]), 3, axis=-1)
        cosine = (x - LINK_m) / (2 * LINK_m)
        slope = -2 * LINK_m * np.sqrt(1 - cosine * cosine)  # dx/dtheta
        w = v / slope
        rest = c * (w * w)[..., None] + self.friction_Nm * np.sign(SHAPE * w[..., None]) + j * force[..., None]
        ends = np.array([(-LIMIT_Nm - rest) / m, (LIMIT_Nm - rest) / m])
        angular = np.max(ends.min(axis=0), axis=-1), np.min(ends.max(axis=0), axis=-1)
        curve = -2 * LINK_m * cosine * w * w
        found = np.sort([slope * a + curve for a in angular], axis=0)
        return found[1] if sign > 0 else found[0]

    def free(self, x, v, sign):
        return float(self.acceleration(np.array(x), np.array(v), np.array(0.0), sign))

    def drive(self, x_end):
        """(x, v) of the hardest acceleration from rest at the start."""
        x, v, course = START_m, 0.0, [(START_m, 0.0)]
        while x < x_end:
            # Friction opposes the first motion, too.
            v += STEP_s * self.free(x, max(v, 1e-9), +1)
            x += STEP_s * v
            course.append((x, v))
        return np.array(course)

    def peak(self, x_wall, v, wall):
        """The filtered peaks where a wall at x_wall is met at speed v and braked with all there is (arrays)."""
        x = x_wall
        filtered = largest = np.zeros_like(x)
        rises = np.full(x.shape, True)  # the arm may come back: the lagged force is still rising
        while True:
            force = np.maximum(0.0, wall.stiffness_N_m * (x - x_wall) + wall.damping_Ns_m * (v - wall.speed_m_s))
            filtered = filtered + STEP_s / LAG_s * (force - filtered)
            rises = rises & (filtered >= largest)
            if not rises.any():
                return largest
            peak = np.where(x < self.x[-1], filtered, np.inf)  # beyond, the arm would be stretched
            largest = np.where(rises, peak, largest)
            v = v + STEP_s * self.acceleration(x, v, force, -1)
            x = x + STEP_s * v
            x_wall = x_wall + STEP_s * wall.speed_m_s

    def contact_speed(self, x_wall, peak_N, walls):
        """The largest speed of contact for which the peak holds with each of the walls (arrays)."""
        slow, fast = np.zeros(np.broadcast_shapes(x_wall.shape, peak_N.shape)), 1.5
        for _ in range(18):
            middle = 0.5 * (slow + fast)
            holds = np.all([self.peak(x_wall + 0.0 * slow, middle, wall) <= peak_N for wall in walls], axis=0)
            slow, fast = np.where(holds, middle, slow), np.where(holds, fast, middle)
        return slow

    def brake_to(self, x_end, v_end):
        """(x, v) of the hardest braking that ends there, from the start on."""
        x, v, course = x_end, v_end, [(x_end, v_end)]
        while x > START_m:
            v -= STEP_s * self.free(x, v, -1)
            x -= STEP_s * v
            course.append((x, v))
        return np.array(course[::-1])


def time_under(drive, caps, end):
    """From rest at the start to `end`, as fast as it can be driven below the speeds `caps` (x, v)."""
    x = np.linspace(START_m, end, 4001)
    # v^2 is about linear in x where a is constant.
    driven = np.interp(x, drive[:, 0], drive[:, 1] ** 2)
    speed = np.sqrt(np.minimum(driven, np.interp(x, caps[:, 0], caps[:, 1]) ** 2))
    return float(np.sum(2 * np.diff(x) / (speed[1:] + speed[:-1])))


def time_to_wall(drive, caps, distance_m, speed_m_s):
    """As time_under(), to a wall that moves away at this speed."""
    time_s = 0.0
    for _ in range(30 if speed_m_s else 1):
        time_s = time_under(drive, caps, START_m + distance_m + speed_m_s * time_s)
    return time_s


def limits():
    arm = Arm()
    end = START_m + DISTANCE_m
    drive = arm.drive(end + 0.01)
    places = np.linspace(START_m, end, 8)
    peaks = np.array(PEAKS_N)[:, None]
    # The stiffest and the nearing wall decide. The others show that it is so.
    speeds = {name: arm.contact_speed(places, peaks, walls) for name, walls in
              {"unknown_s": [Wall()],
               "any_speed_s": [Wall(speed_m_s=speed) for speed in (-SPEED_m_s, 0.0, SPEED_m_s)],
               "any_stiffness_s": [Wall(K, 10.0 * math.sqrt(K / 1000.0)) for K in (SOFT_N_m, 1000.0, STIFF_N_m)],
               }.items()}
    rows = []
    for i, peak_N in enumerate(PEAKS_N):
        times = {name: round(time_under(drive, np.column_stack([places, v[i]]), end), 4) for name, v in speeds.items()}
        at_wall = speeds["unknown_s"][i, -1]
        known = time_under(drive, arm.brake_to(end, at_wall), end)
        rows.append({"peak_N": peak_N, "known_s": round(known, 4), "unknown_s": times.pop("unknown_s"),
                     "speed_at_wall_m_s": round(at_wall, 4), **times})
    return rows


def run(binary, case, seed):
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        subprocess.run([binary, "--case", case, "--seed", str(seed), "--duration", "33", "--quiet", "--out", out,
                        "--set", "sensor.force_noise_N=0.02"], check=True, capture_output=True)
        metrics = json.loads((out / "metrics.json").read_text())
    return {"case": case, "seed": seed, **{name: metrics.get(name) for name in METRICS}}


def write(file, rows):
    with open(file, "w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read(file):
    with open(file, newline="", encoding="utf-8") as rows:
        return list(csv.DictReader(rows))


def plot():
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows, runs = read(LIMITS), read(RUNS)
    peak = np.array([float(r["peak_N"]) for r in rows])
    known = 1e3 * np.array([float(r["known_s"]) for r in rows])
    unknown = 1e3 * np.array([float(r["unknown_s"]) for r in rows])
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axis = plt.subplots(figsize=(7.5, 4.6), constrained_layout=True)
    axis.fill_between(peak, 0, known, color="0.80", lw=0)
    axis.fill_between(peak, known, unknown, color="0.91", lw=0)
    axis.plot(peak, unknown, color="0.25", lw=1.5)
    axis.plot(peak, known, color="0.25", lw=1.5, ls="--")
    axis.text(2.2, 240, "impossible with these torques", color="0.25")
    axis.text(2.2, 325, "only where the wall's place is known", color="0.25")
    names = {"proposed": ("proposed", "#1b6ca8", "o"), "tuned": ("proposed, tuned", "#6aa5d8", "D"),
             "hpfc": ("HPFC", "#2a9d5c", "s"), "drac": ("DRAC", "#d1495b", "^"), "tlsc": ("TLSC", "#e08a1e", "*")}
    for name, (label, colour, mark) in names.items():
        for force in (2, 5):
            points = [r for r in runs if r["case"] == f"{name}-{force}N"]
            x = median(float(r["peak_force_filtered_N"]) for r in points)
            y = 1e3 * median(float(r["free_motion_time_s"]) for r in points)
            axis.plot(x, y, mark, color=colour, ms=11 if mark == "*" else 7, mfc=colour if force == 2 else "white",
                      mew=1.5, label=label if force == 2 else None)
            axis.annotate(f"{force} N", (x, y), textcoords="offset points", xytext=(-22, 8) if name == "tuned" else (8, 3), color=colour)
    axis.set(xlabel="filtered peak force [N]", ylabel="free-motion time [ms]", xlim=(1, 14), ylim=(200, 1150))
    axis.grid(alpha=0.25)
    axis.legend(frameon=False, loc="upper right")
    figure.savefig(PLOT, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=Path, default=HERE.parent.parent / "build/bin/arm_wall_contact")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--plot-only", action="store_true")
    options = parser.parse_args()
    if not options.plot_only:
        write(LIMITS, limits())
        with ThreadPoolExecutor(options.jobs) as pool:
            jobs = [pool.submit(run, options.binary, case, seed) for case in CASES for seed in SEEDS]
            write(RUNS, [job.result() for job in jobs])
    plot()


if __name__ == "__main__":
    main()
