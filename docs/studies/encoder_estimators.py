#!/usr/bin/python3
"""Estimators behind an encoder against the floor: docs/explanation/against-published-methods.md.

    docs/studies/encoder_estimators.py [FOLDER] [--rows N,...]      # studies/encoder-estimators

encoder-estimators.toml has the rows, the generators of the disturbances, the tuned keys and the seeds.
FOLDER gets tuned.csv (the found keys), floors/ and results.csv (an RMSE for each row, estimator and block of 3 s).
Finished parts are not repeated; --rows makes results.csv of these rows alone. It needs the Python module and
build/tests/libparticle_filter.so (cmake --build build --target particle_filter). About half an hour of one core.
"""
import argparse
import csv
import ctypes
import math
import os
import sys
import tomllib
from pathlib import Path

import numpy as np
from scipy.signal import place_poles
from scipy.stats import qmc

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("BREAKWATER_BUILD", ROOT / "build"))
sys.path.insert(0, str(BUILD / "python"))
import breakwater as bw  # noqa: E402

STUDY = tomllib.loads((ROOT / "docs/studies/encoder-estimators.toml").read_text(encoding="utf-8"))
RECORD = STUDY["record"]
SMALLEST = 1e-9  # a velocity error below it is arithmetic [rad/s]


class Generator(ctypes.Structure):
    """GeneratedMotion of tests/observers/particle_filter.h, with x = [q, v, states of the disturbance]."""
    _fields_ = [("states", ctypes.c_int), ("A", ctypes.POINTER(ctypes.c_double)),
                ("B", ctypes.POINTER(ctypes.c_double)), ("D", ctypes.POINTER(ctypes.c_double)),
                ("initial_std", ctypes.POINTER(ctypes.c_double)), ("jumping", ctypes.c_int),
                ("jump_std", ctypes.c_double), ("jump_probability", ctypes.c_double), ("walking", ctypes.c_int),
                ("walk_std", ctypes.c_double)]

    def __init__(self, row):
        what, T, J = row["disturbance"], row["period_s"], inertia(row)
        parts, D, start = [], [], []
        jump, jump_std, p, walk, walk_std = -1, 0.0, 0.0, -1, 0.0
        if what["kind"] in ("steps", "ramps", "steps and sine"):
            jump_std, p = what["size"], what["rate_per_s"] * T
        if what["kind"] in ("steps", "steps and sine"):
            jump = 2
            parts, D, start = [np.eye(1)], [1.0], [jump_std]
        if what["kind"] == "ramps":
            jump = 3
            parts, D, start = [np.array([[1.0, T], [0.0, 1.0]])], [1.0, 0.0], [0.0, jump_std]
        if what["kind"] == "walk":
            decay = math.exp(-what["rate_per_s"] * T)
            walk, walk_std = 2, what["size"] * math.sqrt(1.0 - decay**2)
            parts, D, start = [np.array([[decay]])], [1.0], [what["size"]]
        if what["kind"] in ("sine", "steps and sine"):
            # A sine whose amplitude and phase drift: the noise doubles its strength on one of two states.
            size, decay = what.get("sine_size", what["size"]), math.exp(-0.05 * what["frequency_rad_s"] * T)
            angle = what["frequency_rad_s"] * T
            turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
            parts, D, start = parts + [decay * turn], D + [1.0, 0.0], start + [size, size]
            walk, walk_std = len(start) + 1, size * math.sqrt(2.0 * (1.0 - decay**2))
        n = 2 + len(start)
        A = np.zeros((n, n))
        A[:2, :2] = [[1.0, T], [0.0, 1.0]]
        at = 2
        for part in parts:
            A[at:at + len(part), at:at + len(part)] = part
            at += len(part)
        B = np.zeros(n)
        B[:2] = 0.5 * T * T / J, T / J
        row_d = np.concatenate([[0.0, 0.0], D])
        A -= np.outer(B, row_d)
        self.arrays = [np.ascontiguousarray(x) for x in (A, B, row_d, np.concatenate([[0.0, 0.0], start]))]
        pointers = [x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in self.arrays]
        super().__init__(n, *pointers, jump, jump_std, p, walk, walk_std)


def inertia(row):
    return row["disturbance"].get("inertia_kgm2", RECORD["inertia_kgm2"])


def quantum(row):
    return 2.0 * math.pi / 2.0**row["sensor"]["bits"]


def noise(row):
    return row["sensor"].get("noise_rad", 0.0)


def truncates(row):
    return row.get("rounding") == "truncate"


def is_known(row):
    """Whether the position is known but for the arithmetic."""
    return row["sensor"]["bits"] == 48 and noise(row) == 0.0


def interval(row, y):
    half = 0.5 * quantum(row)
    if not truncates(row):
        return y - half, y + half
    return np.where(y > half, y, y - 2 * half), np.where(y < -half, y, y + 2 * half)


def records(row, draws, seed):
    """u, y, v, d, each (draws, samples), of the row's axis under the fixed controller."""
    rng = np.random.default_rng(seed)
    T, delta, sigma = row["period_s"], quantum(row), noise(row)
    samples = round(RECORD["duration_s"] / T) + 1
    g = Generator(row)
    A, B, D, start = g.arrays
    model = np.array([[1.0, T, -0.5 * T * T], [0.0, 1.0, -T], [0.0, 0.0, 1.0]])
    gains = np.array([0.5 * T * T, T, 0.0])
    L = place_poles(model.T, model[0][:, None], np.exp(np.array(RECORD["poles_rad_s"]) * T)).gain_matrix[0]
    law = np.array([-RECORD["kp"], -RECORD["kd"], 1.0])
    x = start * rng.standard_normal((draws, len(B)))
    x[:, 0] = 0.0 if sigma else rng.uniform(*interval(row, np.zeros(draws)))
    estimate = np.zeros((draws, 3))
    u, y, v, d = (np.empty((draws, samples)) for _ in range(4))
    for k in range(samples):
        counts = np.trunc(x[:, 0] / delta) if truncates(row) else np.round(x[:, 0] / delta)
        y[:, k] = delta * counts + sigma * rng.standard_normal(draws)
        v[:, k], d[:, k] = x[:, 1], x @ D
        estimate += (y[:, k] - estimate[:, 0])[:, None] * L
        u[:, k] = estimate @ law
        estimate = estimate @ model.T + u[:, k, None] * gains
        x = x @ A.T + u[:, k, None] * B
        if g.walking >= 0:
            x[:, g.walking] += g.walk_std * rng.standard_normal(draws)
        if g.jumping >= 0:
            jumps = rng.random(draws) < g.jump_probability
            x[jumps, g.jumping] = g.jump_std * rng.standard_normal(jumps.sum())
    return u, y, v, d


def rmse(row, estimate, truth, blocks):
    """RMSE of equal blocks of time."""
    error = (estimate - truth)[round(RECORD["from_s"] / row["period_s"]):]
    values = [math.sqrt(np.mean(e * e)) if np.all(np.isfinite(e)) else math.inf for e in np.array_split(error, blocks)]
    return [value if value < 1e6 else math.inf for value in values]


def known_position_floor(row, d):
    """E[d(k) | d(0...k-1)] behind an exact position, which gives v and the past of d."""
    g = Generator(row)
    A = g.arrays[0][2:, 2:]
    p = g.jump_probability
    expected = np.zeros_like(d)
    if len(A) == 1:
        expected[1:] = (1.0 - p) * A[0, 0] * d[:-1]
        return expected
    second = np.zeros_like(d)  # the other state before its last, unseen change
    second[2:] = (1.0 - p) * (A[1, 0] * d[:-2] + A[1, 1] * (d[1:-1] - A[0, 0] * d[:-2]) / A[0, 1])
    expected[1:] = A[0, 0] * d[:-1] + A[0, 1] * second[1:]
    return expected


def floor(row, record, particles, seed):
    """[(RMSE of v, RMSE of d)] of the particle filter, for the blocks of one draw."""
    blocks = STUDY["floor"]["blocks"]
    u, y, v, d = (np.ascontiguousarray(x) for x in record)
    if is_known(row):
        return [(0.0, one) for one in rmse(row, known_position_floor(row, d), d, blocks)]
    lower, upper = (y, y) if noise(row) else (np.ascontiguousarray(x) for x in interval(row, y))
    estimates = np.empty_like(y), np.empty_like(y)
    library = ctypes.CDLL(str(BUILD / "tests/libparticle_filter.so"))
    pointer = lambda x: x.ctypes.data_as(ctypes.POINTER(ctypes.c_double))  # noqa: E731
    g = Generator(row)
    library.breakwater_particle_filter(ctypes.byref(g), len(y), pointer(u), pointer(lower), pointer(upper),
                                       ctypes.c_double(noise(row)), particles, ctypes.c_uint64(seed),
                                       *map(pointer, estimates))
    return list(zip(rmse(row, estimates[0], v, blocks), rmse(row, estimates[1], d, blocks)))


def make_floors(path, row, number, record):
    """[(RMSE of v, RMSE of d)] of the draws' blocks; in some rows, then of the first draw with more particles."""
    if not path.exists():
        settings = STUDY["floor"]
        found = [e for i, one in enumerate(zip(*record)) for e in floor(row, one, settings["particles"], i)]
        if number in settings["converged"]:
            found += floor(row, next(zip(*record)), settings["converged_particles"], 0)
        write(path, ["velocity", "disturbance"], [[f"{x:.6g}" for x in one] for one in found])
    return [(float(line["velocity"]), float(line["disturbance"])) for line in read(path)]


class Searched:
    """The box of an estimator's keys: a unit cube to keys."""

    def __init__(self, estimator):
        self.of = estimator
        self.boxes = [(key, box, False) for key, box in estimator.items()
                      if key not in ("name", "order", "fixed", "one_minus")]
        self.boxes += [(key, box, True) for key, box in estimator.get("one_minus", {}).items()]
        self.count = len(self.boxes) + estimator.get("order", False)

    def keys(self, point):
        keys = {}
        for (key, box, from_one), x in zip(self.boxes, point):
            value = box[0] * (box[1] / box[0])**x if len(box) == 2 else box[min(int(x * len(box)), len(box) - 1)]
            keys[key] = 1.0 - value if from_one else value
        if self.of.get("order"):
            keys["disturbance_order"] = int(point[-1] >= 0.5)
        return keys


KALMAN = {"kfd", "dkf", "fakfd"}
PUBLISHED = {"immkf", "immkf-code", "mckf", "mckf-code", "vbakf", "gsf"}


def make(case, row, keys):
    """The estimator of a case with the found keys."""
    if case == "gsf" and row["sensor"]["bits"] == 48:
        case = "dkf"  # a Gaussian sum over 2e-14 rad has equal parts, and takes ten times as long
    estimator = STUDY["estimator"][case]
    keys = estimator.get("fixed", {}) | keys
    order = keys.get("disturbance_order", 0)
    if estimator.get("order"):
        keys["disturbance_order"] = order
    variance = max(quantum(row)**2 / (3.0 if truncates(row) else 12.0) + noise(row)**2, 1e-26)
    if case in KALMAN:
        keys["observation_noise"] = variance
    if case in KALMAN | PUBLISHED:
        keys["initial_covariance"] = [variance, 1e-6] + [RECORD["largest_disturbance_Nm"]**2] * (1 + order)
    if case == "vfakfd":
        keys["initial_covariance"] = [keys["initial_covariance"]] * (3 + order)
    if case == "idob":
        pole = keys.pop("pole")
        keys["poles_rad_s"] = [-pole, -2.0 * pole, -3.0 * pole]
    if case == "qbank":  # not tuned
        keys["largest_disturbance"] = RECORD["largest_disturbance_Nm"]
    return bw.Observer(estimator.get("name", case), *bw.damped_inertia(RECORD["inertia_kgm2"]),
                           period_s=row["period_s"], delta=quantum(row), sigma=noise(row),
                           rounding=row.get("rounding", "nearest"),
                           pulses_per_revolution=2.0**row["sensor"]["bits"], **keys)


def errors(case, row, keys, record, blocks):
    """(RMSE of v, RMSE of d) of the blocks of each draw."""
    try:
        estimator = make(case, row, keys)
    except bw.InputError:  # an observer that cannot be designed
        return [(math.inf, math.inf)] * (blocks * len(record[0]))
    found = []
    for u, y, v, d in zip(*record):
        estimates = estimator.filter(u, y, x0=[0.0, 0.0])
        found += zip(rmse(row, estimates.x[:, 1], v, blocks), rmse(row, estimates.d[:, 0], d, blocks))
    return found


def score(case, worlds, keys):
    """Mean logarithm of both errors over the worlds."""
    values = [e for row, record in worlds for e in errors(case, row, keys, record, 1)]
    return float(np.mean([math.log(max(min(v, 1e6), SMALLEST)) + math.log(min(d, 1e6)) for v, d in values]))


def tune(case, worlds, seed):
    """The best keys of equally many evaluations for each estimator."""
    searched = Searched(STUDY["estimator"][case])
    if searched.count == 0:
        return {}, score(case, worlds, {})
    evaluations = STUDY["tuning"]["evaluations"]
    points = list(qmc.LatinHypercube(searched.count, seed=seed).random(evaluations // 2))
    rng = np.random.default_rng(seed)
    best = None, math.inf
    for i in range(evaluations):
        if i >= len(points):
            width = 0.15 if i < 3 * evaluations // 4 else 0.05
            points.append(np.clip(best[0] + width * rng.standard_normal(searched.count), 0.0, 1.0))
        value = score(case, worlds, searched.keys(points[i]))
        if value < best[1] or best[0] is None:
            best = points[i], value
    return searched.keys(best[0]), best[1]


def group(row):
    """The sensor and the period, for which an estimator is tuned."""
    sensor = f"{row['sensor']['bits']} bits" + (f", noise {noise(row)}" if noise(row) else "")
    return f"{1e3 * row['period_s']:g} ms, {sensor}"


def known_rows():
    return [{"period_s": period_s, "sensor": sensor, "disturbance": disturbance}
            for period_s in STUDY["rows"]["period_s"] for sensor in STUDY["rows"]["sensor"]
            for disturbance in STUDY["rows"]["disturbance"]]


def judged_records(row, number):
    settings = STUDY["floor"]
    draws = settings["draws"][STUDY["rows"]["period_s"].index(row["period_s"])]
    return records(row, draws, [settings["seed"], number])


def unseen_rows(seed):
    rng = np.random.default_rng(seed)
    log_uniform = lambda low, high: float(f"{low * (high / low)**rng.random():.3g}")  # noqa: E731
    rows = []
    for period_s in STUDY["rows"]["period_s"]:
        for sensor in STUDY["rows"]["sensor"]:
            if is_known({"sensor": sensor}):
                continue
            for kind in ["steps", "ramps", "sine", "walk", "steps and sine"][:STUDY["floor"]["unseen_per_class"]]:
                what = {"kind": kind, "size": log_uniform(0.1, 10.0), "rate_per_s": log_uniform(0.2, 3.0),
                        "frequency_rad_s": log_uniform(0.5, 10.0), "sine_size": log_uniform(0.1, 10.0),
                        "inertia_kgm2": 1.0 if rng.random() < 0.5 else log_uniform(0.5, 1.5)}
                if kind == "sine":
                    what.pop("sine_size")
                rows.append({"period_s": period_s, "sensor": sensor, "disturbance": what,
                             "rounding": "nearest" if rng.random() < 0.5 else "truncate"})
    for row in rows:
        what = row["disturbance"]
        named = {"steps": "steps of {size}, {rate_per_s}/s", "ramps": "ramps of {size}/s, {rate_per_s}/s",
                 "sine": "sine of {size}, {frequency_rad_s} rad/s", "walk": "walk of {size}, {rate_per_s}/s",
                 "steps and sine": "steps of {size}, {rate_per_s}/s, sine of {sine_size}, {frequency_rad_s} rad/s"}
        what["name"] = named[what["kind"]].format(**what)
        if what["inertia_kgm2"] != 1.0:
            what["name"] += f", J = {what['inertia_kgm2']}"
        if truncates(row):
            what["name"] += ", truncating"
    return rows


def write(path, head, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def make_tuned(path):
    classes = {}
    for number, row in enumerate(known_rows()):
        classes.setdefault(group(row), []).append((row, number))
    lines = []
    for number, (name, rows) in enumerate(classes.items()):
        settings = STUDY["tuning"]
        worlds = [(row, records(row, settings["draws"], [settings["seed"], i])) for row, i in rows]
        for case in STUDY["estimator"]:
            keys, value = tune(case, worlds, 100 * number)
            lines.append([name, case, " ".join(f"{k}={v!r}" for k, v in keys.items()), f"{value:.6g}"])
            print(*lines[-1], flush=True)
    write(path, ["class", "estimator", "keys", "mean logarithm of both errors"], lines)


def tuned_keys(path):
    number = lambda text: int(text) if text.lstrip("-").isdigit() else float(text)  # noqa: E731
    return {(line["class"], line["estimator"]): {k: number(v) for k, v in
                                                 (pair.split("=") for pair in line["keys"].split())}
            for line in read(path)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "studies/encoder-estimators")
    parser.add_argument("--rows", type=lambda text: [int(x) for x in text.split(",")])
    arguments = parser.parse_args()
    folder = arguments.folder
    (folder / "floors").mkdir(parents=True, exist_ok=True)
    if not (folder / "tuned.csv").exists():
        make_tuned(folder / "tuned.csv")
    keys = tuned_keys(folder / "tuned.csv")
    settings = STUDY["floor"]
    known = known_rows()
    rows = known + unseen_rows(settings["unseen_seed"])
    results, converged = [], []
    for number, row in enumerate(rows):
        if arguments.rows and number not in arguments.rows:
            continue
        record = judged_records(row, number)
        start = ["QBANK's study" if number < len(known) else "unseen", number, group(row), row["disturbance"]["name"]]
        floors = make_floors(folder / f"floors/{number}.csv", row, number, record)
        if number in settings["converged"]:
            few, many = floors[:settings["blocks"]], floors[-settings["blocks"]:]
            del floors[-settings["blocks"]:]
            root = lambda values: f"{math.sqrt(np.mean(np.square(values))):.6g}"  # noqa: E731
            converged.append([*start[1:], *(root([e[i] for e in found]) for found in (few, many) for i in (0, 1))])
        cases = {case: errors(case, row, dict(keys[group(row), case]), record, settings["blocks"])
                 for case in STUDY["estimator"]}
        for case, found in ({"floor": floors} | cases).items():
            results += [[*start, case, i, f"{v:.6g}", f"{d:.6g}"] for i, (v, d) in enumerate(found)]
        print(*start, *(f"{np.mean([x[i] for x in floors]):.3g}" for i in (0, 1)), flush=True)
    head = ["set", "row", "class", "disturbance"]
    write(folder / "results.csv", [*head, "estimator", "block", "rmse_velocity_rad_s", "rmse_disturbance_Nm"], results)
    write(folder / "converged.csv", [*head[1:], "velocity, 10^4 particles", "disturbance, 10^4 particles",
                                     "velocity, 10^5 particles", "disturbance, 10^5 particles"], converged)

if __name__ == "__main__":
    main()
