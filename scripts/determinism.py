#!/usr/bin/env python3
"""Compares the state hashes of every case of every scenario between different ways to run them.

    scripts/determinism.py [--bin build/bin] [--with NAME=PROGRAM ...] [--slurm] [--scenario NAME ...] [--only WAY ...]

The reference is each case in a process of its own, run by the program of its scenario. Other ways are sweeps in
threads and in child processes, and the same case twice in one process. Python and glibc without FMA follow.
`--with` adds a program that has the command `sweep`, such as that of another build or one outside of the tree:

    --with debug=build-debug/bin/breakwater --with "own program=/tmp/own/build/own_lab"

`--slurm` starts a Slurm on this machine and adds it (root only). The table has the number of cases with the hash of
the reference. `--only "own program" Python` tries these ways alone. Exit status 1: a case has another hash. 2: a way
could not be tried.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import state_hashes

ROOT = state_hashes.ROOT
# Short runs that reach the contact, and whose windows fit.
QUICK = {"arm_push": ["run.duration_s=3"],
         "arm_wall_contact": ["run.duration_s=14", "wall.solid_from_s=10", "force.from_s=12"],
         "impact_test": ["run.duration_s=0.1"],
         "plant": ["run.duration_s=2"],
         "quadrotor_waves": ["run.duration_s=4", "metrics.window_s=2"]}
OTHERWISE = ["run.duration_s=2"]
PYTHON = """
import sys, warnings
import breakwater as bw
warnings.simplefilter("ignore")
for case in bw.cases(sys.argv[1]):
    run = bw.run(sys.argv[1], case=case, set={k: float(v) for k, v in (s.split("=") for s in sys.argv[2:])})
    print(case, run.state_hash)
"""


def fail(why):
    """End with another status than that of a difference."""
    print(why, file=sys.stderr)
    sys.exit(2)


def checked(words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)
    if done.returncode:
        fail(f"{' '.join(map(str, words))}: {done.returncode}\n{done.stderr}")
    return done.stdout


def sets(scenario):
    return QUICK.get(scenario, OTHERWISE)


def alone(bin_dir, scenario):
    """(case, hash) of each case, in a process of its own."""
    return [(case, state_hashes.run(bin_dir / scenario, ["--case", case, "--set", *sets(scenario)],
                                    state_hashes.own_class())[0])
            for case in state_hashes.cases(bin_dir, scenario)]


def swept(program, scenario, *options, **environment):
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "study"
        checked([program, "sweep", scenario, "--case", "all", "--set", *sets(scenario), "--quiet",
                 "--out", out, *options], env=os.environ | environment)
        if not (out / "results.csv").exists():
            fail(f"--with: {program} has no command sweep")
        with open(out / "results.csv", newline="") as results:
            return [(row["case"], row["state_hash"]) for row in csv.DictReader(results)]


def in_python(bin_dir, scenario, **environment):
    said = checked(["/usr/bin/python3", "-c", PYTHON, scenario, *sets(scenario)],
                   env=os.environ | {"PYTHONPATH": str(bin_dir.parent / "python")} | environment)
    return [tuple(line.split()) for line in said.splitlines()]


def ways(options):
    """(name, function of a scenario) of each way."""
    program = options.bin / "breakwater"
    no_fma = {"GLIBC_TUNABLES": state_hashes.MASK}
    found = {
        # The level of compression changes only the log.
        "twice in one process": lambda s: swept(program, s, "--jobs", "1", "--vary",
                                                "record.compression=0,1"),
        "1 thread": lambda s: swept(program, s, "--jobs", "1"),
        "2 threads": lambda s: swept(program, s, "--jobs", "2"),
        "8 threads": lambda s: swept(program, s, "--jobs", "8"),
        "child processes": lambda s: swept(program, s, "--isolate"),
        "Python": lambda s: in_python(options.bin, s)}
    if state_hashes.own_class() == state_hashes.FMA:
        found["without FMA"] = lambda s: swept(program, s, **no_fma)
        found["Python without FMA"] = lambda s: in_python(options.bin, s, **no_fma)
    if options.slurm:
        found["Slurm"] = lambda s: swept(program, s, "--slurm", "--wait", "--tasks", "2")
    for entry in options.programs:
        name, _, path = entry.partition("=")
        found[name] = lambda s, path=path: swept(Path(path).resolve(), s)
    return found


def objection(options):
    """A wrong argument. None if there is none."""
    if not (options.bin / "breakwater").exists():
        return f"--bin: {options.bin} has no breakwater: build it first"
    for name in options.scenario or ():
        if name not in state_hashes.scenarios():
            return f"--scenario: there is no {name}: {', '.join(state_hashes.scenarios())}"
    for entry in options.programs:
        name, _, path = entry.partition("=")
        if not name or not path:
            return f"--with: {entry}: must be NAME=PROGRAM"
        if not os.access(path, os.X_OK):
            return f"--with: {path}: is no program"
    found = ways(options)
    for name in options.only or ():
        if name not in found:
            return f"--only: there is no way {name}: {', '.join(found)}"
    return None


def compare(options):
    """Print the table. Return the number of cases with another hash."""
    names = options.scenario or state_hashes.scenarios()
    reference = {name: dict(alone(options.bin, name)) for name in names}
    print("| way |", " | ".join(names), "|")
    print("|---" * (len(names) + 1) + "|")
    print("| cases |", " | ".join(str(len(reference[name])) for name in names), "|", flush=True)
    differ = []
    tried = ways(options)
    for way in options.only or tried:
        cells = []
        for name in names:
            found = tried[way](name)
            if {case for case, _ in found} != reference[name].keys():
                fail(f"{way}, {name}: the cases are others")
            wrong = {case for case, value in found if value != reference[name][case]}
            differ += [f"{way}: {name} {case}" for case in sorted(wrong)]
            cells.append(str(len(reference[name]) - len(wrong)))
        print(f"| {way} |", " | ".join(cells), "|", flush=True)
    print(*differ, sep="\n")
    return len(differ)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=ROOT / "build/bin")
    parser.add_argument("--with", dest="programs", metavar="NAME=PROGRAM", action="append", default=[])
    parser.add_argument("--slurm", action="store_true")
    parser.add_argument("--scenario", nargs="+")
    parser.add_argument("--only", nargs="+", metavar="WAY")
    options = parser.parse_args()
    options.bin = options.bin.resolve()
    if why := objection(options):
        parser.error(why)
    if not options.slurm:
        sys.exit(1 if compare(options) else 0)
    sys.path.insert(0, str(ROOT / "tests/study"))
    import slurm_cluster
    if why := slurm_cluster.missing():
        sys.exit(f"--slurm: {why}")
    slurm_cluster.enter()  # runs this script again, in namespaces of its own
    with slurm_cluster.Cluster():
        differ = compare(options)
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
