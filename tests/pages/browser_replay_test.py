"""A replay works in Chromium with software WebGL, and shows what the stills show.

The test replays short runs of the arm and the quadrotor. One model is outside the tree and has a
mesh. A local page uses the replays like a reader and reports its observations and pixels.

Usage: browser_replay_test.py BUILD_BIN_FOLDER
"""

import base64
import io
import json
import pathlib
import re
import subprocess
import sys

import matplotlib.image
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import chromium  # noqa: E402

TREE = pathlib.Path(__file__).resolve().parents[2]
SIZE = (640, 360)  # size of the pictures that are compared with stills
TIMES_S = (1.0, 4.5, 5.4)  # before contact, since a still has a number beside an arrow

# Contact at about 5.5 s.
SHORT_WALL = ["--duration", "6", "--set", "wall.solid_from_s=4", "force.from_s=5",
              "metrics.from_s=5.5", "metrics.to_s=6", "record.fine_from_s=5", "record.fine_to_s=6"]

MESH = ('<mesh name="blade" vertex="0 -0.03 -0.02  0 0.03 -0.02  0 0 0.04  '
        '0.16 -0.008 -0.008  0.16 0.008 -0.008  0.16 0 0.012"/>')

LOOK = """
seen.pages = {};
const TIMES = %(times)s;

async function replay(name, width, height) {
  const begin = performance.now(), {frame, page, dom} = await open(name, width, height);
  const box = dom.querySelector(".replay");
  await until("the first picture of " + name, () => box.dataset.state !== "waiting");
  if (box.dataset.state !== "ready") throw new Error(box.textContent.slice(-200));
  return {frame, page, dom, box, view: box.replay, firstMs: performance.now() - begin};
}

// The best drawing of that time, in the size of the stills.
function shot(view, time) {
  Object.assign(view.picture.style, {width: "%(width)dpx", height: "%(height)dpx", aspectRatio: "auto"});
  view.resize();
  view.seek(time);
  view.draw(true);
  return view.canvas.toDataURL("image/png").split(",")[1];
}

// The least time of several frames: the looks take turns, so that the load of the machine meets both.
function frameMs(view) {
  const gl = view.renderer.getContext(), pixel = new Uint8Array(4);
  const least = {full: Infinity, fast: Infinity};
  for (let turn = 0; turn < 8; ++turn) {
    for (const look of ["full", "fast"]) {
      const begin = performance.now();
      view.draw(look === "full");
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      if (turn > 0) least[look] = Math.min(least[look], performance.now() - begin);
    }
  }
  return least;
}

async function look() {
  for (const name of ["green", "mesh"]) {
    const {view, firstMs} = await replay(name, 1320, 1000);
    seen.pages[name] = {firstMs, shots: TIMES.map((time) => shot(view, time))};
  }

  // Slider, chart and scene show the same time if one of them moves.
  const {page, dom, view, box} = await replay("wall", 1320, 1000);
  const chart = dom.querySelector(".chart").chart;
  const trueAt = (time) => chart.at(time, 1);
  const force = () => view.stage.actors[0].arrows[0].value;
  view.slider.value = "5.6";
  view.slider.dispatchEvent(new page.Event("input", {bubbles: true}));
  seen.afterSlider = {view: view.time, chart: chart.group.time, cursor: parseFloat(chart.cursor.style.left) - chart.graph.toDomXCoord(5.6),
                      force: force(), charted: trueAt(5.6),
                      label: (view.draw(), dom.querySelector(".force").textContent)};
  const canvas = chart.graph.canvas_, plot = canvas.getBoundingClientRect();
  for (const type of ["mousemove", "mousedown", "mouseup"]) {
    canvas.dispatchEvent(new page.MouseEvent(type, {bubbles: true, cancelable: true, view: page,
      clientX: plot.left + chart.graph.toDomXCoord(5.93), clientY: plot.top + 20}));
  }
  seen.afterChart = {view: view.time, slider: Number(view.slider.value), force: force(), charted: trueAt(view.time)};
  const key = (name) => box.dispatchEvent(new page.KeyboardEvent("keydown", {key: name, bubbles: true}));
  const before = view.time;
  key(",");
  seen.stepBack = before - view.time;
  key("a");
  seen.hidesForces = !view.stage.showsForces;
  key("a");
  key("2");
  seen.camera = view.cameraChoice.selectedOptions[0].textContent;
  view.seek(1, true);
  key(" ");
  await until("it plays", () => view.time > 1);
  // Space counts wherever the focus is.
  dom.querySelector("h1").dispatchEvent(new page.KeyboardEvent("keydown", {key: " ", bubbles: true}));
  seen.played = view.time - 1;
  seen.isPaused = !view.isPlaying;

  // A drag takes control of the camera and turns it.
  key("0");
  view.draw();
  const from = view.camera.position.clone();
  const mouse = (kind, x, y) => (kind === "mousedown" ? view.canvas : dom).dispatchEvent(new page.MouseEvent(kind,
    {bubbles: true, cancelable: true, view: page, button: 0, clientX: x, clientY: y}));
  mouse("mousedown", 400, 300);
  mouse("mousemove", 480, 320);
  mouse("mouseup", 480, 320);
  view.draw();
  seen.turned = from.distanceTo(view.camera.position);
  seen.afterDrag = view.cameraChoice.value;

  // One finger turns the view. Two fingers that move apart zoom in.
  view.useCamera(view.data.camera);
  view.draw();
  const finger = (identifier, x, y) => new page.Touch({identifier, target: view.canvas, clientX: x, clientY: y, pageX: x, pageY: y});
  const touch = (kind, ...touches) => view.canvas.dispatchEvent(new page.TouchEvent(kind,
    {bubbles: true, cancelable: true, touches, targetTouches: touches, changedTouches: touches}));
  const distance = () => view.camera.position.distanceTo(view.orbit.target);
  const start = view.camera.position.clone();
  touch("touchstart", finger(1, 400, 300));
  touch("touchmove", finger(1, 480, 320));
  touch("touchend");
  view.draw();
  seen.turnedByTouch = start.distanceTo(view.camera.position);
  const far = distance();
  touch("touchstart", finger(1, 400, 300), finger(2, 440, 300));
  touch("touchmove", finger(1, 340, 300), finger(2, 500, 300));
  touch("touchend");
  view.draw();
  seen.nearerByPinch = far / distance();
  view.useCamera(view.data.camera);
  seen.unnamed = Array.from(box.querySelectorAll("button, select, input, canvas")).filter((e) =>
    !(e.getAttribute("aria-label") || e.textContent.trim() || e.closest("label"))).length;

  // Phone width.
  const phone = await replay("wall", 390, 800);
  seen.phone = {overflow: phone.dom.scrollingElement.scrollWidth - 390, canvas: phone.view.canvas.clientWidth};

  // Two runs in one scene.
  const both = await replay("both", 1320, 1000);
  seen.both = {runs: both.view.runLabels.map((label) => label.textContent), actors: both.view.stage.actors.length};

  // The time of a frame with shadows and water.
  const sea = await replay("sea", 1320, 1000);
  Object.assign(sea.view.picture.style, {width: "1280px", height: "720px", aspectRatio: "auto"});
  sea.view.resize();
  seen.sea = {frameMs: frameMs(sea.view), shadowsInFast: sea.view.renderer.shadowMap.enabled, firstMs: sea.firstMs};

  // Hostile names are text.
  const hostile = await replay("hostile", 1320, 1000);
  seen.hostile = {pwned: hostile.page.pwned === true, text: hostile.view.runLabels[0].textContent,
                  cameras: Array.from(hostile.view.cameraChoice.options, (o) => o.textContent).join("|"),
                  moments: Array.from(hostile.dom.querySelectorAll(".moment"), (m) => m.title).join("|")};

  // Without WebGL the page shows a strip and the reason.
  const refused = (await open("nowebgl", 1000, 800)).dom.querySelector(".replay");
  await until("the refusal", () => refused.dataset.state === "refused");
  const strip = refused.querySelector(".fallback");
  seen.refused = {text: refused.querySelector(".refusal").textContent, strip: strip.naturalWidth, shown: strip.clientWidth};
}
""" % {"times": json.dumps(TIMES_S), "width": SIZE[0], "height": SIZE[1]}


def variants(folder):
    """Models outside the tree on a green table, which separates the plant from the background; one
    has a mesh."""
    arm = (TREE / "models/arm.xml").read_text()
    table = 'rgb1="0.80 0.81 0.82" rgb2="0.74 0.75 0.77"'
    link = '<geom name="link3" class="link" fromto="0 0 0 0.16 0 0"/>'
    assert table in arm and link in arm
    green = arm.replace(table, 'rgb1="0 0.6 0" rgb2="0 0.5 0"').replace("0.68 0.69 0.71", "0 0.4 0")
    blade = '<geom name="link3" type="mesh" mesh="blade" mass="0" material="link"/>'
    meshed = green.replace("<asset>", "<asset>" + MESH).replace(link, blade)
    files = {}
    for name, text in (("green", green), ("mesh", meshed)):
        files[name] = folder / (name + ".xml")
        files[name].write_text(text)
    return files


def run(*words):
    subprocess.run([str(word) for word in words], check=True)


def hostile_run(bin_folder, folder):
    """A run of a model whose camera, geoms and folder have names that could break the page."""
    evil = '&lt;/script&gt;&lt;script&gt;window.pwned=true&lt;/script&gt;&quot;&apos;'
    arm = (TREE / "models/arm.xml").read_text()
    model = folder / "hostile.xml"
    model.write_text(arm.replace('name="top"', f'name="{evil}"').replace('name="wall_foot"', f'name="wall_{evil}"'))
    home = folder / "<script>window.pwned=true<"
    run(bin_folder / "breakwater", "run", "arm_push", "--quiet", "--duration", "0.4", "--set",
        f"model.mjcf={model}", "--out", home)
    return home


def make(bin_folder, folder):
    breakwater = bin_folder / "breakwater"
    files = variants(folder)
    run(breakwater, "run", "arm_wall_contact", "--quiet", "--case", "proposed-2N", *SHORT_WALL,
        "--out", folder / "wall")
    for name, file in files.items():
        run(breakwater, "run", "arm_wall_contact", "--quiet", "--case", "proposed-2N", *SHORT_WALL,
            f"model.mjcf={file}", "--out", folder / name)
    run(breakwater, "run", "quadrotor_waves", "--quiet", "--duration", "20", "--set",
        "metrics.window_s=5", "--out", folder / "sea")
    pages = {}
    for name in ("wall", "sea", *files):
        # The stills' camera, which is not that of pages.
        camera = [] if name == "sea" else ["--camera", "front"]
        run(breakwater, "replay", folder / name, "--quiet", *camera)
        pages[name] = (folder / name / "replay.html").read_text()
    run(breakwater, "replay", folder / "wall", folder / "mesh", "--quiet", "--out", folder / "both.html")
    pages["both"] = (folder / "both.html").read_text()
    home = hostile_run(bin_folder, folder)
    run(breakwater, "replay", home, home, "--quiet", "--out", folder / "hostile.html")
    pages["hostile"] = (folder / "hostile.html").read_text()
    # The same page in a browser without WebGL.
    pages["nowebgl"] = pages["wall"].replace(
        "<head>", '<head><script>HTMLCanvasElement.prototype.getContext = ((get) => function (kind, ...rest) {'
        ' return kind.startsWith("webgl") ? null : get.call(this, kind, ...rest); })(HTMLCanvasElement.prototype.getContext);'
        "</script>", 1)
    stills = {}
    for name in files:
        stills[name] = []
        for time in TIMES_S:
            file = folder / f"{name}-{time}.png"
            run(breakwater, "still", folder / name, "--at", time, "--size", f"{SIZE[0]}x{SIZE[1]}",
                "--look", "full", "--quiet", "--out", file)
            stills[name].append(matplotlib.image.imread(file)[:, :, :3])
    return pages, stills


def shrunk(shot):
    """A picture with two by two samples per pixel, as for a paused replay."""
    image = matplotlib.image.imread(io.BytesIO(base64.b64decode(shot)))[:, :, :3]
    assert image.shape[:2] == (2 * SIZE[1], 2 * SIZE[0]), image.shape
    return image.reshape(SIZE[1], 2, SIZE[0], 2, 3).mean(axis=(1, 3))


def overlap(a, b):
    """Intersection over union of the pixels that are not green, outside the still's texts and
    chart."""
    def silhouette(image):
        part = image[int(0.40 * SIZE[1]):int(0.92 * SIZE[1])]
        return part[:, :, 1] < 1.2 * numpy.maximum(part[:, :, 0], part[:, :, 2])
    first, second = silhouette(a), silhouette(b)
    assert 3000 < second.sum() < 0.5 * second.size, second.sum()
    return (first & second).sum() / (first | second).sum()


def test(bin_folder, folder):
    pages, stills = make(bin_folder, folder)
    # No name is resolved, so only this machine is reachable.
    seen = chromium.read(LOOK, {name: page.encode() for name, page in pages.items()}, folder,
                         ["--window-size=1400,1100", "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"])
    drawn = {name: [shrunk(shot) for shot in page.pop("shots", [])] for name, page in seen["pages"].items()}
    print(json.dumps(seen, indent=1))

    for name in ("green", "mesh"):
        assert len(drawn[name]) == len(TIMES_S), name
        for time, shot, still in zip(TIMES_S, drawn[name], stills[name]):
            share = overlap(shot, still)
            print(f"silhouettes of {name} at {time} s: {100 * share:.1f} %")
            assert share >= 0.95, (name, time, share)

    for name, page in pages.items():
        assert len(page) < 1e6, (name, len(page))
        sources = re.findall(r"""(?:src|href|action|poster)\s*=\s*["']([^"']*)""",
                             re.sub(r"<script.*?</script>", "", page, flags=re.S))
        assert all(s.startswith(("#", "data:")) for s in sources), sources
    slider, chart = seen["afterSlider"], seen["afterChart"]
    assert abs(slider["view"] - 5.6) < 1e-9 and abs(slider["chart"] - 5.6) < 1e-9, slider
    assert abs(slider["cursor"]) < 0.01, slider
    assert slider["force"] > 7.0 and abs(slider["force"] - slider["charted"]) < 0.2, slider
    assert slider["label"] == f"{slider['force']:.1f} N", slider
    assert abs(chart["view"] - 5.93) < 0.01 and abs(chart["slider"] - chart["view"]) < 1e-6, chart
    assert chart["force"] > 2.0 and abs(chart["force"] - chart["charted"]) < 0.2, chart
    assert 1e-4 < seen["stepBack"] < 1 / 29 and seen["hidesForces"], seen
    assert seen["camera"] == "top" and seen["played"] > 0 and seen["isPaused"], seen
    assert seen["turned"] > 0.05 and seen["afterDrag"] == "free" and seen["unnamed"] == 0, seen
    assert seen["turnedByTouch"] > 0.05 and seen["nearerByPinch"] > 1.5, seen
    assert seen["phone"]["overflow"] <= 0 and 300 < seen["phone"]["canvas"] <= 390, seen["phone"]
    assert seen["both"]["actors"] == 2, seen["both"]
    assert "model.mjcf" in seen["both"]["runs"][0], seen["both"]
    # A loaded machine has no fixed frame rate; docs/how-to/pictures-and-videos.md has the rates.
    assert not seen["sea"]["shadowsInFast"], seen["sea"]
    assert 0 < seen["sea"]["frameMs"]["fast"] < seen["sea"]["frameMs"]["full"], seen["sea"]
    assert not seen["hostile"]["pwned"], seen["hostile"]
    assert "<script>window.pwned" in seen["hostile"]["text"] + seen["hostile"]["cameras"], seen["hostile"]
    assert "WebGL" in seen["refused"]["text"] and seen["refused"]["strip"] > 400, seen["refused"]
    assert seen["refused"]["shown"] > 400, seen["refused"]


if __name__ == "__main__":
    chromium.run(test)
