#!/usr/bin/env python3
"""Changes the code at random places and counts how many of the changes the unit tests find.

    scripts/mutants.py DIR [--count 200] [--seed 1]     goes on where it was interrupted
    scripts/mutants.py DIR --survivors                  tries the survivors again, with the tests of HEAD

DIR gets a clone of HEAD, its build and results.jsonl. A mutant is one change in one line of linear/, observers/,
control/ or sim/. The kind of the change is drawn first, then its place. A mutant is killed if a test fails, crashes
or takes too long. A mutant is not counted if it does not compile or if all compiled code stays the same. The tests of
its own room run first, then the others that link it. The last line has the share of killed mutants; the survivors
stand above it.
"""
import argparse
import hashlib
import json
import os
import random
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# The room's own tests, and the tests of rooms above it.
TESTS = {
    "linear": ["linear_test"],
    "observers": ["observers_test", "published_estimators_test", "multiple_model_estimator_test",
                  "particle_filter_test"],
    "control": ["control_test", "wave_spectrum_test"],
    "sim": ["sim_test"]}
ABOVE = ["axis_estimators_test", "sea_forecasts_test", "plants_test", "world_test"]
MOST_MEMORY = 4 << 30

# A binary operator has spaces around it (clang-format), a template bracket has none.
SWAPS = {
    "relational": {" < ": [" <= ", " >= "], " <= ": [" < ", " > "], " > ": [" >= ", " <= "],
                   " >= ": [" > ", " < "], " == ": [" != "], " != ": [" == "]},
    "arithmetic": {" + ": [" - "], " - ": [" + "], " * ": [" / "], " / ": [" * "],
                   " += ": [" -= ", " = "], " -= ": [" += ", " = "], " *= ": [" /= "], " /= ": [" *= "],
                   "++": ["--"]},
    "logical": {" && ": [" || "], " || ": [" && "]}}
NUMBER = re.compile(r"(?<![\w.])(\d+\.\d*(?:e-?\d+)?|\d+e-?\d+|\d+)(?![\w.])")
SIGN = re.compile(r"(?<=[(,=?:] )-(?=[\w(])|(?<=\()-(?=[\w(])|(?<=return )-(?=[\w(])")
RETURNED = re.compile(r"(?<=return )([^;{}\"]+)(?=;)")
CONDITION = re.compile(r"(?<=\bif \()([^;\"]+)(?=\) )")
SIMPLE = r"[\w.\->\[\]]+(?:\([\w.]*\))?"
ARGUMENTS = re.compile(rf"(?<=\w\()({SIMPLE}), ({SIMPLE})(?=[,)])")
# A call or an assignment, but no declaration, which has a type before the name.
STATEMENT = re.compile(r"^\s+(?!return|throw|using|delete|break|continue)[\w.\->\[\]:*]+"
                       r"(?:\([^;]*\))?(?: [-+*/|&]?= [^;]*|\([^;]*\)(?:\.[^;]*)?| << [^;]*)?;$")
SKIPPED = re.compile(r"^\s*(#|template|extern|static_assert|using|namespace)|\bconsteval\b|\boperator\b")


def code_of(line, in_comment):
    """The line with strings and comments blanked out, and whether a comment goes on."""
    text, i = "", 0
    while i < len(line):
        if in_comment:
            end = line.find("*/", i)
            stop = len(line) if end < 0 else end + 2
            text, i, in_comment = text + "\0" * (stop - i), stop, end < 0
        elif line.startswith("//", i):
            return text + "\0" * (len(line) - i), False
        elif line.startswith("/*", i):
            in_comment = True
        elif line[i] in "\"'" and not (line[i] == "'" and i and line[i - 1].isdigit()):
            stop = i + 1
            while stop < len(line) and line[stop] != line[i]:
                stop += 1 + (line[stop] == "\\")
            stop = min(stop + 1, len(line))
            text, i = text + "\0" * (stop - i), stop
        else:
            text, i = text + line[i], i + 1
    return text, in_comment


def other_number(text):
    """Another number of the same type."""
    if "." not in text and "e" not in text:
        return [str(int(text) + 1)]
    return ["1.0"] if float(text) == 0.0 else [f"(2.0 * {text})", f"(0.5 * {text})"]


def changes(code):
    """(kind, from, to, replacement) of each possible change of a line."""
    for kind, table in SWAPS.items():
        for old, new in table.items():
            start = code.find(old)
            while start >= 0:
                for replacement in new:
                    yield kind, start, start + len(old), replacement
                start = code.find(old, start + 1)
    for found in NUMBER.finditer(code):
        for replacement in other_number(found[0]):
            yield "constant", *found.span(), replacement
    for found in SIGN.finditer(code):
        yield "sign", *found.span(), ""
    for found in RETURNED.finditer(code):
        yield "sign", *found.span(), f"-({found[0]})"
    for found in CONDITION.finditer(code):
        yield "condition", *found.span(), f"!({found[0]})"
    for found in ARGUMENTS.finditer(code):
        if found[1] != found[2]:
            yield "arguments", *found.span(), f"{found[2]}, {found[1]}"
    if STATEMENT.match(code):
        yield "statement", 0, len(code), ""


def all_mutants(tree):
    """{kind: [mutant]} in the order of the tree. A mutant is file, line, and the line before and after."""
    mutants = {}
    for room in TESTS:
        for path in sorted((tree / "src" / room).iterdir()):
            in_comment = False
            for number, line in enumerate(path.read_text().split("\n"), 1):
                code, in_comment = code_of(line, in_comment)
                if SKIPPED.search(code):
                    continue
                for kind, start, end, text in changes(code.rstrip("\0 ")):
                    if "\0" not in code[start:end]:
                        mutants.setdefault(kind, []).append(
                            {"room": room, "file": str(path.relative_to(tree)), "line": number,
                             "kind": kind, "before": line, "after": line[:start] + text + line[end:]})
    return mutants


class Bench:
    """The clone, its build, and the tests."""

    def __init__(self, folder, jobs):
        self.tree, self.build, self.jobs = folder / "tree", folder / "build", jobs
        self.environment = os.environ | {"CCACHE_DIR": str(folder / "ccache")}
        if not self.tree.exists():
            subprocess.run(["git", "clone", "--quiet", ROOT, self.tree], check=True)
        git = ["git", "-C", self.tree]
        subprocess.run([*git, "fetch", "--quiet", "origin", "HEAD"], check=True)
        subprocess.run([*git, "reset", "--quiet", "--hard", "FETCH_HEAD"], check=True)

    def prepare(self):
        """Build all tests, and note their times and the compiled code."""
        subprocess.run(["cmake", "-G", "Ninja", "-S", self.tree, "-B", self.build, "-Wno-dev",
                        "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -D_GLIBCXX_ASSERTIONS",
                        "-DBREAKWATER_PYTHON=OFF", "-DBREAKWATER_STUDIES=OFF"],
                       check=True, stdout=subprocess.DEVNULL, env=self.environment)
        tests = [*sum(TESTS.values(), []), *ABOVE]
        if not self.made(tests):
            sys.exit("the unchanged tree does not compile: see " + str(self.build))
        self.seconds = dict.fromkeys(tests, 714.0)  # an hour at most, until measured
        for test in tests:
            begin = time.monotonic()
            if self.first_failure([test]):
                sys.exit(f"{test} fails without a change")
            self.seconds[test] = time.monotonic() - begin
        self.objects = self.hashes(0.0)

    def made(self, targets):
        return subprocess.run(["cmake", "--build", self.build, "--parallel", str(self.jobs),
                               "--target", *targets], capture_output=True,
                              env=self.environment).returncode == 0

    def hashes(self, since):
        """The code of each object file that is newer than `since`."""
        return {path: hashlib.sha256(path.read_bytes()).hexdigest()
                for path in self.build.rglob("*.o") if path.stat().st_mtime >= since}

    def first_failure(self, tests):
        """A test that fails or takes too long, if there is one. Tests run side by side."""
        waiting, running = list(tests), {}
        try:
            while waiting or running:
                while waiting and len(running) < self.jobs:
                    test = waiting.pop(0)
                    running[test] = time.monotonic() + 30.0 + 5.0 * self.seconds[test], subprocess.Popen(
                        ["prlimit", f"--as={MOST_MEMORY}", self.build / "tests" / test, "--gtest_fail_fast",
                         "--gtest_brief=1"], cwd=self.build, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                for test, (end, process) in list(running.items()):
                    if process.poll() is None and time.monotonic() < end:
                        continue
                    if process.returncode != 0:  # None if it takes too long
                        return test
                    del running[test]
                time.sleep(0.02)
            return None
        finally:
            for _, process in running.values():
                process.kill()
                process.wait()

    def verdict(self, mutant):
        """killed (and by which test), survived, same code, or does not compile."""
        path = self.tree / mutant["file"]
        original = path.read_text()
        lines = original.split("\n")
        lines[mutant["line"] - 1] = mutant["after"]
        begin = time.time() - 1.0
        try:
            path.write_text("\n".join(lines))
            own = TESTS[mutant["room"]]
            others = [test for test in self.seconds if test not in own]
            for tests in (own, others):
                if not self.made(tests):
                    return {"verdict": "does not compile"}
                linked = [test for test in tests if (self.build / "tests" / test).stat().st_mtime >= begin]
                if killer := self.first_failure(linked):
                    return {"verdict": "killed", "by": killer}
            changed = self.hashes(begin)
            if all(self.objects.get(file) == value for file, value in changed.items()):
                return {"verdict": "same code"}
            return {"verdict": "survived"}
        finally:
            path.write_text(original)


def drawn(mutants, seed):
    """All mutants in a random order. Each kind has the same chance."""
    order = random.Random(seed)
    rest = {kind: order.sample(found, len(found)) for kind, found in mutants.items()}
    while rest:
        kind = order.choice(sorted(rest))
        yield rest[kind].pop()
        if not rest[kind]:
            del rest[kind]


def read(results):
    return [json.loads(line) for line in results.read_text().splitlines()] if results.exists() else []


def counted(done):
    return [entry for entry in done if entry["verdict"] in ("killed", "survived")]


def report(done):
    survivors = [entry for entry in counted(done) if entry["verdict"] == "survived"]
    for entry in survivors:
        print(f"{entry['file']}:{entry['line']} {entry['kind']}\n- {entry['before'].strip()}\n"
              f"+ {entry['after'].strip()}")
    total = len(counted(done))
    print(f"{total - len(survivors)} of {total} killed, "
          f"{sum(entry['verdict'] == 'does not compile' for entry in done)} did not compile, "
          f"{sum(entry['verdict'] == 'same code' for entry in done)} gave the same code")


def again(bench, done, results):
    """Try the survivors again. Their lines may have moved, but not changed."""
    for entry in done:
        if entry["verdict"] != "survived":
            continue
        lines = (bench.tree / entry["file"]).read_text().split("\n")
        places = [n for n, line in enumerate(lines, 1) if line == entry["before"]]
        if places:
            entry["line"] = min(places, key=lambda n: abs(n - entry["line"]))
            entry |= bench.verdict(entry)
        else:
            print(f"{entry['file']}:{entry['line']} has changed, so this survivor is not tried again")
    results.write_text("".join(json.dumps(entry) + "\n" for entry in done))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--survivors", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    if min(options.count, options.jobs) < 1:
        parser.error("--count and --jobs must be positive")
    if options.survivors and not (options.folder / "results.jsonl").exists():
        parser.error(f"--survivors: {options.folder} has no results.jsonl")
    options.folder.mkdir(parents=True, exist_ok=True)
    results = options.folder.resolve() / "results.jsonl"
    done = read(results)
    bench = Bench(options.folder.resolve(), options.jobs)
    bench.prepare()
    if options.survivors:
        again(bench, done, results)
    known = {(entry["file"], entry["line"], entry["after"]) for entry in done}
    for mutant in () if options.survivors else drawn(all_mutants(bench.tree), options.seed):
        if len(counted(done)) >= options.count:
            break
        if (mutant["file"], mutant["line"], mutant["after"]) in known:
            continue
        begin = time.monotonic()
        done.append(mutant | bench.verdict(mutant) | {"seconds": round(time.monotonic() - begin, 1)})
        with results.open("a") as file:
            file.write(json.dumps(done[-1]) + "\n")
        print(len(counted(done)), done[-1]["verdict"], done[-1]["file"], done[-1]["seconds"], flush=True)
    report(done)


if __name__ == "__main__":
    main()
