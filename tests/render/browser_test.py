"""A video of a run plays in Chromium, to its end and at its size, and shows a picture.

A page that plays the video is served on this machine alone; Chromium opens it without a window, and
the page reports back what it saw.

Usage: browser_test.py BUILD_BIN_FOLDER
"""

import http.server
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading

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

TIMEOUT_S = 100


def make_video(bin_folder, folder):
    run = folder / "run"
    subprocess.run([bin_folder / "arm_push", "--quiet", "--duration", "1.5", "--out", run],
                   check=True)
    subprocess.run([bin_folder / "breakwater", "video", run, "--size", "640x360", "--from", "0",
                    "--to", "1.5", "--speed", "1", "--quiet"], check=True)
    return (run / "video.mp4").read_bytes()


def play(video, folder):
    done = threading.Event()
    seen = {}

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            body, kind = PAGE.encode(), "text/html"
            if self.path == "/video.mp4":
                body, kind = video, "video/mp4"
            elif self.path != "/":
                body = b""
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def do_POST(self):
            seen.update(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(200)
            self.end_headers()
            done.set()

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    log = open(folder / "chromium.log", "w+")
    browser = subprocess.Popen(
        ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
         "--no-first-run", "--mute-audio", "--autoplay-policy=no-user-gesture-required",
         f"--user-data-dir={folder / 'profile'}", "--remote-debugging-port=0",
         f"http://127.0.0.1:{server.server_port}/"],
        stdout=log, stderr=log)
    reported = done.wait(TIMEOUT_S)
    browser.terminate()
    try:
        browser.wait(10)
    except subprocess.TimeoutExpired:
        browser.kill()
        browser.wait()
    server.shutdown()
    if not reported:
        log.seek(0)
        sys.exit("the page did not report:\n" + log.read()[-3000:])
    return seen


def main():
    bin_folder = pathlib.Path(sys.argv[1]).resolve()
    if shutil.which("chromium") is None:
        sys.exit("there is no chromium (packages/test.txt)")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        seen = play(make_video(bin_folder, folder), folder)
    print(seen)
    assert "error" not in seen, seen
    assert (seen["width"], seen["height"]) == (640, 360), seen
    assert abs(seen["duration"] - 1.5) < 1 / 30, seen
    assert abs(seen["time"] - 1.5) < 1 / 30, seen
    assert seen["colours"] > 30, seen


if __name__ == "__main__":
    main()
