#!/usr/bin/python3
"""Draws docs/pictures/soak.png from the samples of `./dev soak`.

    tests/soak/plot.py [FOLDER_OF_SAMPLES] [PICTURE]
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from figures import COLOURS  # noqa: E402

PARTS = {"steps": "one streamed run", "runs": "runs", "frames": "frames of a video", "replays": "replays"}
BINS = 50  # means of the time, whose samples have a resolution of 10 ms


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/soak")
    picture = sys.argv[2] if len(sys.argv) > 2 else ROOT / "docs/pictures/soak.png"
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(3, len(PARTS), figsize=(9, 5), sharex="col", constrained_layout=True)
    for (name, title), column, colour in zip(PARTS.items(), axes.T, COLOURS):
        with open(folder / f"{name}.csv") as file:
            rows = [[float(cell) for cell in row.values()] for row in csv.DictReader(file)]
        counts, _, memory, descriptors, used = zip(*rows)
        bins = sorted({round(i * (len(rows) - 1) / BINS) for i in range(BINS + 1)})
        each = [1e6 * (used[b] - used[a]) / (counts[b] - counts[a]) for a, b in zip(bins, bins[1:])]
        column[0].plot(counts, [kB / 1000 for kB in memory], color=colour)
        column[1].plot(counts, descriptors, color=colour)
        column[2].plot([counts[b] for b in bins[1:]], each, color=colour)
        column[0].set_title(f"{counts[-1]:.0e} {'steps, ' if name == 'steps' else ''}{title}".replace("e+0", "e"))
        column[2].set_xlabel("steps" if name == "steps" else title.split()[0])
        for axis in column:
            axis.set_ylim(bottom=0)
            axis.grid(alpha=0.25)
    for axis, label in zip(axes[:, 0], ("resident memory [MB]", "open descriptors", "processor time [µs]")):
        axis.set_ylabel(label)
    figure.savefig(picture, dpi=120)


if __name__ == "__main__":
    main()
