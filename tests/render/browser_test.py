"""A video of a run plays in Chromium, to its end and at its size, and shows a picture.

The video's page is served locally. Chromium opens it without a window, and the page reports its observations.

Usage: browser_test.py BUILD_BIN_FOLDER
"""

import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from chromium import run, visit  # noqa: E402

PAGE = """<!doctype html><video id="v" muted playsinline src="video.mp4"></video><script>
const v = document.getElementById("v");
const report = (what) => fetch("/report", {method: "POST", body: JSON.stringify(what)});
v.onerror = () => report({error: v.error.code + " " + v.error.message});
v.onended = () => {
  const canvas = document.createElement("canvas");
  canvas.width = v.videoWidth;
  canvas.height = v.videoHeight;
  const context = canvas.getContext("2d");
  context.drawImage(v, 0, 0);
  const pixels = context.getImageData(0, 0, v.videoWidth, v.videoHeight).data;
  const colours = new Set();
  for (let i = 0; i < pixels.length; i += 4)
    colours.add(pixels[i] >> 4 << 8 | pixels[i + 1] >> 4 << 4 | pixels[i + 2] >> 4);
  report({width: v.videoWidth, height: v.videoHeight, duration: v.duration,
          time: v.currentTime, colours: colours.size});
};
v.play().catch((e) => report({error: String(e)}));
</script>"""


def make_video(bin_folder, folder):
    run = folder / "run"
    subprocess.run([bin_folder / "arm_push", "--quiet", "--duration", "1.5", "--out", run],
                   check=True)
    subprocess.run([bin_folder / "breakwater", "video", run, "--size", "640x360", "--from", "0",
                    "--to", "1.5", "--speed", "1", "--quiet"], check=True)
    return (run / "video.mp4").read_bytes()


def play(video, folder):
    pages = {"/": (PAGE.encode(), "text/html"), "/video.mp4": (video, "video/mp4")}
    return visit(pages, folder, ["--autoplay-policy=no-user-gesture-required"])[0]


def test(bin_folder, folder):
    seen = play(make_video(bin_folder, folder), folder)
    print(seen)
    assert "error" not in seen, seen
    assert (seen["width"], seen["height"]) == (640, 360), seen
    assert abs(seen["duration"] - 1.5) < 1 / 30, seen
    assert abs(seen["time"] - 1.5) < 1 / 30, seen
    assert seen["colours"] > 30, seen


if __name__ == "__main__":
    run(test)
