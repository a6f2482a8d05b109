#!/usr/bin/env python3
"""Checks that runs give the same bits as before, on processors with and without fused multiply-add (FMA).

    scripts/state_hashes.py check  [--bin build/bin]     the goldens: tests/regression/state_hashes.json
    scripts/state_hashes.py rebase [--bin build/bin]     writes new ones
    scripts/state_hashes.py compare [--bin build/bin] [--against OTHER] [--scenario NAME ...]
                                    [--whole] [--expect-same]

On a processor with FMA `check` runs everything twice. The second time glibc is configured as without FMA. The
hashes must be the same.

`compare` runs every case of every scenario with and without FMA, or with two builds. It prints the number of
cases with different state hashes and the changes of their metrics. OTHER is a folder of binaries, or a commit,
which is built in a temporary folder. To check that a change of structure changed no bit:

    scripts/state_hashes.py compare --against COMMIT --expect-same

The longest runs are shortened unless --whole is given.
"""
import argparse
import contextlib
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
        for processor in classes():
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


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["check", "rebase", "compare"])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/bin")
    parser.add_argument("--against", metavar="OTHER")
    parser.add_argument("--scenario", nargs="+")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--expect-same", action="store_true")
    options = parser.parse_args()
    {"check": check, "rebase": rebase, "compare": compare}[options.command](options)


if __name__ == "__main__":
    main()
