#!/usr/bin/python3
"""Whether a controller tuned on an identified plant does on the true plant what was predicted.

    docs/studies/identified_loop.py [FOLDER] [--plants N] [--jobs N]       # studies/identified-loop, 50 plants

A hidden plant gets a bench record by the simulator of this file, `identify`, `tune` with draws of draws.csv, and
`sweep` with draws of draws.csv and the found controller. Then the hidden plant runs. Two candidates are tuned in the
same way without a bench, on a typical plant and on eight plants of the series. FOLDER/N has the parts of plant N.
Finished plants are not repeated. The results are identified-loop.csv beside this file, and a summary.
"""
import argparse
import csv
import json
import math
import random
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
METRIC = "rms_position_rad"
PERIOD_S = 1e-3
BENCH_S = 2.0
FREQUENCIES_HZ = [0.7, 1.3, 2.9, 4.7, 8.3]
TYPICAL = {"inertia": 1.5e-3, "viscous": 3e-3, "coulomb": 0.06, "offset": 0.0, "delay": 2.5e-3}
ENCODER_BITS = [10, 12, 14]
BUDGET = 64
SEARCH_SEEDS = 4
SEARCH_DRAWS = 2  # the first ones of draws.csv
SERIES = 8  # plants of the candidate "series"
# The prediction: the first ones of draws.csv, each with these seeds. The noise matters more than the draws.
DRAWS, SEEDS = 16, 40
OUTSIDE = DRAWS * SEEDS // 40  # the end of the interval is the run of this rank
# Keys of all runs.
TASK = {"observer.name": '"kfd"', "observer.process_noise_on": '"disturbance"',
        "observer.initial_covariance": "[1, 1, 1]", "run.duration_s": "0.8", "disturbance.start_s": "0.2"}
KEYS = {"inertia": "inertia_kgm2", "viscous": "viscous_Nms", "coulomb": "coulomb_Nm", "offset": "offset_Nm",
        "delay": "delay_s"}  # of identified.json


def call(*words):
    """The exit status. 3 is a failed run or a fit that is not to be used."""
    done = subprocess.run(list(map(str, words)), check=False, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f"{' '.join(map(str, words))}: status {done.returncode}\n{done.stderr}")
    return done.returncode


def hidden_plant(number):
    draw = random.Random(f"plant {number}")
    plant = {"inertia": 1.5e-3 * 2 ** draw.uniform(-1, 1), "viscous": 3e-3 * 2 ** draw.uniform(-1, 1),
             "coulomb": draw.uniform(0.02, 0.1), "offset": draw.uniform(-0.03, 0.03),
             "delay": draw.uniform(1e-3, 4e-3), "bits": draw.choice(ENCODER_BITS)}
    count = 2 * math.pi / 2 ** plant["bits"]
    return plant | {"noise": count * draw.uniform(0.3, 1.5), "phase": count * draw.uniform(-0.5, 0.5)}


def bench(plant, number):
    """Rows (t, u, y) under a multisine: J dv/dt = u(t - delay) - offset - c v - F sgn(v), piecewise in closed form."""
    draw = random.Random(f"bench {number}")
    phases = [draw.uniform(0, 2 * math.pi) for _ in FREQUENCIES_HZ]
    times = [round((k + draw.uniform(-0.03, 0.03)) * PERIOD_S, 7) for k in range(round(BENCH_S / PERIOD_S))]
    inputs = [round(sum(0.15 * math.sin(2 * math.pi * f * t + p) for f, p in zip(FREQUENCIES_HZ, phases)), 6)
              for t in times]
    count = 2 * math.pi / 2 ** plant["bits"]
    q, v, i, now, rows = draw.uniform(0, 1), 0.0, 0, times[0], []
    for t, u in zip(times, inputs):
        while now < t:
            while i + 1 < len(times) and times[i + 1] + plant["delay"] <= now:
                i += 1
            step = t - now
            if i + 1 < len(times):
                step = min(step, times[i + 1] + plant["delay"] - now)
            torque = inputs[i] - plant["offset"]
            now += step
            if v == 0 and abs(torque) <= plant["coulomb"]:
                continue
            end = (torque - math.copysign(plant["coulomb"], v if v != 0 else torque)) / plant["viscous"]
            rate = plant["viscous"] / plant["inertia"]
            moved = step if v * end >= 0 else min(step, math.log(1 - v / end) / rate)  # until standstill
            now += moved - step
            after = end + (v - end) * math.exp(-rate * moved)
            q += end * moved + (v - after) / rate
            v = 0.0 if abs(after) < 1e-12 else after
        rows.append((t, u, count * round(q / count + draw.gauss(0, plant["noise"] / count))))
    return rows


def plant_keys(plant):
    """The keys of a plant in a run."""
    return {"plant.inertia_ratio": plant["inertia"], "plant.viscous_friction_Nms_rad": plant["viscous"],
            "plant.coulomb_friction_Nm": plant["coulomb"], "disturbance.offset_Nm": plant["offset"],
            "control.delay_s": plant["delay"]}


def sets_of(keys):
    return [f"{key}={value}" for key, value in keys.items()]


def tuned(file, folder, jobs):
    """The found keys."""
    if not (folder / "tuned.csv").exists():
        call("breakwater", "tune", file, "--out", folder, "--jobs", jobs, "--quiet")
    with open(folder / "tuned.csv", newline="", encoding="utf-8") as table:
        row = next(csv.DictReader(table))
    return {key: row[key] for key in ("controller.kp", "controller.kd", "observer.process_noise")}


def drawn(file, count):
    """{key: values} of the first draws."""
    with open(file, newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))[:count]
    return {key: f"[{', '.join(row[key] for row in rows)}]" for key in rows[0]}


def interval(source, file, folder, keys, jobs):
    """The 95 % interval of the metric over the first draws, and the number of failed runs."""
    file.write_text(toml(head("id/identified.toml", SEEDS, {"method": '"list"'}) | {
        "set": keys, "vary": drawn(source, DRAWS)}), encoding="utf-8")
    call("breakwater", "sweep", file, "--out", folder, "--jobs", jobs, "--quiet")
    with open(folder / "results.csv", newline="", encoding="utf-8") as table:
        values = sorted(float(row[METRIC] or math.inf) for row in csv.DictReader(table))
    return values[OUTSIDE - 1], values[-OUTSIDE], sum(map(math.isinf, values))


def true_metric(folder, config, plant, number, found):
    keys = TASK | plant_keys(plant) | found | {
        "noise.std_rad": plant["noise"], "encoder.phase_rad": plant["phase"], "run.seed": 100000 + number}
    status = call("breakwater", "run", "motor_estimation", "--config", config, "--set", *sets_of(keys),
                  "--out", folder, "--quiet")
    return math.inf if status else json.loads((folder / "metrics.json").read_text(encoding="utf-8"))[METRIC]


def toml(tables):
    """Tables of plain values; the table "" comes first."""
    return "".join((f"[{name}]\n" if name else "") + "".join(f'"{key}" = {value}\n' for key, value in table.items())
                   for name, table in tables.items())


def head(config, seeds, more):
    return {"": {"scenario": '"motor_estimation"', "config": f'"{config}"',
                 "seeds": f"{{ first = 1, count = {seeds} }}"} | more}


def tuning(config, keys, search, most_torque, world, seeds):
    """A tuning in all test conditions of `world`, with these seeds."""
    ranges = {key: f"{{ log_uniform = [{low}, {high}] }}" for key, (low, high) in search.items()}
    return toml(head(config, seeds, {"algorithm": '"cmaes"', "budget": BUDGET, "worlds": '"list"'})
                | {"set": keys, "search": ranges, "objective": {METRIC: '{ goal = "min", over = "q90" }'},
                   "constraint": {"rms_torque_Nm": f"{{ max = {most_torque} }}"}, "world": world})


def ranges(plant):
    """The ranges of the searched keys: delay and period bound the frequencies of controller and observer."""
    fastest, J = 1 / (plant["delay"] + PERIOD_S), plant["inertia"]
    slowest = 0.02 * fastest
    return {"controller.kp": (J * slowest ** 2, J * fastest ** 2), "controller.kd": (J * slowest, 2 * J * fastest),
            "observer.process_noise": ((J * PERIOD_S) ** 2 * slowest ** 6, (J * PERIOD_S) ** 2 * fastest ** 6)}


def own_tuning(folder, found, largest_input):
    """A tuning in the first draws. A torque beyond that of disturbance and friction is noise or a limit cycle."""
    plant = {name: found[key]["value"] for name, key in KEYS.items()}
    most_torque = 0.55 * largest_input + 1.1 * abs(plant["offset"]) + 1.1 * plant["coulomb"]
    return tuning("id/identified.toml", TASK, ranges(plant | {"delay": max(0, plant["delay"])}), most_torque,
                  drawn(folder / "draws.csv", SEARCH_DRAWS), SEARCH_SEEDS)


def without_bench(folder, config, plants, bits, jobs):
    """The keys of a controller that was tuned without a bench, on these plants."""
    own = {"nominal.inertia_kgm2": TYPICAL["inertia"], "nominal.viscous_friction_Nms_rad": TYPICAL["viscous"]}
    if not (folder / "tune.toml").exists():
        folder.mkdir(parents=True, exist_ok=True)
        count = 2 * math.pi / 2 ** bits
        keys = TASK | own | {"disturbance.amplitude_Nm": 0.3, "noise.std_rad": 0.9 * count}
        world = {key: [plant_keys(plant)[key] for plant in plants] for key in plant_keys(TYPICAL)}
        world["encoder.phase_rad"] = [count * ((n + 0.5) / len(plants) - 0.5) for n in range(len(plants))]
        # The keys and the world replace all that this file says of its motor.
        shutil.copy(config, folder / "identified.toml")
        (folder / "tune.toml").write_text(
            tuning("identified.toml", keys, ranges(TYPICAL), 0.4, world, SEARCH_DRAWS * SEARCH_SEEDS // len(plants)),
            encoding="utf-8")
    return tuned(folder / "tune.toml", folder / "tune", jobs) | own


def row_of(folder, number, jobs):
    plant = hidden_plant(number)
    here = folder / str(number)
    here.mkdir(parents=True, exist_ok=True)
    record = here / "bench.csv"
    rows = bench(plant, number)
    record.write_text("time_s,u,y\n" + "".join(f"{t},{u},{y:.9g}\n" for t, u, y in rows), encoding="utf-8")
    row = {"plant": number} | {f"true_{key}": f"{value:.6g}" for key, value in plant.items()}
    status = call("breakwater", "identify", record, "--out", here / "id", "--quiet")
    result = here / "id/identified.json"
    if not result.exists():  # the fit found no likelihood
        return row | {"converged": 0}
    found = json.loads(result.read_text(encoding="utf-8"))
    for name, key in KEYS.items():
        row |= {f"{name}_{end}": f"{found[key][end]:.6g}" for end in ("low", "high")}
    row |= {"converged": int(status == 0), "white": int(found["fit"]["white"])}
    config = here / "id/identified.toml"
    (here / "tune.toml").write_text(own_tuning(here / "id", found, max(abs(u) for _, u, _ in rows)), encoding="utf-8")
    keys = tuned(here / "tune.toml", here / "tune", jobs)
    low, high, failed = interval(here / "id/draws.csv", here / "sweep.toml", here / "predicted", TASK | keys, jobs)
    true = true_metric(here / "true", config, plant, number, keys)
    row |= {"predicted_low": low, "predicted_high": high, "predicted_failures": failed, "identified": true, "inside": int(low <= true <= high)}
    bits = plant["bits"]
    for name, plants in (("typical", [TYPICAL] * SEARCH_DRAWS),
                         ("series", [hidden_plant(f"of the series {n}") for n in range(SERIES)])):
        found = without_bench(folder / f"{name}-{bits}", config, plants, bits, jobs)
        row[name] = true_metric(here / f"true-{name}", config, plant, number, found)
    return row


def summary(all_rows):
    rows = [row for row in all_rows if "identified" in row]
    width = statistics.median((row["predicted_high"] - row["predicted_low"]) / row["identified"] for row in rows)
    lines = [f"no fit: {len(all_rows) - len(rows)} of {len(all_rows)}",
             f"inside the predicted 95 % interval: {sum(row['inside'] for row in rows)} of {len(rows)}",
             f"width of the interval over the metric, median: {width:.3g}"]
    for name in ("typical", "series"):
        ratios = [row[name] / row["identified"] for row in rows]
        lines.append(f"{name} over identified: median {statistics.median(ratios):.3g}, least {min(ratios):.3g}; "
                     f"worse in {sum(ratio > 1 for ratio in ratios)}, fails in {sum(map(math.isinf, ratios))}")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("studies/identified-loop"))
    parser.add_argument("--plants", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    rows = []
    for number in range(1, arguments.plants + 1):
        file = arguments.folder / str(number) / "row.json"
        if not file.exists():
            row = row_of(arguments.folder, number, arguments.jobs)
            file.write_text(json.dumps(row), encoding="utf-8")
            if "identified" in row:
                print(f"{number}: {row['identified']:.4g} in [{row['predicted_low']:.4g}, {row['predicted_high']:.4g}], "
                      f"typical {row['typical']:.4g}, series {row['series']:.4g}", flush=True)
        rows.append(json.loads(file.read_text(encoding="utf-8")))
    with open(HERE / "identified-loop.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, max(rows, key=len), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    print(summary(rows))


if __name__ == "__main__":
    main()
