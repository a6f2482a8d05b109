"""A study's report works in Chromium: marks, keyboard, commands, narrow and wide.

The test makes two small studies and uses their pages like a reader, without any request.

Usage: browser_study_test.py BUILD_BIN_FOLDER
"""

import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from chromium import read, run  # noqa: E402

LOOK = """
async function look() {
  const {frame, page, dom} = await open("report", 1440, 900);
  seen.metrics = dom.querySelectorAll(".metric").length;
  const section = dom.querySelector(".metric");
  // The first marks of a chart.
  while (!section.querySelector(".chart[data-drawn]")) await laidOut(page);
  const {chart} = section.querySelector(".chart"), [x, y] = chart.rows[0];
  seen.bands = chart.series.filter((one) => one.low && one.high).length;
  const box = chart.graph.canvas_.getBoundingClientRect();
  const place = {clientX: box.left + chart.graph.toDomXCoord(x), clientY: box.top + chart.graph.toDomYCoord(y) + 2};
  chart.graph.canvas_.dispatchEvent(new page.MouseEvent("mousemove", {bubbles: true, cancelable: true, view: page, ...place}));
  seen.tip = chart.values[0].textContent;
  section.querySelector(".plot").dispatchEvent(new page.KeyboardEvent("keydown", {key: "ArrowRight", bubbles: true, cancelable: true}));
  seen.byKey = chart.values[0].textContent;
  seen.ofTable = section.querySelector(".candidates td[title]").title;
  seen.command = Array.from(dom.querySelectorAll("#this-machine code"), (code) => code.textContent).pop();

  seen.unnamed = Array.from(dom.querySelectorAll(".scroll, nav")).filter((e) =>
    !(e.getAttribute("aria-label") || e.getAttribute("aria-hidden"))).length;
  seen.anchors = Array.from(dom.querySelectorAll("a[href^='#']")).filter((a) =>
    !dom.getElementById(a.getAttribute("href").slice(1))).length;
  seen.overflow = [];
  seen.letters = [];
  for (const width of [390, 1440]) {
    frame.style.width = width + "px";
    await laidOut(page);
    seen.overflow.push(dom.scrollingElement.scrollWidth - dom.scrollingElement.clientWidth);
    seen.letters.push(...Array.from(section.querySelectorAll(".dygraph-axis-label"), (one) => parseFloat(page.getComputedStyle(one).fontSize)));
  }
}
"""


def make_study(bin_folder, folder, *vary):
    options = [option for key in vary for option in ("--vary", key)]
    subprocess.run([bin_folder / "breakwater", "sweep", "motor_estimation", "--case", "idob,kfd",
                    *options, "--seeds", "1..3", "--duration", "0.2", "--quiet", "--out", folder],
                   check=True)
    return (folder / "report.html").read_bytes()


def look_at(report, folder):
    folder.mkdir()
    seen = read(LOOK, {"report": report}, folder, ["--window-size=1500,1000"])
    print(json.dumps(seen, indent=1))
    return seen


def check(seen, study):
    assert seen["metrics"] > 1, seen
    for tip in (seen["tip"], seen["byKey"]):
        assert all(word in tip for word in (" to ", " runs", ", run ")), seen
    assert seen["tip"] != seen["byKey"], seen
    assert seen["command"] == f"breakwater sweep {study} --replay POINT", seen["command"]
    assert seen["unnamed"] == 0 and seen["anchors"] == 0, seen
    assert seen["overflow"] == [0, 0], seen["overflow"]
    assert min(seen["letters"]) > 9.0, "letters on a phone are too small"


def replay(bin_folder, command, *points):
    """The command on the page repeats the runs that a chart and tables name."""
    words = command.split()
    for point in points:
        subprocess.run([bin_folder / words[0], *words[1:-1], point, "--quiet"], check=True)
        assert (pathlib.Path(words[2]) / "runs" / point / "log.h5").exists()


def test(bin_folder, folder):
    one = make_study(bin_folder, folder / "one", "encoder.bits=6,8,10")
    seen = look_at(one, folder / "browser-one")
    assert seen["bands"] == 2, seen["bands"]
    check(seen, folder / "one")
    replay(bin_folder, seen["command"], seen["tip"].split()[-1], seen["ofTable"])
    two = make_study(bin_folder, folder / "two", "encoder.bits=6,8",
                     "physics.timestep_s=0.0005,0.001")
    seen = look_at(two, folder / "browser-two")
    check(seen, folder / "two")


if __name__ == "__main__":
    run(test)
