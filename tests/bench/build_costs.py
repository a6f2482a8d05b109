#!/usr/bin/env python3
"""The cost of the compilation of each unit: `./dev bench --build [TARGET...]`.

It builds anew in build-costs, without a cache, and prints the units by processor time, with their
memory and GCC's shares (-ftime-report). As `--run LOG COMPILER ARGUMENT...` it is the launcher of the
compiler, and adds a line to LOG.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
from collections import defaultdict

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build-costs"
LOG = BUILD / "costs.jsonl"
SHOWN = 30
PHASES = {"parsing": "phase parsing", "templates": "template instantiation",
          "code": "phase opt and generate"}


def compile_one(log, command):
    """Compile as told, and note what it cost. -ftime-report leaves the object as it is."""
    process = subprocess.Popen([*command, "-ftime-report"], stderr=subprocess.PIPE, text=True)
    text = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    messages, _, report = text.partition("\nTime variable")
    sys.stderr.write(messages if report else text)
    seconds = {name: re.search(rf"^ {phase} *: *([\d.]+)", report, re.M)
               for name, phase in PHASES.items()}
    row = {"unit": command[command.index("-o") + 1], "s": usage.ru_utime + usage.ru_stime,
           "MB": usage.ru_maxrss / 1024,
           **{name: float(found[1]) if found else 0.0 for name, found in seconds.items()}}
    with open(log, "a") as file:
        file.write(json.dumps(row) + "\n")
    return os.waitstatus_to_exitcode(status)


def short(unit):
    return re.sub(r"CMakeFiles/|\.dir|Unity/|(_cxx)?\.(cxx|cpp)\.o$", "", unit)


def main(targets):
    shutil.rmtree(BUILD, ignore_errors=True)
    launcher = f"/usr/bin/python3;{pathlib.Path(__file__).resolve()};--run;{LOG}"
    subprocess.run(["cmake", "--preset", "release", "-B", BUILD, "-Wno-dev",
                    f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}", "-DBREAKWATER_STUDIES=OFF"],
                   cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", BUILD, *(["--target", *targets] if targets else [])], check=True)
    rows = [json.loads(line) for line in LOG.read_text().splitlines()]
    rows.sort(key=lambda row: -row["s"])
    print(f"\n{'unit':60} {'s':>6} {'MB':>6} " + " ".join(f"{name:>9}" for name in PHASES))
    for row in rows[:SHOWN]:
        print(f"{short(row['unit'])[-60:]:60} {row['s']:6.1f} {row['MB']:6.0f} "
              + " ".join(f"{row[name]:9.1f}" for name in PHASES))
    by_target = defaultdict(list)
    for row in rows:
        by_target[short(row["unit"]).rpartition("/")[0]].append(row["s"])
    print(f"\n{'target':60} {'s':>6} {'units':>6}")
    for target, seconds in sorted(by_target.items(), key=lambda pair: -sum(pair[1]))[:SHOWN]:
        print(f"{target[-60:]:60} {sum(seconds):6.1f} {len(seconds):6}")
    print(f"{'all':60} {sum(row['s'] for row in rows):6.1f} {len(rows):6}")


if sys.argv[1:2] == ["--run"]:
    sys.exit(compile_one(sys.argv[2], sys.argv[3:]))
main(sys.argv[1:])
