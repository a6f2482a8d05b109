#!/usr/bin/python3
"""Draws charts of a page as a figure for a paper, or writes its tables for LaTeX.

    scripts/figures.py PAGE.html [--chart ID ...] --out FIGURE.pdf [--from S] [--to S] [--width INCHES]
    scripts/figures.py PAGE.html --out TABLES.tex

PAGE is a page of any command that has charts: of compare, report, analyze, sweep, tune, identify, reproduce. The figure has a
panel per chart, by default for those that the page does not fold away, and their first time window. FIGURE is .pdf,
.svg or .png. Fonts are embedded. TABLES has each table of the page, as LaTeX's package booktabs sets it.

A page is one JSON (docs/explanation/decisions/0023-a-page-is-data.md), so you can copy and change this file. STYLE is
the style, result_of() reads the page, draw() draws the figure. `breakwater compare --svg --pdf --latex` calls it.

Figures need Debian's python3-matplotlib.
"""

import argparse
import base64
import itertools
import json
import math
import os
import re
import sys
import tempfile
import zlib
from pathlib import Path


def refuse(reason):
    """End like all commands with wrong input."""
    print(f"figures.py: {reason}", file=sys.stderr)
    sys.exit(2)


def plotting():
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot
    except ImportError as error:
        refuse(f"{error.name} is missing: apt-get install python3-matplotlib")
    return matplotlib.pyplot


# As on pages, the last of references (src/render/line_style.cpp).
COLOURS = ["#451de2", "#c71e2e", "#0ca162", "#9542a7", "#431341", "#5977ff", "#b58e03", "#6b7682"]
DASHES = ["-", (0, (9, 3)), (0, (5, 3)), (0, (9, 3, 2, 3)), (0, (2, 3)), (0, (14, 4)), (0, (5, 3, 2, 3, 2, 3)), (0, (4, 4))]
STYLE = {
    "font.size": 8,
    "font.family": "serif",
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
MARKS = {"": "", "dot": "o", "cross": "x", "ring": "o"}
PANEL_HEIGHT = 1.25  # inches


def result_of(page):
    """The data of a page."""
    try:
        packed = re.search(r'id="packed">([^<]*)', Path(page).read_text())[1]
        return json.loads(zlib.decompress(base64.b64decode(packed)))["result"]
    except (OSError, TypeError, ValueError, KeyError, zlib.error):
        refuse(f"{page}: is no page of breakwater")


def charts_of(part, is_folded=False):
    """The charts below a part of the data, each with whether the page folds it away."""
    if isinstance(part, dict) and "series" in (part.get("data") or {}):
        yield part, is_folded
    elif isinstance(part, (dict, list)):
        for name, one in part.items() if isinstance(part, dict) else enumerate(part):
            yield from charts_of(one, is_folded or name == "fold")


def values_of(differences, first, step, is_log):
    """The numbers of a packed series; NaN is a gap."""
    sums = itertools.accumulate(d for d in differences if d is not None)
    values = [math.nan if d is None else first + step * next(sums) for d in differences]
    return [10**value for value in values] if is_log else values


def literal(text):
    """A text without formulas: matplotlib takes what is between two dollar signs for one."""
    return text.replace("$", r"\$")


def axis_label(title, height):
    """The title with its unit on a line of its own, as large as the height allows."""
    text = title.replace(" [", "\n[")
    # Letters of a serif are about half as wide as high.
    size = min(STYLE["font.size"], 72 * height / (0.52 * max(map(len, text.split("\n")))))
    return {"ylabel": literal(text), "fontsize": size}


def columns(labels, width):
    """The number of legend columns that fit."""
    longest = max(map(len, labels)) * 0.52 * STYLE["font.size"] / 72 + 0.4
    return max(1, min(len(labels), int(width / longest)))


LATEX = {**{sign: "\\" + sign for sign in "&%$#_{}"}, "\\": r"\textbackslash{}", "~": r"\textasciitilde{}",
         "^": r"\textasciicircum{}", "²": "$^2$", "³": "$^3$", "−": "$-$"}


def tables_of(part):
    """The tables below a part of the data, in their order."""
    if isinstance(part, dict) and {"label", "columns", "rows"} <= part.keys():
        yield part
    elif isinstance(part, (dict, list)):
        for one in part.values() if isinstance(part, dict) else part:
            yield from tables_of(one)


def latex_cell(cell):
    """A cell in LaTeX: a text, or a number with four digits."""
    value = cell.get("value") if isinstance(cell, dict) else cell
    if value is None:
        return "--"
    if isinstance(value, str):
        return "".join(LATEX.get(letter, letter) for letter in value)
    digits, _, power = f"{value:.4g}".partition("e")
    number = digits + (rf" \times 10^{{{int(power)}}}" if power else "")
    return f"${number}$" if power or value < 0 else number


def latex(table):
    lines = [" & ".join(map(latex_cell, row)) + r" \\" for row in [table["columns"], *table["rows"]]]
    lines.insert(1, r"\midrule")
    form = "l" + "r" * (len(table["columns"]) - 1)
    return "\n".join([f"% {table['label']}", rf"\begin{{tabular}}{{{form}}}", r"\toprule", *lines, r"\bottomrule", r"\end{tabular}", ""])


def draw(charts, window, width):
    plt = plotting()
    plt.style.use("default")  # a matplotlibrc of the user must not change the figure
    plt.rcParams.update(STYLE)
    figure, axes = plt.subplots(len(charts), 1, squeeze=False, constrained_layout=True,
                                sharex="x" not in charts[0]["data"],
                                figsize=(width, 0.45 + PANEL_HEIGHT * len(charts)))
    for axis, data in zip(axes[:, 0], (chart["data"] for chart in charts)):
        x = data.get("x", {"title": "time [s]", "from": 0.0, "step": 1e-6, "log": False})
        low, high = (given if given is not None else shown for given, shown in zip(window, data.get("window", [-math.inf, math.inf])))
        for series in data["series"]:
            if series["off"]:
                continue
            dash = DASHES[series["dash"]] if series.get("line", True) else ""
            places, values, *band = (
                values_of(series[name], *((x["from"], x["step"], x["log"]) if name == "t"
                                          else (series["from"], series["step"], data.get("log"))))
                for name in ("t", "v", "low", "high") if name in series)
            points = list(zip(places, values))
            if band:
                axis.fill_between(places, *band, color=COLOURS[series["colour"]], alpha=0.16, linewidth=0)
            axis.plot(*zip(*[point for point in points if low <= point[0] <= high] or [(math.nan, math.nan)]),
                      label=literal(series["label"]), color=COLOURS[series["colour"]], linestyle=dash, fillstyle="none",
                      marker=MARKS[series.get("marks", "")])
        for value in data["lines"]:
            axis.axhline(value, color="black", linewidth=0.6, linestyle=":")
        axis.set_xscale("log" if x["log"] else "linear")
        axis.set_yscale("log" if data.get("log") else "linear")
        axis.set_ylabel(**axis_label(data["title"], PANEL_HEIGHT))
        if "labels" in x:
            axis.set_xticks(*zip(*((10**place if x["log"] else place, literal(label)) for place, label in x["labels"])), minor=False)
            axis.set_xticks([], minor=True)
        if axis is axes[-1, 0] or len({chart["data"].get("x", x)["title"] for chart in charts}) > 1:
            axis.set_xlabel(literal(x["title"]))
    lines, labels = axes[0, 0].get_legend_handles_labels()
    if len(lines) > 1:
        axes[0, 0].legend(lines, labels, loc="lower left", bbox_to_anchor=(0, 1), ncols=columns(labels, width), borderpad=0,
                          handlelength=1.4, columnspacing=1.2)
    return figure


def replace(name, write):
    """The whole file or the one before, also after a power cut."""
    mask = os.umask(0)
    os.umask(mask)
    place = Path(name).resolve()  # a link stays
    with tempfile.NamedTemporaryFile(dir=place.parent, prefix=f".{place.name}.partial-", delete=False) as file:
        try:
            write(file)
            file.flush()
            os.fchmod(file.fileno(), 0o666 & ~mask)
            os.fsync(file.fileno())
            os.replace(file.name, place)
        except BaseException:
            os.unlink(file.name)
            raise


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page", nargs="?", metavar="PAGE")
    parser.add_argument("--chart", action="append", metavar="ID")
    parser.add_argument("--out", metavar="FIGURE")
    parser.add_argument("--from", dest="start", type=float, metavar="S")
    parser.add_argument("--to", dest="end", type=float, metavar="S")
    parser.add_argument("--width", type=float, default=3.5, metavar="INCHES",
                        help="3.5: one column of a paper (default)")
    parser.add_argument("--check", action="store_true", help="only say whether it could draw")
    arguments = parser.parse_args()
    if arguments.check:
        plotting()
        return
    if not (arguments.page and arguments.out):
        parser.error("give PAGE and --out")
    result = result_of(arguments.page)
    if arguments.out.endswith(".tex"):
        text = "\n".join(["% needs \\usepackage{booktabs}", *map(latex, tables_of(result))])
        replace(arguments.out, lambda file: file.write(text.encode()))
        return
    everything = list(charts_of(result))
    charts = [chart for chart, is_folded in everything
              if (chart["id"] in arguments.chart if arguments.chart else not is_folded)]
    if not charts:
        refuse(f"{arguments.page}: has no such chart (there are {', '.join(chart['id'] for chart, _ in everything) or 'none'})")
    figure = draw(charts, (arguments.start, arguments.end), arguments.width)
    kind = Path(arguments.out).suffix[1:]
    if not kind:
        parser.error(f"--out {arguments.out}: must end with .pdf, .svg, .png or .tex")
    metadata = {"Date": None} if kind == "svg" else None
    replace(arguments.out, lambda file: figure.savefig(file, format=kind, dpi=200, metadata=metadata))


if __name__ == "__main__":
    main()
