#!/usr/bin/env python3
"""Checks that every case of arm_wall_contact hits the wall as before.

    scripts/impact_goldens.py check   [--bin build/bin]    within 0.1 % of the goldens
    scripts/impact_goldens.py rebase  [--bin build/bin]    writes new ones, shows old and new
    scripts/impact_goldens.py mutants [--bin build/bin]    checks that `check` detects a change of the physics

tests/regression/impact_goldens.json has the free-motion time and the two peak forces of each case. State hashes
(state_hashes.py) detect smaller changes, and show that all processors agree. The classes of data/reproduced.toml are
wide, as the thesis leaves points open.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

from state_hashes import ROOT, cases, run

GOLDENS = ROOT / "tests/regression/impact_goldens.json"
SCENARIO = "arm_wall_contact"
METRICS = ("free_motion_time_s", "peak_force_raw_N", "peak_force_filtered_N")
TOLERANCE = 1e-3  # relative; other elementary functions in MuJoCo change 8e-12
IMPACT_ONLY = ("--duration", "37")  # force is controlled from 30 s on; the slowest case needs 5 s

# Each mutant multiplies a key of the shipped configuration by a factor. A time step four times larger is
# refused: it does not divide the control period.
MUTANTS = {"contact.stiffness_N_m": 1.02, "contact.damping_Ns_m": 1.02,
           "force.filter_time_constant_s": 1.02, "physics.timestep_s": 5.0}


def impact(bin_dir, case, sets=()):
    """The three metrics. Metrics are absent if the run failed or touched nothing."""
    arguments = ["--case", case, *IMPACT_ONLY, *(["--set", *sets] if sets else [])]
    metrics = run(bin_dir / SCENARIO, arguments)[1]
    return {name: metrics[name] for name in METRICS if name in metrics}


def impacts(bin_dir):
    """{case: the three metrics}, on all cores."""
    names = cases(bin_dir, SCENARIO)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip(names, pool.map(lambda case: impact(bin_dir, case), names)))


def change(golden, found):
    return found / golden - 1.0


def differences(golden, found):
    """The differences of the metrics in words."""
    texts = []
    for name in METRICS:
        if name not in golden or name not in found:
            if (name in golden) != (name in found):
                texts.append(f"{name}: {found.get(name, 'none')} instead of "
                             f"{golden.get(name, 'none')}")
        elif not abs(change(golden[name], found[name])) <= TOLERANCE:  # NaN is a change too
            texts.append(f"{name}: {found[name]:.6g} instead of {golden[name]:.6g} "
                         f"({change(golden[name], found[name]):+.2%})")
    return texts


def has_finite_change(golden, found):
    """Whether a finite metric changed: a lost metric or NaN may only show that the run failed."""
    both = golden.keys() & found.keys()
    return any(TOLERANCE < abs(change(golden[name], found[name])) < math.inf for name in both)


def check(options):
    goldens = json.loads(GOLDENS.read_text())
    found = impacts(options.bin)
    wrong = [f"{case}: {text}" for case, metrics in found.items()
             for text in differences(goldens.get(case, {}), metrics)]
    wrong += [f"{case}: there is no such case" for case in goldens.keys() - found.keys()]
    if wrong:
        sys.exit("\n".join(wrong) + "\nThe arm does not strike as before. If it ought to differ: "
                 "scripts/impact_goldens.py rebase")


def rebase(options):
    old = json.loads(GOLDENS.read_text()) if GOLDENS.exists() else {}
    new = impacts(options.bin)
    print("| case | metric | old | new | change |\n|---|---|---|---|---|")
    for case, name in product({**old, **new}, METRICS):
        before, after = (goldens.get(case, {}).get(name) for goldens in (old, new))
        values = ["none" if value is None else f"{value:.6g}" for value in (before, after)]
        changed = f"{change(before, after):+.3%}" if before and after else ""
        print(f"| {case} | {name} | {' | '.join(values)} | {changed} |")
    GOLDENS.write_text(json.dumps(new, indent=2) + "\n")


def mutants(options):
    goldens = json.loads(GOLDENS.read_text())
    shipped = tomllib.loads(subprocess.run([options.bin / SCENARIO, "--print-config"],
                                           capture_output=True, text=True, check=True).stdout)
    unseen = []
    for key, factor in MUTANTS.items():
        table, name = key.split(".")
        value = shipped[table][name] * factor
        for case, golden in goldens.items():
            found = impact(options.bin, case, [f"{key}={value!r}"])
            if has_finite_change(golden, found):
                print(f"{key} * {factor:g}: seen by {case}: {'; '.join(differences(golden, found))}",
                      flush=True)
                break
        else:
            unseen.append(f"{key} * {factor:g}")
    if unseen:
        sys.exit(f"no case sees {', '.join(unseen)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["check", "rebase", "mutants"])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/bin")
    options = parser.parse_args()
    {"check": check, "rebase": rebase, "mutants": mutants}[options.command](options)


if __name__ == "__main__":
    main()
