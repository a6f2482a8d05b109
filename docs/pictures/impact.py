#!/usr/bin/python3
"""Draws docs/pictures/impact.png from the runs of `arm_wall_contact --case all`.

    docs/pictures/impact.py [FOLDER_OF_RUNS] [PICTURE]

A log is plain HDF5: one group per time base, one dataset per signal, so copy and change this.
"""

import sys
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from figures import COLOURS  # noqa: E402

SWITCH_S = 30.0  # key force.from_s
METHODS = dict(zip(("proposed", "hpfc", "drac"), COLOURS))
NAMES = {"proposed": "proposed (PFC)", "hpfc": "HPFC", "drac": "DRAC"}


def main():
    runs = Path(sys.argv[1] if len(sys.argv) > 1 else "runs/arm_wall_contact/all-seed1")
    picture = sys.argv[2] if len(sys.argv) > 2 else Path(__file__).with_name("impact.png")

    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 1, figsize=(7.5, 5), sharex=True, constrained_layout=True)
    for axis, force in zip(axes, ("2N", "5N")):
        for method, colour in METHODS.items():
            with h5py.File(runs / f"{method}-{force}" / "log.h5") as log:
                physics = log["physics"]
                time = physics["time_s"][:] - SWITCH_S
                axis.plot(time, physics["force_true_N"][:], color=colour, lw=0.6, alpha=0.45)
                axis.plot(time, physics["force_filtered_N"][:], color=colour, lw=1.8,
                          label=NAMES[method])
        axis.axhline(float(force[:-1]), color="0.4", lw=0.8, ls="--", label="reference")
        axis.set(ylabel="contact force [N]", xlim=(0, 2.5), title=f"reference {force[:-1]} N")
        axis.grid(alpha=0.25)
    axes[0].legend(frameon=False, ncols=4, loc="upper right")
    axes[1].set_xlabel("time since the switch to force control [s]"
                       "     thin: raw, thick: behind the sensor's low-pass")
    figure.savefig(picture, dpi=120)


if __name__ == "__main__":
    main()
