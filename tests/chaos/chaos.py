"""Disturbs the real programs and checks what they leave: kills, signals, full disks, failing calls, power cuts.

Usage: chaos.py BUILD_FOLDER [--seeds FROM..TO] [--each] [--jobs N] [--workload NAME] [--faults LIST] [--planted DEFECT]

A seed chooses a workload (workloads.py) and one to three faults (faults.cpp) among the calls of a run without
faults. After the disturbed run, with its status and its message:
  - each result is as before the command, or as after an undisturbed one; success means the latter;
  - the same command again, undisturbed, succeeds and leaves the files of the undisturbed one, byte for byte.
A seed that fails is tried with fewer faults. Exit status: 0 nothing was found, 1 something was found.

With --each there is one try for each fault of each call that changes or syncs names. The faults come alone, and
where names cannot be exchanged, as on NFS. One more try for each write has a full disk from there on.
"""

import argparse
import concurrent.futures
import ctypes
import dataclasses
import errno
import json
import os
import pathlib
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import power_cut  # noqa: E402
from workloads import WORKLOADS  # noqa: E402

# Classes, the most faults and the page are those of faults.cpp.
CLASSES = ("write", "open", "rename", "sync", "mmap", "fork", "thread", "clock", "read", "remove", "mkdir",
           "close", "memory")
MOST_FAULTS = 8
PAGE = struct.Struct(f"<{len(CLASSES) + MOST_FAULTS + 5 * MOST_FAULTS + 2}q")
ERRORS = {
    "write": ["ENOSPC", "EIO", "EINTR", "short"], "open": ["EACCES", "EMFILE", "EIO"],
    "rename": ["EIO", "EACCES", "EINVAL"], "sync": ["EIO", "ENOSPC"], "mmap": ["ENOMEM"], "fork": ["EAGAIN", "ENOMEM"],
    "thread": ["EAGAIN"], "clock": ["step86400", "step-86400", "step7"], "read": [], "remove": ["EIO", "EACCES"],
    "mkdir": ["ENOSPC", "EACCES"], "close": [], "memory": ["ENOMEM"],
}
PROGRAMS = ("breakwater", "cart_position", "impact_test")  # these have HDF5 in them
ENDS = ["kill", "term", "int", "cut"]
SIGNALS = {"kill": signal.SIGKILL, "cut": signal.SIGKILL, "term": signal.SIGTERM, "int": signal.SIGINT}
DEFECTS = ("no_fsync", "unchecked_write")
INTERRUPTED = 130
STATUSES = {0, 2, 4}  # documented, and possible here
LIMIT_S = 60.0
# Files whose bytes differ between equal results: names of processes, and processor times.
OF_MACHINE = re.compile(rb"<!-- this machine.*?<!-- end of this machine -->", re.DOTALL)
OF_PROCESSES = re.compile(r"(^|/)(shards|slurm)(/|$)|(^|/)script\.py$")
TEMPORARY = re.compile(r"(^|/)\.[^/]*\.(partial|earlier)-[^/]*$")
KEPT = re.compile(r"\.kept(-\d+)?(/|$)")
STREAM_FILES = {"kept"}
RUN_FILES = {"config.toml", "metrics.json", "manifest.json", "log.h5", "log.csv"}
# Made from what is done so far, so an interrupted study has other ones.
OF_PARTS = {"results.csv", "results.sqlite", "comparison.csv", "comparison_by_key.csv", "front.csv", "tuned.csv",
            "report.html", "candidates"}


class Found(Exception):
    """A defect, in one line."""


def action_of(what):
    """The action of faults.cpp and its value."""
    if what.startswith("step"):
        return 4, int(what.removeprefix("step"))
    if what in SIGNALS:  # Ctrl-C and a power cut reach all processes of a command
        return 3 if what in ("int", "cut") else 2, SIGNALS[what]
    return (1, 0) if what == "short" else (0, getattr(errno, what))


def page_of(faults, defect):
    """Counters of the calls and of the fired faults, then the faults and the planted defect."""
    numbers = [0] * (PAGE.size // 8)
    for i, fault in enumerate(fault for fault in faults if not fault.startswith("end:")):
        kind, number, what = fault.split(":")
        begin = len(CLASSES) + MOST_FAULTS + 5 * i
        numbers[begin:begin + 5] = CLASSES.index(kind), int(number.rstrip("+")), number.endswith("+"), *action_of(what)
    numbers[-2:] = [defect == name for name in DEFECTS]
    return PAGE.pack(*numbers)


def normal(name, content):
    """The bytes of a file without what a clock said."""
    if name.endswith("manifest.json"):
        try:
            manifest = json.loads(content)
        except ValueError:
            return content
        for key in ("wall_time_s", "costs"):
            manifest.pop(key, None)
        return json.dumps(manifest).encode()
    return OF_MACHINE.sub(b"", content)


def snapshot(folder):
    """Content of each file; None for a folder."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if not OF_PROCESSES.search(name):
            found[name] = None if path.is_dir() else normal(name, path.read_bytes())
    return found


def unit(name, *states):
    """A run is one result, of several files; any other file is a result of its own."""
    folder, _, file = name.rpartition("/")
    if any(f"{folder}/identified.json" in state for state in states):
        return folder
    is_run = any(f"{folder}/manifest.json" in state for state in states)
    return folder if is_run and file in RUN_FILES else name


def units(found, *states):
    """{result: {file: content}}, without folders."""
    grouped = {}
    for name, content in found.items():
        if content is not None:
            grouped.setdefault(unit(name, found, *states), {})[name] = content
    return grouped


def is_part(name, content, whole):
    """Whether a file is a whole one of a study that is not finished."""
    if content is None or name.rpartition("/")[2] not in OF_PARTS:
        return False
    if name.endswith("/results.csv"):
        return content.endswith(b"\n") and set(content.splitlines()) <= set(whole.get(name, b"").splitlines())
    if name.endswith(".sqlite"):
        return content.startswith(b"SQLite format 3\0") and len(content) % 4096 == 0
    return content.endswith(b"</html>\n" if name.endswith(".html") else b"\n")


@dataclasses.dataclass
class Undisturbed:
    """A workload's results without faults, and the number of calls of each class."""

    before: dict
    after: dict
    stderr: str
    counts: dict


@dataclasses.dataclass
class Ended:
    status: int
    stderr: str
    fired: list
    counts: dict


class Place:
    """A folder in which one seed at a time works."""

    def __init__(self, build, base, spared):
        self.build, self.spared = build, spared
        self.base, self.reapers = base, []
        base.mkdir()
        self.work, self.synced = self.base / "work", self.base / "synced"
        self.page = self.base / "page"
        self.others_page = self.base / "others-page"

    def prepare(self, fixture):
        for folder in (self.work, self.synced):
            shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(fixture, self.work)
        self.synced.mkdir()
        self.page.write_bytes(bytes(PAGE.size))

    def start(self, words, faults=None, defect="", stderr="stderr", page=None):
        """Starts a program, with the layer if there is a list of faults."""
        program = words[0]
        paths = {"python3": "/usr/bin/python3", "ishigami_lab": self.build / "tests" / "ishigami_lab"}
        environment = {**os.environ, "PYTHONPATH": str(self.build / "python"), "PYTHONDONTWRITEBYTECODE": "1",
                       "PYTHONWARNINGS": "ignore",
                       "PATH": f"{self.work}/slurm:/usr/bin:/bin"}
        if faults is not None:
            page = page or self.page
            page.write_bytes(page_of(faults, defect))
            environment.update(self.spared, LD_PRELOAD=str(self.build / "tests" / "libchaos_faults.so"), CHAOS_PAGE=str(page),
                               CHAOS_PROGRAMS=str(self.build), CHAOS_SYNCED=str(self.synced))
        with open(self.base / stderr, "w") as errors, open(self.base / "stdout", "a") as out:
            return subprocess.Popen([paths.get(program, self.build / "bin" / program), *words[1:]], cwd=self.work,
                                    env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=errors,
                                    start_new_session=True)

    def end_of(self, process, stderr="stderr"):
        try:
            process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            raise Found(f"it does not end within {LIMIT_S:g} s") from None
        self.reapers.append(Reaper(process.pid))
        numbers = PAGE.unpack(self.page.read_bytes())
        return Ended(process.returncode, (self.base / stderr).read_text(errors="replace"),
                     numbers[len(CLASSES):], dict(zip(CLASSES, numbers)))

    def wait_for_all(self):
        """Waits for processes that survived their command."""
        while self.reapers:
            self.reapers.pop().wait()

    def call(self, words, stderr="stderr", **how):
        return self.end_of(self.start(words, stderr=stderr, **how), stderr)


def each_step(counts):
    """Lists of faults: each fault of each call that changes or syncs names, alone and behind a refused exchange.
    Further lists fill the disk from each write on."""
    calls = [(kind, number) for kind in ("rename", "sync", "mkdir", "remove") for number in range(1, counts[kind] + 3)]
    alone = [[f"{kind}:{number}{also}:{what}"] for kind, number in calls for also in ("", "+")
             for what in (*ERRORS[kind], *([] if also else ["kill", "cut"]))]
    full = [[f"write:{number}+:ENOSPC"] for number in range(1, counts["write"] + 1)]
    return alone + full + [[f"rename:{exchange}:EINVAL", f"{kind}:{number}:{what}"] for kind, number in calls
                           for exchange in range(1, counts["rename"] + 1) for what in ("kill", "cut")]


def adopt_orphans():
    """As init does: otherwise a process that survived its parent would stay a zombie, and not count as ended."""
    PR_SET_CHILD_SUBREAPER = 36  # <linux/prctl.h>
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


class Reaper(threading.Thread):
    """Waits for all processes of a group."""

    def __init__(self, group):
        super().__init__(daemon=True)
        self.group = group
        self.start()

    def run(self):
        try:
            while True:
                os.waitpid(-self.group, 0)
        except ChildProcessError:
            pass

    def wait(self):
        self.join(LIMIT_S)
        if self.is_alive():
            os.killpg(self.group, signal.SIGKILL)
            raise Found("its processes go on after its end")


def code_of_hdf5(program):
    """The library of Debian 12 corrupts its memory when an allocation fails, so it is spared."""
    symbols = subprocess.run(["nm", program], capture_output=True, text=True, check=True).stdout.splitlines()
    addresses = sorted(int(line[:16], 16) for line in symbols if re.search(r" [tT] _?H5", line))
    parts = []
    for address in addresses:
        if not parts or address > parts[-1][1] + 0x10000:
            parts.append([address, address])
        parts[-1][1] = address
    return ",".join(f"{begin:x}-{end:x}" for begin, end in parts)


class Chaos:
    """Disturbs some of the workloads, one seed at a time. All work is in one folder: files may name it."""

    def __init__(self, build, base, defect):
        self.base, self.defect = base, defect
        spared = {f"CHAOS_SPARED_{name}": code_of_hdf5(build / "bin" / name) for name in PROGRAMS}
        self.place = Place(build, base / "place", spared)
        self.known = {}

    def fixture(self, workload):
        return self.base / f"fixture-{workload.name}"

    def undisturbed(self, workload):
        if workload.name not in self.known:
            self.known[workload.name] = self.run_undisturbed(workload)
        return self.known[workload.name]

    def run_undisturbed(self, workload):
        place, fixture = self.place, self.fixture(workload)
        empty = self.base / "empty"
        empty.mkdir(exist_ok=True)
        place.prepare(empty)
        for name, text in workload.files.items():
            file = place.work / name
            file.parent.mkdir(exist_ok=True)
            file.write_text(text)
            file.chmod(0o755)
        for words in workload.earlier:
            ended = place.call(words)
            if ended.status != 0:
                raise SystemExit(f"{workload.name}: {' '.join(words)} ends with status {ended.status}: {ended.stderr}")
        shutil.copytree(place.work, fixture)
        before = snapshot(place.work)
        ended = place.call(workload.words, faults=[], defect=self.defect)
        if ended.status != 0:
            raise SystemExit(f"{workload.name}: ends with status {ended.status} without faults: {ended.stderr}")
        return Undisturbed(before, snapshot(place.work), ended.stderr, ended.counts)

    # ---- One seed ---------------------------------------------------------------------------------

    def draw(self, chance, counts, has_queue):
        """One to three faults, at calls of the undisturbed run."""
        faults = []
        for _ in range(chance.choices((1, 2, 3), (60, 25, 15))[0]):
            kinds = [kind for kind in CLASSES if counts[kind]]
            if not faults:
                kinds.append("end")
            kind = chance.choice(kinds)
            if kind == "end":
                return ["end:1:cut"]
            errors = ERRORS[kind]
            fault = chance.choice(errors if errors and chance.random() < 0.5 else ENDS)
            goes_on = "+" if fault in ("ENOSPC", "EIO", "EMFILE", "EINVAL", "EAGAIN") and chance.random() < 0.3 else ""
            if kind == "fork" and has_queue:
                goes_on = ""  # as long as squeue cannot be called, the driver waits
            faults.append(f"{kind}:{chance.randint(1, counts[kind])}{goes_on}:{fault}")
        return faults

    def try_faults(self, number, workload, faults):
        """Raises Found."""
        chance = random.Random(number)
        place, known = self.place, self.undisturbed(workload)
        place.prepare(self.fixture(workload))
        earlier = power_cut.look(place.work)
        process = place.start(workload.words, faults=faults, defect=self.defect)
        other = None
        if workload.twice:  # its synced files withstand a power cut too
            other = place.start(workload.words, faults=[], stderr="other", page=place.others_page)
        ended = place.end_of(process)
        others = place.end_of(other, "other") if other else None
        fired = [fault for fault, count in zip([f for f in faults if not f.startswith("end:")], ended.fired) if count]
        if "end:1:cut" in faults:
            fired.append("end:1:cut")
        has_cut = any(fault.endswith(":cut") for fault in fired)
        waits = has_cut or chance.random() < 0.5
        if waits:
            place.wait_for_all()
        if has_cut:
            power_cut.cut(place.synced, place.work, earlier, chance)
        self.check_end(ended, fired, known, has_second=bool(others))
        if others:
            self.check_end(others, [], known, has_second=True)
        if waits:
            self.check_results(snapshot(place.work), known, ended, fired, bool(other))
        again = place.call(workload.words, stderr="again")  # a process that is left may still write to the first
        place.wait_for_all()
        if again.status != 0 or messages(again, known):
            raise Found(f"the same command again ends with status {again.status}: {said(again)}")
        self.check_cut_runs()
        self.check_whole(snapshot(place.work), known)

    def check_cut_runs(self):
        """A run that is left with its streamed log has the first rows of the whole run, or is refused in one line."""
        place = self.place
        for kept in sorted(place.work.rglob(".*.partial-*/kept")):
            partial = kept.parent
            ended = place.call(("breakwater", "diff", "--quiet", str(partial.relative_to(place.work)), "run"),
                               stderr="again")
            lines = [line for line in ended.stderr.splitlines() if ": was cut at " not in line]
            if ended.status not in (0, 1, 2) or len(lines) != (ended.status == 2):
                raise Found(f"diff with the run that was cut ends with status {ended.status}: {said(ended)}")
            if ended.status != 2 and not is_beginning(partial / "log.h5", place.work / "run/log.h5"):
                raise Found("the rows of the run that was cut are not those of the whole run")
            shutil.rmtree(partial)

    def check_end(self, ended, fired, known, has_second):
        """Status and message are those that the pages promise."""
        ends = {fault.split(":")[2] for fault in fired} & set(SIGNALS)
        allowed = (STATUSES if fired else {0}) | {-SIGNALS[end] for end in ends}
        if ends & {"int", "term"} or (fired and "--status says why" in ended.stderr):
            allowed.add(INTERRUPTED)  # the second: tasks of a queue that ended early
        if has_second:
            allowed.add(2)  # the other one has the folder
        if ended.status not in allowed:
            raise Found(f"status {ended.status}: {said(ended)}")
        lines = messages(ended, known)
        # Also said of a disk that stays full, of a queue that could not be asked, of each child that was killed.
        if len(lines) > 1:
            lines = [line for line in lines if " is left undone: its process was ended by " not in line and
                     not line.startswith(("standard output: cannot be written", "squeue: cannot be called"))]
        # With a lasting fault the run and its picture may each say what they cannot open.
        if len(lines) > 1 + any(fault.split(":")[1].endswith("+") for fault in fired):
            raise Found(f"status {ended.status} with {len(lines)} lines: {said(ended)}")
        if ended.status > 0 and not lines:
            raise Found(f"status {ended.status} without a message")
        if lines and ("defect" in lines[0] or "what():" in lines[0]):
            raise Found(f"status {ended.status}: {said(ended)}")

    def check_results(self, found, known, ended, fired, has_second):
        """Each result is the earlier or the new one."""
        was_killed = ended.status < 0 or any(fault.endswith((":cut", ":kill")) for fault in fired)
        now = units(found, known.before, known.after)
        earlier = units(known.before, known.after)
        new = units(known.after, known.before)
        for name in {*now, *earlier, *new}:
            content = now.get(name)
            if TEMPORARY.search(name) or any(TEMPORARY.search(str(p)) for p in pathlib.Path(name).parents):
                # The earlier run stays until its new name is on the disk.
                is_earlier = sorted((content or {}).values()) in [sorted(run.values()) for run in earlier.values()]
                is_excused = is_earlier or was_killed or has_second or "kept in" in ended.stderr or \
                    "log so far is in" in ended.stderr or any(
                    f.startswith(("remove:", "open:", "memory:")) for f in fired)
                if not is_excused:
                    raise Found(f"status {ended.status} leaves {name}")
                continue
            if KEPT.search(name):
                if "kept in" not in ended.stderr:
                    raise Found(f"{name} is kept without a word")
                continue
            if content == new.get(name):
                continue
            folder, _, file = name.rpartition("/")
            if file in STREAM_FILES and f"{folder}/manifest.json" in found:
                continue  # they are removed once the run has its name
            is_old = content == earlier.get(name) or self.is_aside(name, earlier, now)
            if ended.status == 0 and not any(fault.endswith(":cut") for fault in fired) and not has_second:
                raise Found(f"status 0, and {name} is {'the earlier one' if is_old else 'another one'}")
            file = next(iter(content or {""}))
            if is_old or is_part(file, (content or {}).get(file), known.after):
                continue
            raise Found(f"status {ended.status}, and {name} is neither the earlier one nor the new one")

    def is_aside(self, name, earlier, now):
        """Whether a run waits under its other name, until the next reader puts it back."""
        folder, _, file = name.rpartition("/")
        wanted = sorted(earlier.get(name, {}).values())
        for other, content in now.items():
            if f".{file}.earlier-" in other and sorted(content.values()) == wanted:
                return True
        return False

    def check_whole(self, found, known):
        for name in sorted({*found, *known.after}):
            if KEPT.search(name) or (pathlib.Path(name).parent / "kept").as_posix() in found or f"{name}/kept" in found:
                continue
            if name not in known.after:
                raise Found(f"the same command again leaves {name}")
            if name not in found:
                raise Found(f"after the same command again {name} is absent")
            if found[name] != known.after[name]:
                raise Found(f"after the same command again {name} differs from that of an undisturbed one")

    def shrink(self, number, workload, faults):
        """The fewest faults that still show something, and what."""
        for fault in list(faults):
            rest = [other for other in faults if other != fault]
            if rest and (problem := self.problem(number, workload, rest)):
                return self.shrink(number, workload, rest) or (rest, problem)
        return None

    def problem(self, number, workload, faults):
        try:
            self.try_faults(number, workload, faults)
        except Found as found:
            return str(found)
        return None

    def run(self, number, workload, faults):
        """A text: the defect, and how to show it again. None without a defect."""
        faults = faults or self.draw(random.Random(number), self.undisturbed(workload).counts, "slurm" in workload.name)
        problem = self.problem(number, workload, faults)
        if not problem:
            return None
        faults, problem = self.shrink(number, workload, faults) or (faults, problem)
        return (f"seed {number}: {workload.name}: {','.join(faults)}: {problem}\n"
                f"  ./dev chaos --seeds {number}..{number} --workload {workload.name} --faults {','.join(faults)}"
                f"{' --planted ' if self.defect else ''}{self.defect}")


def messages(ended, known):
    """Lines that are neither warnings nor said without faults, nor the progress of a busy machine every 30 s."""
    progress = re.compile(r".*: \d+ %(, \d+ of \d+ runs)?(, \d+ s left)?$")
    return [line for line in ended.stderr.splitlines()
            if line not in known.stderr and ": warning: " not in line and not progress.match(line)]


def is_beginning(part, whole):
    """Whether the rows of a log that have a time are the first rows of another one."""
    with h5py.File(part) as first, h5py.File(whole) as second:
        for track in first:
            rows = int(np.isfinite(first[track]["time_s"][:]).sum())
            for name, data in first[track].items():
                if not name.startswith("index_") and not np.array_equal(data[:rows], second[track][name][:rows]):
                    return False
    return True


def said(ended):
    lines = ended.stderr.splitlines()
    return " | ".join(lines[:3]) if lines else "no message"


def read_range(text):
    match = re.fullmatch(r"(\d+)(?:\.\.(\d+))?", text)
    if not match or int(match[2] or match[1]) < int(match[1]):
        raise argparse.ArgumentTypeError(f"{text}: must be a seed, or FROM..TO with FROM not above TO")
    return range(int(match[1]), int(match[2] or match[1]) + 1)


def read_faults(text):
    faults = text.split(",")
    for fault in faults:
        kind, _, rest = fault.partition(":")
        is_fault = kind in CLASSES and re.fullmatch(rf"[1-9]\d*\+?:({'|'.join(ERRORS[kind] + ENDS)})", rest)
        if not is_fault and fault != "end:1:cut":
            raise argparse.ArgumentTypeError(f"{fault}: must be CLASS:CALL[+]:FAULT, as in a line that this prints")
    if len(faults) > MOST_FAULTS:
        raise argparse.ArgumentTypeError(f"has more than {MOST_FAULTS} faults")
    return faults


def read_jobs(text):
    if not re.fullmatch(r"[1-9]\d*", text):
        raise argparse.ArgumentTypeError(f"{text}: must be a positive whole number")
    return int(text)


def main():
    names = [workload.name for workload in WORKLOADS]
    parser = argparse.ArgumentParser(prog="./dev chaos", allow_abbrev=False)
    parser.add_argument("build", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--seeds", type=read_range, default=range(1, 201), metavar="FROM..TO", help="or one seed; default: 1..200")
    parser.add_argument("--each", action="store_true", help="each step of the --workload in place of seeds")
    parser.add_argument("--jobs", type=read_jobs, default=os.cpu_count(), metavar="N",
                        help="default: one for each core")
    parser.add_argument("--workload", choices=names, metavar="NAME", help=f"this one alone: {', '.join(names)}")
    parser.add_argument("--faults", type=read_faults, metavar="LIST", help="these ones, instead of those of the seed")
    parser.add_argument("--planted", choices=DEFECTS, default="", help="let the programs have a defect")
    parser.add_argument("--check", action="store_true", help=argparse.SUPPRESS)  # the arguments alone
    asked = parser.parse_args()
    if asked.each and not asked.workload:
        parser.error("--each needs --workload")
    if asked.check:
        return 0
    stop = threading.Event()
    adopt_orphans()
    memory = pathlib.Path("/dev/shm")
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="chaos", dir=memory if memory.is_dir() else None) as base, \
            concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        def disturb(worker):
            """The seeds of every asked.jobs-th workload."""
            own = pathlib.Path(base) / str(worker)
            own.mkdir()
            chaos, tried, found = Chaos(asked.build.resolve(), own, asked.planted), 0, 0
            one = WORKLOADS[names.index(asked.workload)] if asked.workload else None
            tries = [(number, one or WORKLOADS[number % len(WORKLOADS)], asked.faults) for number in asked.seeds]
            if asked.each:
                tries = [(1, one, faults) for faults in each_step(chaos.undisturbed(one).counts)]
            for i, (number, workload, faults) in enumerate(tries):
                if stop.is_set():
                    break
                if (i if one else number % len(WORKLOADS)) % asked.jobs != worker:
                    continue
                tried += 1
                problem = chaos.run(number, workload, faults)
                if problem and not stop.is_set():
                    print(problem, flush=True)
                    found += 1
            return tried, found
        try:
            tried, found = (sum(counts) for counts in zip(*pool.map(disturb, range(asked.jobs))))
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            return INTERRUPTED
        finally:
            stop.set()
    print(f"{tried} {'steps' if asked.each else 'seeds'} in {time.monotonic() - begin:.0f} s: {found or 'nothing'} found")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
