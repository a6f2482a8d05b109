"""Broken scenario files and models are refused in one line, at once, or are legal for a stated reason (texts.txt).

A mutant is a key of a scenario's file, an attribute of a model or a whole file, with one error.
Usage: mutated_input_test.py BIN_FOLDER [--all]: all of them instead of a sample
"""

import concurrent.futures
import os
import pathlib
import random
import re
import subprocess
import sys
import unittest

ALL = "--all" in sys.argv
if ALL:
    sys.argv.remove("--all")

from called_program import BIN, Folder

ROOT = pathlib.Path(__file__).resolve().parents[2]
IS_SLOW = "CMAKE_BUILD_TYPE:STRING=Debug" in (BIN.parent / "CMakeCache.txt").read_text()
AT_ONCE_s = 7.5 if IS_SLOW else 1.5
SAMPLE = 60
MODELS = {"arm.xml": "arm_wall_contact", "arm.urdf": "arm_push", "cart.xml": "cart_estimation", "motor.xml": "motor_estimation",
          "quadrotor.xml": "quadrotor_waves"}
LEGAL = [row.split(" | ") for row in
         re.search(r"\[LegalMutants\]\n((?:.+\n)*)", (ROOT / "tests/texts.txt").read_text())[1].splitlines()]


class Mutant:
    def __init__(self, scenario, option, file, place, change, text):
        self.scenario, self.option, self.file, self.place, self.change, self.text = scenario, option, file, place, change, text
        self.name = f"{scenario} {option} {place}: {change}"
        # The number of the reason why it is legal.
        self.reason = next((i for i, row in enumerate(LEGAL) if all(map(re.fullmatch, row, (option, place, change)))), None)

    def words(self, path):
        return ["breakwater", "run", self.scenario,
                *(["--config", path] if self.option == "--config" else ["--set", f"{self.option}={path}"])]


def broken_files(text, root, wrong):
    """Damages to a file as a whole."""
    yield "empty", b""
    for percent in (10, 25, 40, 50, 55):
        yield "truncated", text[:len(text) * percent // 100]
    yield "wrong root", text.replace(root, wrong, 1)
    for part in (3, 2):
        at = len(text) // part
        yield "broken UTF-8", text[:at] + b"\xff" + text[at:]
        yield "a NUL", text[:at] + b"\0" + text[at:]


def mutants_of_scenario(scenario):
    text = (ROOT / f"scenarios/{scenario}/{scenario}.toml").read_bytes()
    about = scenario, "--config", "mutant.toml"
    for change, broken in broken_files(text, b'"%s"' % scenario.encode(), b'"nonsense"'):
        yield Mutant(*about, "", change, broken)
    for line in re.finditer(rb"^([A-Za-z0-9_.]+)\s*=\s*(.+)$", text, re.M):
        key = line[1]
        for change, broken in (("misspelt", key + b"x = " + line[2]), ("string", key + b' = "far"'), ("NaN", key + b" = nan"),
                               ("infinity", key + b" = inf"), ("table", key + b" = { a = 1 }"),
                               ("duplicate", line[0] + b"\n" + line[0]), ("no value", key + b" =")):
            yield Mutant(*about, key.decode(), change, text[:line.start()] + broken + text[line.end():])


def wrong_values(value):
    """Wrong values for an attribute, in place of its first number if it has one."""
    first, _, rest = value.partition(" ")
    try:
        is_number, is_zero = True, float(first) == 0
    except ValueError:
        is_number, is_zero = False, True
    behind = value[len(first):] if is_number else ""
    yield "word", "banana" + behind
    yield "NaN", "nan" + behind
    yield "1e300", "1e300" + behind
    yield "negative", ("-1" if is_zero else first if first.startswith("-") else "-" + first) + behind


def mutants_of_model(file, scenario):
    text = (ROOT / "models" / file).read_bytes()
    is_urdf = file.endswith(".urdf")
    about = scenario, "model.urdf" if is_urdf else "model.mjcf", "mutant.urdf" if is_urdf else "mutant.xml"
    for change, broken in broken_files(text, b"<robot" if is_urdf else b"<mujoco", b"<nonsense"):
        yield Mutant(*about, "", change, broken)
    code = re.sub(rb"<!--.*?-->|<\?.*?\?>", lambda comment: b" " * len(comment[0]), text, flags=re.S)
    for match in re.finditer(rb'\s([a-z0-9]+)="([^"]*)"', code):
        element = re.split(rb"[ \n/>]", code[:match.start(2)].rpartition(b"<")[2], maxsplit=1)[0].decode()
        for change, value in wrong_values(match[2].decode()):
            if value.encode() != match[2]:  # already negative
                yield Mutant(*about, f"<{element}> {match[1].decode()}", change,
                             text[:match.start(2)] + value.encode() + text[match.end(2):])


def all_mutants():
    scenarios = sorted(path.name for path in (ROOT / "scenarios").iterdir() if path.is_dir())
    return [*(mutant for scenario in scenarios for mutant in mutants_of_scenario(scenario)),
            *(mutant for model, scenario in MODELS.items() for mutant in mutants_of_model(model, scenario))]


class MutatedInput(Folder):
    def told(self, number, mutant):
        """Exit status, stdout, lines of stderr, processor time [s] and files of a program that checks the mutant."""
        here = self.folder / str(number)
        (here / "cwd").mkdir(parents=True)
        path = here / mutant.file
        path.write_bytes(mutant.text)
        with open(here / "out", "w+b") as out, open(here / "err", "w+b") as err:
            process = subprocess.Popen([BIN / "breakwater", *mutant.words(path)[1:], "--print-config"], stdout=out, stderr=err,
                                       cwd=here / "cwd")
            _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        return (process.returncode, (here / "out").read_bytes(), (here / "err").read_text(errors="replace").splitlines(),
                usage.ru_utime + usage.ru_stime, list((here / "cwd").iterdir()))

    def test_is_refused_in_one_line_or_legal_for_a_reason(self):
        mutants = all_mutants()
        self.assertGreater(len(mutants), 846)
        random.Random(1).shuffle(mutants)
        if not ALL:
            mutants = mutants[:SAMPLE]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            outcomes = pool.map(self.told, range(len(mutants)), mutants)
        accepted = set()
        for mutant, (status, out, lines, seconds, left) in zip(mutants, outcomes):
            with self.subTest(mutant.name):
                self.assertEqual(left, [])
                self.assertLess(seconds, AT_ONCE_s)
                if status == 0:
                    self.assertIsNotNone(mutant.reason, "is accepted without a reason")
                    self.assertEqual((lines, out != b""), ([], True))
                    accepted.add(mutant.reason)
                    continue
                self.assertEqual((status, len(lines), out), (2, 1, b""), lines)
                # A joint that is only in the URDF is missing in the MJCF.
                self.assertRegex(lines[0], mutant.file + ("|models/arm.xml" if mutant.place == "<joint> name" else ""))
        if ALL:
            self.assertEqual([LEGAL[i] for i in range(len(LEGAL)) if i not in accepted], [], "nothing needs these reasons")

    def test_legal_input_runs_or_fails_as_a_run(self):
        done = set()
        for number, mutant in enumerate(all_mutants()):
            if mutant.reason is None or mutant.reason in done or self.told(number, mutant)[0] != 0:
                continue
            done.add(mutant.reason)
            words = [*mutant.words(self.folder / str(number) / mutant.file), "--quiet", "--out", "run", "--duration", "0.2",
                     *(["--set", "metrics.window_s=0.1"] if mutant.scenario == "quadrotor_waves" else [])]
            run = subprocess.run([BIN / words[0], *words[1:]], cwd=self.folder, capture_output=True, text=True)
            with self.subTest(mutant.name):
                self.assertIn(run.returncode, (0, 3), run.stderr)
        self.assertEqual(len(done), len(LEGAL))


if __name__ == "__main__":
    unittest.main()
