"""A report works in Chromium: charts, hover, zoom, narrow and wide, without any request.

The test makes a small report and serves it locally, in a frame of a page. The page uses the report
like a reader and reports its observations.

Usage: browser_report_test.py BUILD_BIN_FOLDER
"""

import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from chromium import read, run  # noqa: E402

EXPERIMENTS = pathlib.Path(__file__).with_name("browser_report.toml")

LOOK = """
async function look() {
  const {frame, page, dom} = await open("report", 1440, 900);
  const boxes = Array.from(dom.querySelectorAll(".chart"));
  seen.charts = boxes.length;

  // The first charts are there as soon as the page is unpacked, for a plain screenshot and for print.
  await until("the first charts", () => boxes.every((box) => box.chart));
  for (const box of boxes) {
    box.scrollIntoView({block: "center", behavior: "instant"});
    await until("chart " + box.dataset.chart, () => box.chart);
  }
  seen.inked = boxes.every((box) => {
    const canvas = box.querySelector("canvas");
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    let ink = 0;
    for (let i = 3; i < pixels.length; i += 4) ink += pixels[i] > 0 ? 1 : 0;
    return ink > 500;
  });

  // Mouse events of the page.
  const mouse = (box, kind, part) => {
    const canvas = box.chart.graph.mouseEventElement_;
    const area = box.chart.graph.getArea(), at = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new page.MouseEvent(kind, {bubbles: true, cancelable: true, view: page, button: 0,
      clientX: at.left + area.x + part * area.w, clientY: at.top + area.y + area.h / 2}));
  };
  const values = (box) => Array.from(box.querySelectorAll(".value"), (v) => v.textContent);
  const find = (id) => boxes.find((box) => box.dataset.chart === id);
  const motor = find("figure-4-32-1"), other = find("figure-4-34-1");
  motor.scrollIntoView({block: "center", behavior: "instant"});
  mouse(motor, "mousemove", 0.5);
  await laidOut(page);
  seen.hover = values(motor);
  seen.hoverElsewhere = values(other);
  seen.clock = motor.querySelector(".time").textContent;

  // A zoom of one chart zooms its section only.
  const arm = find("figure-2-50-1"), before = arm.chart.graph.xAxisRange();
  mouse(motor, "mousedown", 0.25);
  mouse(motor, "mousemove", 0.4);
  mouse(motor, "mousemove", 0.5);
  mouse(motor, "mouseup", 0.5);
  await laidOut(page);
  seen.zoomed = motor.chart.graph.xAxisRange();
  seen.linked = other.chart.graph.xAxisRange();
  seen.unlinked = String(before) === String(arm.chart.graph.xAxisRange());
  motor.querySelector(".plot").dispatchEvent(new page.KeyboardEvent("keydown", {key: "0", bubbles: true}));
  await laidOut(page);
  seen.reset = other.chart.graph.xAxisRange();

  // The button of a signal.
  const key = motor.querySelector(".key");
  key.click();
  seen.pressed = key.getAttribute("aria-pressed");
  seen.visible = motor.chart.graph.visibility();

  seen.closeUp = find("figure-2-50-3").chart.graph.xAxisRange();

  // Texts for screen readers, and access by keyboard.
  seen.unnamed = Array.from(dom.querySelectorAll("img, .plot, .scroll, nav")).filter((e) =>
    !(e.getAttribute("alt") || e.getAttribute("aria-label"))).length;
  seen.unreachable = Array.from(dom.querySelectorAll(".plot, .scroll, .key, pre, summary, a[href]")).filter((e) => e.tabIndex < 0).length;
  seen.broken = Array.from(dom.querySelectorAll("img")).filter((i) => i.complete && !i.naturalWidth).length;
  seen.anchors = Array.from(dom.querySelectorAll("a[href^='#']")).filter((a) =>
    !dom.getElementById(a.getAttribute("href").slice(1))).map((a) => a.getAttribute("href"));

  seen.overflow = {};
  for (const width of [390, 1440]) {
    frame.style.width = width + "px";
    await laidOut(page);
    seen.overflow[width] = dom.scrollingElement.scrollWidth - dom.scrollingElement.clientWidth;
    seen["chart" + width] = arm.querySelector("canvas").getBoundingClientRect().width;
  }
}
"""


def make_report(bin_folder, folder):
    subprocess.run([bin_folder / "breakwater", "reproduce", "--quiet", "--experiments", EXPERIMENTS,
                    "--out", folder / "out"], check=True)
    return (folder / "out" / "report.html").read_bytes()


def printed_canvases(folder):
    """The number of pictures on paper: Chromium prints each non-empty canvas as a picture."""
    paper = folder / "paper.pdf"
    subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                    f"--user-data-dir={folder / 'printer'}", "--virtual-time-budget=20000",
                    f"--print-to-pdf={paper}", (folder / "out" / "report.html").as_uri()],
                   check=True, capture_output=True)
    return paper.read_bytes().count(b"/Subtype /Image")


def test(bin_folder, folder):
    report = make_report(bin_folder, folder)
    seen = read(LOOK, {"report": report}, folder, ["--window-size=1500,1000"])
    seen["printed"] = printed_canvases(folder)
    print(json.dumps(seen, indent=1))

    html = report.decode()
    sources = re.findall(r"""(?:src|href|action|poster)\s*=\s*["']([^"']*)""", re.sub(r"<script.*?</script>", "", html, flags=re.S))
    assert sources and all(s.startswith(("#", "data:")) for s in sources), sources

    assert seen["charts"] == 5 and seen["inked"], seen
    assert seen["printed"] >= seen["charts"], seen
    assert all(re.fullmatch(r"-?[\d.e+-]+", value) for value in seen["hover"]), seen["hover"]
    assert re.fullmatch(r"t = [\d.]+ s", seen["clock"]), seen["clock"]
    assert any(seen["hoverElsewhere"]), seen
    low, high = seen["zoomed"]
    assert 2.0 < low < 3.0 and 4.5 < high < 5.5, seen["zoomed"]
    assert seen["linked"] == seen["zoomed"] and seen["unlinked"], seen
    assert seen["reset"][0] < 0.1 and seen["reset"][1] > 9.9, seen["reset"]
    assert seen["pressed"] == "false" and seen["visible"] == [False, True], seen

    assert 0.45 < seen["closeUp"][0] and seen["closeUp"][1] < 1.05, seen["closeUp"]

    assert seen["unnamed"] == 0 and seen["unreachable"] == 0 and seen["broken"] == 0, seen
    assert seen["anchors"] == [], seen["anchors"]
    assert seen["overflow"] == {"390": 0, "1440": 0}, seen["overflow"]
    assert 250 < seen["chart390"] < 390 < seen["chart1440"], seen


if __name__ == "__main__":
    run(test)
