#!/usr/bin/env python3
"""Asks Slurm for `sweep --slurm` and `tune --slurm`.

slurm.py limit                 prints the largest number of tasks in one array job
slurm.py submit DIR/slurm/N KEY=VALUE…
                               submits a task for each line of `tasks` there, which runs the words
                               of `command`, and prints the job's number, behind warnings
slurm.py queue DIR             prints what is in the queue, "job 12: 3 RUNNING, 5 PENDING (Resources)",
                               and for each task of all submissions, the last submission first,
                               whether it is queued, its log and its points

If Slurm does not answer, the last line says why, and the exit status is 3.
"""
import collections
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys

WARNING_S = 60  # this long before a time limit
NO_ANSWER = 3


def fail(reason):
    print(reason, file=sys.stderr)
    sys.exit(NO_ANSWER)


def ask(*words):
    """The lines of a program of Slurm."""
    # sbatch inside a job would pass what describes it on to the tasks of the new job, such as
    # SLURM_CPUS_PER_TASK. Variables about the cluster and the user may stay.
    leaves_out = "SLURM_JOB_ID" in os.environ
    stay = {"SLURM_CONF", "SLURM_CLUSTERS", "SLURM_JWT"}
    environment = {name: value for name, value in os.environ.items() if not leaves_out
                   or name in stay or not name.startswith(("SLURM_", "SLURMD_"))}
    try:
        done = subprocess.run(words, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, encoding="utf-8", errors="surrogateescape")
    except OSError as error:
        fail(f"{words[0]}: cannot be called ({error.strerror})")
    lines = [line for line in done.stdout.splitlines() if line]
    if done.returncode != 0:
        said = "; ".join(lines) or "has failed"
        fail(said if said.startswith(words[0] + ": ") else f"{words[0]}: {said}")
    return lines


def limit():
    config = "\n".join(ask("scontrol", "show", "config"))
    found = []
    for name in ("MaxArraySize", "MaxJobCount"):
        number = re.search(rf"^{name}\D*([0-9]+)", config, re.MULTILINE)
        if number is None or int(number[1]) == 0:
            fail(f"scontrol show config: has no {name} above 0")
        found.append(int(number[1]))
    print(min(found[0] - 1, found[1]))  # an index must stay below MaxArraySize


def job_script(folder, asked):
    """Calls the study's program for the points of line SLURM_ARRAY_TASK_ID."""
    tasks = len((folder / "tasks").read_text().splitlines())
    program = asked["command"][0]
    settings = {
        "job-name": asked["name"][0],
        "array": f"1-{tasks}" + "".join(f"%{most}" for most in asked["parallel"]),
        "output": str(folder).replace("%", "%%") + "/%a.log",
        "open-mode": "append",
        "chdir": os.getcwd(),
        "signal": f"B:USR1@{WARNING_S}"}
    lines = ["#!/bin/bash"]
    for name, value in settings.items():
        quoted = re.sub(r'(["\\])', r"\\\1", value)
        lines.append(f'#SBATCH --{name}="{quoted}"')
    why = f"there is no {program}: it must lie where all nodes see it"
    lines += ["#SBATCH --requeue", 'fail() {\n  echo "$(hostname): $1" >&2\n  exit 127\n}',
              f"[ -x {shlex.quote(program)} ] || fail {shlex.quote(why)}",
              f"exec {shlex.join(asked['command'])} --points "
              f"@{shlex.quote(str(folder / 'tasks'))}:$SLURM_ARRAY_TASK_ID "
              "--jobs ${SLURM_CPUS_PER_TASK:-1}"]
    return "\n".join(lines) + "\n"


def submit(folder, asked):
    script = folder / "job.sh"
    script.write_bytes(os.fsencode(job_script(folder, asked)))
    try:
        said = ask("sbatch", "--parsable", *" ".join(asked["sbatch"]).split(), str(script))
        numbers = [line.partition(";")[0] for line in said if re.match(r"[0-9]+(;|$)", line)]
        if not numbers:
            fail("sbatch: has named no job")
    except SystemExit:
        shutil.rmtree(folder)
        raise
    (folder / "job").write_text(numbers[0] + "\n")
    print(*(line for line in said if not line.startswith(numbers[0])), numbers[0], sep="\n")


def queue(folder):
    submissions = []
    numbered = (path for path in folder.iterdir() if path.name.isdecimal())
    for path in sorted(numbered, key=lambda path: -int(path.name)):
        job = path / "job"
        if job.exists() and job.read_text():
            submissions.append((path, job.read_text().strip(), (path / "tasks").read_text().splitlines()))
    if not submissions:
        return
    states = {}
    for line in ask("squeue", "--noheader", "--array", f"--user={os.geteuid()}", "--format=%F|%K|%T|%r"):
        # The user may have jobs that are no arrays. Their index is N/A.
        if task := re.fullmatch(r"([0-9]+)\|([0-9]+)\|([^|]*)\|([^|]*)", line):
            job, index, state, reason = task.groups()
            waits = state == "PENDING" and reason != "None"
            states[job, int(index)] = f"{state} ({reason})" if waits else state
    texts = []
    for _, job, _ in submissions:
        counts = collections.Counter(state for (of, _), state in states.items() if of == job)
        if counts:
            texts.append(f"job {job}: " + ", ".join(f"{n} {state}" for state, n in sorted(counts.items())))
    print("text", "; ".join(texts), sep="\t")
    for path, job, tasks in submissions:
        for index, points in enumerate(tasks, 1):
            print("queued" if (job, index) in states else "over", path / f"{index}.log", points, sep="\t")


def main():
    sys.stdout.reconfigure(errors="surrogateescape")
    # A terminal's Ctrl-C reaches this process too. It writes what it has begun: a job without its number is lost.
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(one) is not signal.SIG_IGN:
            signal.signal(one, lambda *_: None)
    command, *rest = sys.argv[1:]
    if command == "limit":
        limit()
    elif command == "queue":
        queue(pathlib.Path(rest[0]) / "slurm")
    else:
        asked = collections.defaultdict(list)
        for key, _, value in (word.partition("=") for word in rest[1:]):
            asked[key].append(value)
        submit(pathlib.Path(rest[0]), asked)


if __name__ == "__main__":
    main()
