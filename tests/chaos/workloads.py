"""The commands that chaos.py disturbs: each is short, and leaves files."""

import dataclasses
import math
import pathlib

SWEEP = ("breakwater", "sweep", "cart_position", "--seeds", "1..4", "--duration", "0.1", "--set",
         "noise.std_m=1e-5", "--jobs", "2", "--keep", "all", "--quiet", "--out", "study")
LAB = ("ishigami_lab", "sweep", "ishigami", "--vary", "x.first=0,1,2", "--seeds", "1..2", "--quiet",
       "--out", "study")
CART = ("cart_position", "--quiet", "--duration", "0.1", "--out")
PICTURE = ("--size", "64x64", "--look", "fast")


@dataclasses.dataclass(frozen=True)
class Workload:
    name: str
    words: tuple
    earlier: tuple = ()  # commands before it, which are not disturbed
    files: dict = dataclasses.field(default_factory=dict)
    twice: bool = False  # a second process makes the same at the same time


TESTS = pathlib.Path(__file__).resolve().parents[1]
TUNING = (TESTS / "search/small.toml").read_text() + "[validate]\nseeds = { first = 101, count = 2 }\n"
EXPERIMENTS = (TESTS / "cli/data/statements.toml").read_text()

# Slurm's programs. Each task runs before sbatch prints the job's number.
SLURM = {
    "slurm/scontrol": "#!/bin/sh\necho MaxArraySize = 4\necho MaxJobCount = 100\n",
    "slurm/squeue": "#!/bin/sh\n",
    "slurm/sbatch": """\
#!/bin/bash
for script; do :; done
last=$(sed -n 's/^#SBATCH --array="1-\\([0-9]*\\).*/\\1/p' "$script")
for task in $(seq "$last"); do
  SLURM_JOB_ID=7 SLURM_ARRAY_TASK_ID=$task bash "$script" >> "$(dirname "$script")/$task.log" 2>&1
done 2> /dev/null
echo 7
""",
}

# The layer counts from chaos_begin() to chaos_end(): Python itself is not disturbed.
PYTHON = """\
import ctypes, sys
import breakwater as bw
import pandas  # before the layer counts: its own imports are not disturbed
layer = ctypes.CDLL(None)
try:
    layer.chaos_begin()
except AttributeError:  # without the layer
    layer = None
status, line = 0, ""
try:
    try:
        {call}
    except (bw.InputError, RuntimeError, OSError, MemoryError) as error:
        status, line = 2, str(error) or type(error).__name__
except (KeyboardInterrupt, pandas.errors.ParserError):  # pandas makes one of an interrupt while it reads
    status, line = 130, "interrupted"
if layer:
    layer.chaos_end()
if line:
    print(line, file=sys.stderr)
sys.exit(status)
"""


def recorded_axis():
    """A table of an inertia of 1e-3 kg m² under a torque of two sines, in steps of 1 ms."""
    rows, speed, position = ["time_s,u,y"], 0.0, 0.0
    for k in range(400):
        torque = 0.2 * math.sin(0.05 * k) + 0.1 * math.sin(0.131 * k)
        rows.append(f"{k * 1e-3:.3f},{torque:.9g},{position:.9g}")
        speed += 1e-3 * (torque - 2e-3 * speed) / 1e-3
        position += 1e-3 * speed
    return "\n".join(rows) + "\n"


def python(call):
    return {"words": ("python3", "script.py"), "files": {"script.py": PYTHON.format(call=call)}}


TABLE = {"table.csv": recorded_axis()}
WORKLOADS = [
    Workload("run", ("impact_test", "--duration", "0.05", "--out", "run")),
    Workload("run_again", (*CART, "run", "--csv"), earlier=((*CART, "run", "--case", "mdob"),)),
    Workload("all_cases", ("cart_position", "--case", "all", "--duration", "0.1", "--out", "all")),
    Workload("run_video", ("cart_position", "--duration", "0.1", "--video", "run.mp4", "--out", "run")),
    Workload("two_runs", (*CART, "run"), twice=True),
    Workload("sweep", (*SWEEP, "--sqlite")),
    Workload("sweep_goes_on", SWEEP, earlier=((*SWEEP, "--print-tasks"), ("breakwater", "sweep", "study", "--points", "0,2"))),
    Workload("sweep_compares", (*LAB, "--case", "plain,noisy")),
    Workload("sweep_isolated", (*LAB, "--isolate", "--jobs", "2")),
    Workload("sweep_slurm", (*LAB, "--slurm", "--wait", "--tasks", "2"), files=SLURM),
    Workload("two_sweeps", LAB, twice=True),
    Workload("tune", ("ishigami_lab", "tune", "t.toml", "--jobs", "2", "--out", "tuned"), files={"t.toml": TUNING}),
    Workload("tune_slurm", ("ishigami_lab", "tune", "t.toml", "--slurm", "--tasks", "2", "--out", "tuned"),
             files={"t.toml": TUNING, **SLURM}),
    Workload("identify", ("breakwater", "identify", "table.csv", "--out", "fit"), files=TABLE),
    Workload("estimate", ("breakwater", "estimate", "--csv", "table.csv", "--observer", "stf", "--out", "made",
                          "--set", "plant.inertia=1e-3", "encoder.quantum=1e-6"), files=TABLE),
    Workload("reproduce", ("breakwater", "reproduce", "--experiments", "list.toml", "--quiet", "--out", "made"),
             files={"list.toml": EXPERIMENTS}),
    Workload("analyze", ("breakwater", "analyze", "motor_estimation", "--case", "idob", "--points", "2", "--settle", "0.1",
                         "--from", "100", "--to", "200", "--out", "made")),
    Workload("report", ("breakwater", "report", "run", "--no-replay"), earlier=((*CART, "run"),)),
    Workload("compare", ("breakwater", "compare", "run", "other", "--no-replay", "--csv", "--latex", "--out", "made"),
             earlier=((*CART, "run"), (*CART, "other", "--case", "mdob"))),
    Workload("replay", ("breakwater", "replay", "run"), earlier=((*CART, "run"),)),
    Workload("diff", ("breakwater", "diff", "run", "run"), earlier=((*CART, "run"),)),
    Workload("video", ("breakwater", "video", "run", "--fps", "20", *PICTURE), earlier=((*CART, "run"),)),
    Workload("still", ("breakwater", "still", "run", "--at", "0.05", *PICTURE), earlier=((*CART, "run"),)),
    Workload("python_run", **python('bw.run("cart_position", duration=0.1, out="run")')),
    Workload("run_streamed", ("cart_position", "--quiet", "--duration", "3", "--set", "record.stream=true", "--out", "run")),
    Workload("python_sweep", **python('bw.sweep("cart_position", seeds=range(1, 4), duration=0.1, out="study")')),
]
