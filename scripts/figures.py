#!/usr/bin/python3
"""Draws signals of finished runs as a figure for a paper.

    scripts/figures.py RUN [RUN ...] --signal NAME [--signal NAME ...] --out FIGURE.pdf
                       [--from S] [--to S] [--label TEXT ...] [--look N ...] [--width INCHES]

The figure has a panel per signal, a line per run, and a common time axis. NAME is a signal of the log's group
`control`, GROUP/NAME one of another group. NAME[2] is the second value of a vector. FIGURE is .pdf, .svg or
.png. Fonts are embedded.

A run's log is plain HDF5 (docs/how-to/running.md), so you can copy and change this file. STYLE is the style,
read() reads a signal, draw() draws the figure. `breakwater compare --svg --pdf` calls it.

Needs Debian's python3-h5py and python3-matplotlib.
"""

import argparse
import json
import re
import sys
from pathlib import Path


def refuse(reason):
    """End like all commands with wrong input."""
    print(f"figures.py: {reason}", file=sys.stderr)
    sys.exit(2)


try:
    import h5py
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError as error:
    refuse(f"{error.name} is missing: apt-get install python3-h5py python3-matplotlib")

# The colours of pages (src/render/identity.cpp).
COLOURS = ["#451de2", "#c71e2e", "#0ca162", "#9542a7", "#431341", "#5977ff", "#b58e03"]
DASHES = ["-", (0, (9, 3)), (0, (5, 3)), (0, (9, 3, 2, 3)), (0, (2, 3)), (0, (14, 4)), (0, (5, 3, 2, 3, 2, 3))]
STYLE = {
    "font.size": 8,
    "font.family": "serif",
    "text.parse_math": False,  # a name may have any $ in it
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "lines.linewidth": 0.9,
    "legend.frameon": False,
    # Text stays text: TrueType in PDF. SVG has outlines, so that no viewer lacks a font.
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    # Equal runs give equal files.
    "svg.hashsalt": "breakwater",
}
PANEL_HEIGHT = 1.25  # inches


def read(run, signal):
    """Times, values, unit of a signal of a run."""
    parts = re.fullmatch(r"(?:([^\[/]+)/)?([^\[/]+)(?:\[([1-9]\d*)\])?", signal)
    if parts is None:
        refuse(f"--signal {signal}: must be NAME, GROUP/NAME or NAME[1]")
    group, name, index = parts[1] or "control", parts[2], parts[3]
    if not (Path(run) / "log.h5").is_file():
        refuse(f"{run}: is not a finished run: it has no log.h5")
    try:
        with h5py.File(Path(run) / "log.h5") as log:
            values = log[group][name]
            unit = values.attrs["unit"]
            if isinstance(unit, bytes):  # not in logs of version 0.1
                unit = unit.decode()
            if values.ndim == 2 and index is None:
                refuse(f"{run}: {signal} has {values.shape[1]} values: say which, "
                         f"{signal}[1]")
            column = values[:] if values.ndim == 1 else values[:, int(index) - 1]
            if values.ndim == 2 and unit.count(", ") + 1 == values.shape[1]:
                unit = unit.split(", ")[int(index) - 1]  # the unit of this value
            return log[group]["time_s"][:], column, unit
    except (OSError, KeyError, IndexError):
        refuse(f"{run}: its log has no signal {signal}")


def has(run, signal):
    """Whether a run's log has a signal."""
    name = signal.split("[")[0]
    group, name = name.split("/") if "/" in name else ("control", name)
    try:
        with h5py.File(Path(run) / "log.h5") as log:
            return group in log and name in log[group]
    except OSError:
        return True  # read() reports the error


def axis_label(signal, unit, height):
    """The name and the unit of a signal, on a line each, as large as the height allows."""
    text = signal.split("/")[-1]
    lines = [text] + ([f"[{unit}]"] if unit != "1" else [])
    # Letters of a serif are about half as wide as high.
    size = min(STYLE["font.size"], 72 * height / (0.52 * max(map(len, lines))))
    return {"ylabel": "\n".join(lines), "fontsize": size}


def columns(labels, width):
    """The number of legend columns that fit."""
    longest = max(map(len, labels)) * 0.52 * STYLE["font.size"] / 72 + 0.4
    return max(1, min(len(labels), int(width / longest)))


def label_of(run):
    """The run's case, or the folder's name."""
    try:
        return json.loads((Path(run) / "manifest.json").read_text())["case"]
    except (OSError, ValueError, KeyError):
        return Path(run).name


def labels_of(runs):
    """The cases if they differ; else the names of the folders."""
    cases = [label_of(run) for run in runs]
    return cases if len(set(cases)) == len(cases) else [Path(run).name for run in runs]


def draw(runs, labels, looks, signals, window, width):
    plt.style.use("default")  # a matplotlibrc of the user must not change the figure
    plt.rcParams.update(STYLE)
    figure, axes = plt.subplots(len(signals), 1, sharex=True, squeeze=False,
                                figsize=(width, 0.45 + PANEL_HEIGHT * len(signals)),
                                constrained_layout=True)
    for axis, signal in zip(axes[:, 0], signals):
        if not any(has(run, signal) for run in runs):
            read(runs[0], signal)  # this reports the error
        for run, label, look in zip(runs, labels, looks):
            style = {"label": label, "color": COLOURS[look % 7], "linestyle": DASHES[(look + look // 7) % 7]}
            if not has(run, signal):
                axis.plot([], [], **style)
                continue
            time, values, unit = read(run, signal)
            inside = (time >= window[0]) & (time <= window[1])
            axis.plot(time[inside], values[inside], **style)
        axis.set_ylabel(**axis_label(signal, unit, PANEL_HEIGHT))
    axes[-1, 0].set_xlabel("time [s]")
    if len(runs) > 1:
        # The legend has all runs, also those without this signal.
        axes[0, 0].legend(axes[0, 0].get_lines(), labels, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns(labels, width), borderpad=0,
                          handlelength=1.4, columnspacing=1.2)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="*", metavar="RUN")
    parser.add_argument("--signal", action="append", default=[], metavar="NAME")
    parser.add_argument("--out", metavar="FIGURE")
    parser.add_argument("--from", dest="start", type=float, default=float("-inf"), metavar="S")
    parser.add_argument("--to", dest="end", type=float, default=float("inf"), metavar="S")
    parser.add_argument("--label", action="append", metavar="TEXT", help="one for each run")
    parser.add_argument("--look", action="append", type=int, metavar="N", help="one for each run: its place among the colours, from 0")
    parser.add_argument("--width", type=float, default=3.5, metavar="INCHES",
                        help="3.5: one column of a paper (default)")
    parser.add_argument("--check", action="store_true", help="only say whether it could draw")
    arguments = parser.parse_args()
    if arguments.check:
        return
    if not (arguments.runs and arguments.signal and arguments.out):
        parser.error("give RUN, --signal and --out")
    labels = arguments.label or labels_of(arguments.runs)
    if len(labels) != len(arguments.runs):
        parser.error(f"{len(labels)} --label for {len(arguments.runs)} runs")
    looks = arguments.look or range(len(labels))
    if len(looks) != len(labels):
        parser.error(f"{len(looks)} --look for {len(labels)} runs")
    figure = draw(arguments.runs, labels, looks, arguments.signal, (arguments.start, arguments.end),
                  arguments.width)
    metadata = {"Date": None} if arguments.out.endswith(".svg") else None
    figure.savefig(arguments.out, dpi=200, metadata=metadata)


if __name__ == "__main__":
    main()
