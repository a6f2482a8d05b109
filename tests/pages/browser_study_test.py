"""A study's report works in Chromium: choice of metric, commands, keyboard, narrow and wide.

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
  while (!dom.querySelector(".chooser")) await laidOut(page);
  const shown = () => Array.from(dom.querySelectorAll(".metric")).filter((s) => s.offsetParent).map((s) => s.querySelector("h2").textContent);
  const panel = dom.getElementById("chosen");
  seen.metrics = dom.querySelectorAll(".metric").length;
  seen.first = shown();
  const select = dom.querySelector(".chooser select");
  select.value = select.options[1].value;
  select.dispatchEvent(new page.Event("change"));
  seen.second = shown();
  seen.hash = page.location.hash;
  const followed = new Promise((done) => page.addEventListener("hashchange", done, {once: true}));
  page.location.hash = dom.querySelector("#metrics tbody a").getAttribute("href");
  await followed;
  seen.linked = shown();

  const section = Array.from(dom.querySelectorAll(".metric")).find((s) => s.offsetParent);
  // The first marks of a chart.
  while (!section.querySelector(".chart[data-drawn]")) await laidOut(page);
  const {chart} = section.querySelector(".chart"), [x, y] = chart.rows[0];
  seen.bands = chart.series.filter((one) => one.low && one.high).length;
  for (const type of ["mousemove", "mousedown", "mouseup"]) {
    const box = chart.graph.canvas_.getBoundingClientRect();
    const place = {clientX: box.left + chart.graph.toDomXCoord(x), clientY: box.top + chart.graph.toDomYCoord(y) + 2};
    chart.graph.canvas_.dispatchEvent(new page.MouseEvent(type, {bubbles: true, cancelable: true, view: page, ...place}));
  }
  seen.tip = chart.values[0].textContent;
  seen.panel = panel.hidden ? "" : panel.textContent;
  seen.command = panel.querySelector("code").textContent;
  dom.body.dispatchEvent(new page.KeyboardEvent("keydown", {key: "Escape", bubbles: true}));
  seen.closed = panel.hidden;
  for (const key of ["ArrowRight", "Enter"]) {
    section.querySelector(".plot").dispatchEvent(new page.KeyboardEvent("keydown", {key, bubbles: true, cancelable: true}));
  }
  seen.byKey = panel.hidden ? "" : panel.textContent;
  // A cell of a table of two keys, by keyboard.
  const cell = section.querySelector("table:not(.candidates) [data-r]");
  if (cell) cell.dispatchEvent(new page.KeyboardEvent("keydown", {key: "Enter", bubbles: true, cancelable: true}));
  seen.cell = cell ? panel.textContent : "";
  const code = section.querySelector(".candidates [data-r]");
  code.dispatchEvent(new page.MouseEvent("click", {bubbles: true}));
  seen.ofTable = [code.title, panel.querySelector("code").textContent];
  panel.querySelector(".close").click();

  seen.unnamed = Array.from(dom.querySelectorAll(".scroll, nav, select")).filter((e) =>
    !(e.getAttribute("aria-label") || e.closest("label") || e.getAttribute("aria-hidden"))).length;
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
    assert seen["metrics"] > 1 and len(seen["first"]) == 1 and len(seen["second"]) == 1, seen
    assert seen["first"] == seen["linked"] != seen["second"] and seen["hash"] == "#metric-2", seen
    assert all(word in seen["tip"] for word in (" to ", " runs")), seen["tip"]
    assert seen["tip"] in seen["panel"] and seen["closed"], seen
    assert seen["command"].startswith(f"breakwater sweep {study} --replay "), seen["command"]
    assert "--replay" in seen["byKey"], seen["byKey"]
    key, command = seen["ofTable"]
    assert command.endswith("--replay " + key), seen["ofTable"]
    assert seen["unnamed"] == 0 and seen["anchors"] == 0, seen
    assert seen["overflow"] == [0, 0], seen["overflow"]
    assert min(seen["letters"]) > 9.0, "letters on a phone are too small"


def replay(bin_folder, command):
    """The command on the page repeats the run."""
    words = command.split()
    subprocess.run([bin_folder / words[0], *words[1:], "--quiet"], check=True)
    assert (pathlib.Path(words[2]) / "runs" / words[-1] / "log.h5").exists()


def test(bin_folder, folder):
    one = make_study(bin_folder, folder / "one", "encoder.bits=6,8,10")
    seen = look_at(one, folder / "browser-one")
    assert seen["bands"] == 2, seen["bands"]
    check(seen, folder / "one")
    replay(bin_folder, seen["command"])
    two = make_study(bin_folder, folder / "two", "encoder.bits=6,8",
                     "physics.timestep_s=0.0005,0.001")
    seen = look_at(two, folder / "browser-two")
    check(seen, folder / "two")
    assert all(word in seen["cell"] for word in ("encoder.bits = ", "physics.timestep_s = ", "--replay")), seen


if __name__ == "__main__":
    run(test)
