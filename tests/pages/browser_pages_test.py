"""The pages of runs, comparisons, studies, tunings and analyses in Chromium.

Each begins with its answer. It clips no table on a phone. Its text has contrast in light and in dark.
An axis has one unit. A case has the same colour on all pages.

Usage: browser_pages_test.py BUILD_BIN_FOLDER
"""

import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from chromium import CONTRAST, read, run  # noqa: E402

CASES = ["idob", "dkf"]
SHORT = ["run.duration_s=2", "metrics.from_s=1", "metrics.to_s=2"]
# The parts that must be seen before anything is scrolled.
FIRST = {
    "run": [".card div:nth-child(4)", ".replay .picture"],
    "compare": ["#metrics tbody tr:nth-child(4)", "#keys"],
    "study": [".finding", ".chart"],
    "tune": [".finding", "#front .chart canvas"],
    "analysis": ["#margins tbody tr:last-child", ".legend"],
}
TUNE = f"""
scenario = "motor_estimation"
algorithm = "nsga2"
budget = 16
population = 8
seeds = {{ first = 1, count = 1 }}
[search]
"controller.kd" = {{ log_uniform = [1, 10] }}
[set]
{chr(10).join(SHORT)}
[for_each.idob]
[for_each.dkf]
[objective]
rmse_velocity_rad_s = {{ goal = "min" }}
rms_torque_Nm = {{ goal = "min" }}
"""

LOOK = """
seen.pages = {};
const FIRST = %(first)s, CASES = %(cases)s;
%(contrast)s
async function lookAt(name) {
  const {frame, page, dom} = await open(name, 1280, 900);
  while (!page.pageData || (dom.querySelector(".chart") && !dom.querySelector(".chart[data-drawn]"))) await wait(25);
  const found = seen.pages[name] = {};
  // The head of each is in sight, if not all of it.
  found.below = FIRST[name].filter((what) => {
    const place = dom.querySelector(what);
    return !place || !place.getClientRects().length || place.getBoundingClientRect().top > 860;
  });
  found.titles = dom.querySelectorAll("h1").length;
  found.faint = faint(dom);
  const data = page.pageData || {};
  const charts = Object.values(data).filter((one) => one.series);
  found.charts = charts.length;
  found.mixed = charts.filter((one) => new Set(one.series.map((s) => s.unit)).size > 1).map((one) => one.title);
  const drawn = charts.flatMap((one) => one.series.filter((s) => !one.series.some((other) => other !== s && other.about === s.about) || name === "run").map((s) => s.about.split(":")[0]));
  found.twice = name === "run" ? drawn.filter((label, i) => label !== "" && drawn.indexOf(label) !== i) : [];
  found.ticks = Array.from(dom.querySelectorAll(".chart[data-drawn]"), (box) => box.querySelectorAll(".dygraph-axis-label-y").length);
  const style = page.getComputedStyle(dom.documentElement);
  found.colours = {};
  for (const place of dom.querySelectorAll("th, .legend li")) {
    const text = place.textContent.trim();
    const own = place.matches("[class*=c]") ? place : place.querySelector("[class*=c]");
    const colour = own && page.getComputedStyle(own).getPropertyValue("--c").trim();
    if (CASES.includes(text) && colour) found.colours[text] = colour;
  }
  if (name === "compare") {
    charts[0].series.forEach((s) => { found.colours[s.label + ", line"] = style.getPropertyValue("--c" + s.colour).trim(); });
  }
  frame.style.width = "390px";
  await laidOut(page);
  found.overflow = dom.scrollingElement.scrollWidth - dom.scrollingElement.clientWidth;
  found.clipped = Array.from(dom.querySelectorAll("table")).filter((table) =>
    table.getClientRects().length && !table.closest(".scroll") && table.scrollWidth > table.parentElement.clientWidth).length;
}
async function look() { for (const name of Object.keys(FIRST)) await lookAt(name); }
""" % {"first": json.dumps(FIRST), "cases": json.dumps(CASES), "contrast": CONTRAST}


def make_pages(program, folder):
    def call(*words):
        subprocess.run([program, *map(str, words)], cwd=folder, check=True, stdout=subprocess.DEVNULL)

    sets = [word for one in SHORT for word in ("--set", one)]
    runs = [f"runs/{name}" for name in CASES]
    for name, run in zip(CASES, runs):
        call("run", "motor_estimation", "--case", name, "--quiet", "--out", run, *sets)
    call("report", runs[0], "--out", "report")
    call("compare", *runs, "--out", "compare")
    call("sweep", "motor_estimation", "--case", ",".join(CASES), "--vary", "controller.kd=1,2,3,4,5,6,7", *sets,
         "--goal", "rmse_velocity_rad_s=min", "--out", "study")
    (folder / "tune.toml").write_text(TUNE)
    call("tune", "tune.toml", "--out", "tune")
    call("analyze", "motor_estimation", "--case", ",".join(CASES), "--points", 4, "--settle", 1, "--quiet", "--out", "analysis")
    return {"run": "report/report.html", "compare": "compare/compare.html", "study": "study/report.html",
            "tune": "tune/report.html", "analysis": "analysis/report.html"}


def test(bin_folder, folder):
    pages = {name: (folder / file).read_bytes() for name, file in make_pages(bin_folder / "breakwater", folder).items()}
    sizes = {name: len(page) for name, page in pages.items()}
    light, dark = (read(LOOK, pages, folder, ["--window-size=1300,920", *flags])
                   for flags in ([], ["--force-dark-mode", "--blink-settings=preferredColorScheme=0"]))
    print(json.dumps([sizes, light, dark], indent=1))
    for seen in (light, dark):
        colours = {}
        for name, found in seen["pages"].items():
            assert found["below"] == [], (name, found["below"])
            assert found["titles"] == 1, name
            assert found["faint"] == {}, (name, found["faint"])
            assert found["mixed"] == [] and found["twice"] == [], (name, found)
            assert all(count >= 4 for count in found["ticks"]), (name, found["ticks"])
            assert found["overflow"] == 0 and found["clipped"] == 0, (name, found)
            for label, colour in found["colours"].items():
                colours.setdefault(label.split(",")[0], set()).add(colour)
        assert sorted(colours) == sorted(CASES) and all(len(one) == 1 for one in colours.values()), colours
    assert light["pages"]["run"]["charts"] > 5 and len(light["pages"]["compare"]["colours"]) == 4, light
    assert sizes["run"] < 1.2e6 and sizes["compare"] < 2e6, sizes


if __name__ == "__main__":
    run(test)
