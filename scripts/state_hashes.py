#!/usr/bin/env python3
"""Checks that runs give the same bits as before, on processors with and without fused multiply-add (FMA).

    scripts/state_hashes.py check  [--bin build/bin] [--own]  the goldens: tests/regression/state_hashes.json
    scripts/state_hashes.py rebase [--bin build/bin]     writes new ones
    scripts/state_hashes.py compare [--bin build/bin] [--against OTHER] [--scenario NAME ...]
                                    [--whole] [--expect-same]

On a processor with FMA `check` runs everything twice. The second time glibc is configured as without FMA. The
hashes must be the same. With --own it does not.

`compare` runs every case of every scenario with and without FMA, or with two builds. It prints the number of
cases with different state hashes and the changes of their metrics. OTHER is a folder of binaries, or a commit,
which is built in a temporary folder. To check that a change of structure changed no bit:

    scripts/state_hashes.py compare --against COMMIT --expect-same

The longest runs are shortened unless --whole is given.

    scripts/state_hashes.py ways [--bin build/bin] [--with NAME=PROGRAM ...] [--slurm] [--scenario NAME ...]
                                 [--only WAY ...]

`ways` compares the hashes of every case between different ways to run it. The reference is each case in a process
of its own, run by the program of its scenario. Other ways are sweeps in threads and in child processes, and the same
case twice in one process. Python and glibc without FMA follow. `--with` adds a program that has the command `sweep`,
such as that of another build or one outside of the tree:

    --with debug=build-debug/bin/breakwater --with "own program=/tmp/own/build/own_lab"

`--slurm` starts a Slurm on this machine and adds it (root only). The table has the number of cases with the hash of
the reference. `--only "own program" Python` tries these ways alone. Exit status 1: a case has another hash. 2: a way
could not be tried.
"""
import argparse
import contextlib
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
GOLDENS = ROOT / "tests/regression/state_hashes.json"

FMA, NO_FMA = "fma", "no-fma"
# With this setting glibc selects the functions for a processor without FMA.
MASK = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"

# For `compare`: shorter runs that still reach all parts of the arithmetic.
SHORTENED = {"arm_wall_contact": ["--duration", "40"],
             "quadrotor_waves": ["--duration", "30", "--set", "metrics.window_s=20"]}


def own_class():
    """Whether the processor has FMA and AVX2, which glibc needs for fused functions."""
    with open("/proc/cpuinfo") as cpuinfo:
        flags = next((line.split() for line in cpuinfo if line.startswith("flags")), [])
    return FMA if "fma" in flags and "avx2" in flags else NO_FMA


def run(program, arguments, processor=None):
    """(state hash, metrics) of one run. A failed run (exit status 3) has no metrics."""
    environment = {k: v for k, v in os.environ.items() if k != "GLIBC_TUNABLES"}
    if processor == NO_FMA:
        environment["GLIBC_TUNABLES"] = MASK
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        done = subprocess.run([program, *arguments, "--quiet", "--out", out], env=environment,
                              capture_output=True, text=True)
        if done.returncode not in (0, 3):
            sys.exit(f"{program} {' '.join(arguments)}: {done.returncode}\n{done.stderr}")
        manifest = json.loads((out / "manifest.json").read_text())
        metrics = {} if done.returncode == 3 else json.loads((out / "metrics.json").read_text())
        return manifest["state_hash"], metrics


def hash_of(bin_dir, command, processor):
    scenario, *arguments = command.split()
    return run(bin_dir / scenario, arguments, processor)[0]


def classes():
    return [FMA, NO_FMA] if own_class() == FMA else [NO_FMA]


def check(options):
    wrong = 0
    for command, golden in json.loads(GOLDENS.read_text()).items():
        for processor in [own_class()] if options.own else classes():
            found = hash_of(options.bin, command, processor)
            if found != golden:
                wrong += 1
                print(f"{command}: {found} instead of {golden} ({processor})")
    if wrong:
        sys.exit(f"{wrong} state hashes are not the goldens. If they ought to differ: "
                 "scripts/state_hashes.py rebase")


def rebase(options):
    goldens = {command: hash_of(options.bin, command, own_class())
               for command in json.loads(GOLDENS.read_text())}
    GOLDENS.write_text(json.dumps(goldens, indent=2) + "\n")


def largest_change(a, b):
    """(relative change, name) of the metric with the largest change; infinite if only one run has it."""
    changes = [(0.0, "")]
    for name in a.keys() | b.keys():
        if name.endswith("_us"):
            continue  # measured times
        if name not in a or name not in b:
            changes.append((math.inf, name))
        elif a[name] != b[name]:
            changes.append((abs(a[name] - b[name]) / max(abs(a[name]), abs(b[name])), name))
    return max(changes)


@contextlib.contextmanager
def binaries_of(other):
    """The folder of binaries: `other` itself, or a build of the commit that it names."""
    if other is None or Path(other).is_dir():
        yield other and Path(other).resolve()
        return
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        git = ["git", "-C", ROOT, "worktree"]
        subprocess.run([*git, "add", "--quiet", "--detach", tree, other], check=True)
        try:
            print(f"building {other} ...", file=sys.stderr, flush=True)
            for command in (["cmake", "--preset", "release", "-DBUILD_TESTING=OFF", "-Wno-dev"],
                            ["cmake", "--build", "--preset", "release"]):
                subprocess.run(command, cwd=tree, check=True, stdout=subprocess.DEVNULL)
            yield tree / "build/bin"
        finally:
            subprocess.run([*git, "remove", "--force", tree], check=True)


def scenarios():
    return sorted(p.name for p in (ROOT / "scenarios").iterdir() if p.is_dir())


def cases(bin_dir, scenario):
    return subprocess.run([bin_dir / scenario, "--list-cases"], capture_output=True, text=True,
                          check=True).stdout.split()


def compare(options):
    with binaries_of(options.against) as against:
        differ = compare_with(against, options)
    if differ and options.expect_same:
        sys.exit(f"{differ} state hashes differ")


def compare_with(against, options):
    """Print the table, and return the number of cases with different hashes."""
    if not against and own_class() != FMA:
        sys.exit("this processor has no FMA: there is nothing to compare with")
    names = options.scenario or scenarios()
    print("| scenario | cases | hashes that differ | largest relative change of a metric |")
    print("|---|---|---|---|")
    differ = 0
    for name in names:
        listed = cases(options.bin, name)
        different, worst = [], (0.0, "", "")
        for case in listed:
            arguments = ["--case", case, *([] if options.whole else SHORTENED.get(name, []))]
            one = run(options.bin / name, arguments, own_class())
            other = run((against or options.bin) / name, arguments,
                        own_class() if against else NO_FMA)
            if one[0] != other[0]:
                different.append(case)
            worst = max(worst, (*largest_change(one[1], other[1]), case))
        differ += len(different)
        change = f"{worst[0]:.1e} ({worst[1]}, {worst[2]})" if worst[0] else "none"
        print(f"| {name} | {len(listed)} | {', '.join(different) or 'none'} | {change} |", flush=True)
    return differ


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
    return [(case, run(bin_dir / scenario, ["--case", case, "--set", *sets(scenario)],
                                    own_class())[0])
            for case in cases(bin_dir, scenario)]


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
    no_fma = {"GLIBC_TUNABLES": MASK}
    found = {
        # The level of compression changes only the log.
        "twice in one process": lambda s: swept(program, s, "--jobs", "1", "--vary",
                                                "record.compression=0,1"),
        "1 thread": lambda s: swept(program, s, "--jobs", "1"),
        "2 threads": lambda s: swept(program, s, "--jobs", "2"),
        "8 threads": lambda s: swept(program, s, "--jobs", "8"),
        "child processes": lambda s: swept(program, s, "--isolate"),
        "Python": lambda s: in_python(options.bin, s)}
    if own_class() == FMA:
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
        if name not in scenarios():
            return f"--scenario: there is no {name}: {', '.join(scenarios())}"
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


def compare_ways(options):
    """Print the table. Return the number of cases with another hash."""
    names = options.scenario or scenarios()
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


def try_ways(options):
    if why := objection(options):
        fail(why)
    if not options.slurm:
        sys.exit(1 if compare_ways(options) else 0)
    sys.path.insert(0, str(ROOT / "tests/study"))
    import slurm_cluster
    if why := slurm_cluster.missing():
        sys.exit(f"--slurm: {why}")
    slurm_cluster.enter()  # runs this script again, in namespaces of its own
    with slurm_cluster.Cluster():
        differ = compare_ways(options)
    sys.exit(1 if differ else 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["check", "rebase", "compare", "ways"])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/bin")
    parser.add_argument("--own", action="store_true")
    parser.add_argument("--against", metavar="OTHER")
    parser.add_argument("--scenario", nargs="+")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--expect-same", action="store_true")
    parser.add_argument("--with", dest="programs", metavar="NAME=PROGRAM", action="append", default=[])
    parser.add_argument("--slurm", action="store_true")
    parser.add_argument("--only", nargs="+", metavar="WAY")
    options = parser.parse_args()
    options.bin = options.bin.resolve()
    {"check": check, "rebase": rebase, "compare": compare, "ways": try_ways}[options.command](options)


if __name__ == "__main__":
    main()
