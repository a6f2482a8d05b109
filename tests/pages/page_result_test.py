"""A page is one JSON: Python reads it, its tables are the printed ones, its series those of the CSV.

No text in it ends the script that it is in.

Usage: page_result_test.py BUILD_BIN_FOLDER
"""

import base64
import csv
import itertools
import json
import math
import pathlib
import re
import subprocess
import sys
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from chromium import run  # noqa: E402

BLOCKS = {"about", "card", "code", "command", "failure", "figures", "finding", "fold", "legend", "list", "machine",
          "paragraph", "replay", "score", "subheading", "table", "text"}


def result_of(page):
    """The data of a page."""
    packed = re.findall(r'<script type="text/plain" id="packed">([A-Za-z0-9+/=]*)</script>', page)
    assert len(packed) == 1, "there is one result"
    return json.loads(zlib.decompress(base64.b64decode(packed[0])))["result"]


def values_of(differences, first, step):
    """The numbers of a packed series; None is a gap."""
    sums = itertools.accumulate(d for d in differences if d is not None)
    return [math.nan if d is None else first + step * next(sums) for d in differences]


def check_schema(result, name):
    assert result["page"] == name and result["version"] == 1 and result["title"], result
    ids = [section["id"] for section in result["sections"]]
    assert len(set(ids)) == len(ids), ids
    for block in blocks_of(result):
        assert len(set(block) & BLOCKS) <= 1, block  # without a part that depends on the machine
        table = block.get("table", {"columns": [], "rows": []})
        assert all(len(row) == len(table.get("columns", row)) for row in table["rows"]), table
        for figure in block.get("figures", []):
            for chart in figure["charts"]:
                for series in chart["data"]["series"]:
                    assert len(series["t"]) == len(series["v"]) > 0, chart["id"]


def blocks_of(part):
    """All blocks of a page, those in folded parts too."""
    for block in itertools.chain(part.get("lead", []), part.get("blocks", []),
                                 *(section["blocks"] for section in part.get("sections", []))):
        yield block
        yield from blocks_of(block.get("fold", {}))


def tables(result):
    return {block["table"]["label"]: block["table"] for block in blocks_of(result) if "table" in block}


def cell(value):
    value = value["value"] if isinstance(value, dict) else value
    return "-" if value is None else value if isinstance(value, str) else f"{value:.4g}"


# Linear RGB as dichromats see it: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A Physiologically-based Model
# for Simulation of Color Vision Deficiency", 2009, severity 1.
SIGHTS = [np.eye(3), [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
          [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
          [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]]
XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]])


def lab(rgb, sight):
    ratios = XYZ @ np.clip(sight @ rgb, 0, 1) / [0.95047, 1.0, 1.08883]
    f = np.where(ratios > 216 / 24389, np.cbrt(ratios), (24389 / 27 * ratios + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def check_colours(page):
    """Readers of any sight tell lines apart and see them on their paper, in light and in dark."""
    papers, sets = re.findall("--paper: (#[0-9a-f]{6})", page), re.findall(r":root\{(--c0:#.*?)\}", page)
    assert len(papers) == len(sets) == 2, papers
    for paper, colours in zip(papers, sets):
        srgb = np.array([[int(text[i:i + 2], 16) / 255 for i in (1, 3, 5)]
                         for text in [paper, *re.findall(r"--c\d:(#[0-9a-f]{6})", colours)]])
        below, *lines = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        assert len(lines) == 8
        for one, other in itertools.combinations(range(8), 2):
            far = [np.linalg.norm(lab(lines[one], sight) - lab(lines[other], sight)) for sight in SIGHTS]
            assert min(far) >= 20, (paper, one, other, far)
        for line in lines:  # WCAG 1.4.11
            bright, dark = sorted((XYZ[1] @ line, XYZ[1] @ below), reverse=True)
            assert (bright + 0.05) / (dark + 0.05) >= 3, line


def check_analysis(call, folder):
    printed = call("analyze", "motor_estimation", "--case", "idob,vfakfd", "--points", "3", "--from", "5",
                   "--to", "50", "--settle", "1", "--out", "analysis").splitlines()
    result = result_of((folder / "analysis/report.html").read_text())
    check_schema(result, "analysis")
    table = tables(result)["Margins"]
    assert "phase margin [deg]</th><td" in (folder / "analysis/report.html").read_text(), "without scripts too"
    for row in table["rows"]:
        lines = [line.removeprefix(row[0]).split() for line in printed if line.startswith(row[0])]
        assert list(itertools.chain(*lines)) == [cell(value) for value in row[1:]], (lines, row)
    # Gain of the loop: the designed line and the dots are those of the table.
    figures = result["sections"][1]["blocks"][0]["figures"]
    chart = next(c for f in figures for c in f["charts"] if c["id"] == "loop-gain-gain")["data"]
    rows = list(csv.DictReader((folder / "analysis/analysis.csv").open()))
    for series in chart["series"]:
        name = series["label"].split(",")[0]
        way = "designed" if series["label"] == name else "measured"
        gains = {float(r["omega_rad_s"]): float(r["loop_gain_gain"]) for r in rows if (r["case"], r["way"]) == (name, way)}
        assert chart["x"]["log"]
        for x, y in zip(values_of(series["t"], chart["x"]["from"], chart["x"]["step"]),
                        values_of(series["v"], series["from"], series["step"])):
            nearest = min(gains, key=lambda omega: abs(math.log10(omega) - x))
            assert abs(math.log10(nearest) - x) < 1e-4, (nearest, x)
            assert abs(20 * math.log10(gains[nearest]) - y) < 0.01, (name, nearest, y)


def check_runs(call, folder):
    for case in ("idob", "kfd"):
        call("run", "motor_estimation", "--case", case, "--seed", "3", "--duration", "11", "--quiet", "--out", case)
    call("report", "idob", "--out", "report")
    check_colours((folder / "report/report.html").read_text())
    run = result_of((folder / "report/report.html").read_text())
    check_schema(run, "runs")
    measured = json.loads((folder / "idob/metrics.json").read_text())
    values = [row[1]["value"] for row in tables(run)["Metrics"]["rows"]]
    assert sorted(values) == sorted(measured.values()), "all digits"
    printed = call("compare", "idob", "kfd", "--out", "compare").splitlines()
    both = result_of((folder / "compare/compare.html").read_text())
    check_schema(both, "compare")
    for row in tables(both)["Metrics"]["rows"]:
        name = row[0]["value"]
        line = next(line for line in printed if line.startswith(name + " "))
        assert line.split()[-2:] == [cell(value) for value in row[1:]], (line, row)
    call("sweep", "motor_estimation", "--case", "idob,kfd", "--vary", "encoder.bits=6,8", "--duration", "0.2", "--quiet", "--out", "study")
    check_schema(result_of((folder / "study/report.html").read_text()), "study")


def check_hostile(call, folder, record):
    bad = "'\"<i>{{title}}&<!--.csv"
    (folder / bad).write_text(record.read_text())
    call("identify", bad, "--out", "id")
    page = (folder / "id/report.html").read_text()
    result = result_of(page)
    check_schema(result, "identification")
    assert bad in json.dumps(result, ensure_ascii=False).replace('\\"', '"'), "it is in the data"
    assert "<i>" not in page and "<!--.csv" not in page and "&lt;i&gt;{{title}}&amp;" in page, "and only as text"
    assert page.count("</script>") == 3


def check_latex():
    """The special characters of LaTeX, and numbers with four digits."""
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
    from figures import latex

    rows = [["peak_force 50 % {a} $x$ #1 & ~^\\", 6.0461749], ["x [rad/s²]", {"value": -3.2e-5}], ["d", None]]
    assert latex({"label": "M", "columns": ["a", "b"], "rows": rows}).splitlines() == [
        "% M", r"\begin{tabular}{lr}", r"\toprule", r"a & b \\", r"\midrule",
        r"peak\_force 50 \% \{a\} \$x\$ \#1 \& \textasciitilde{}\textasciicircum{}\textbackslash{} & 6.046 \\",
        r"x [rad/s$^2$] & $-3.2 \times 10^{-5}$ \\", r"d & -- \\", r"\bottomrule", r"\end{tabular}"]


def test(bin_folder, folder):
    def call(*words):
        return subprocess.run([bin_folder / "breakwater", *words], cwd=folder, check=True, text=True,
                              stdout=subprocess.PIPE).stdout

    check_latex()
    check_analysis(call, folder)
    check_runs(call, folder)
    check_hostile(call, folder, pathlib.Path(__file__).resolve().parents[2] / "data/identify/bench1.csv")


if __name__ == "__main__":
    run(test)
