"""Opens a page in Chromium without a window. The page reports its observations.

Pages are served locally. A page reports by POSTing JSON.
"""

import http.server
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading

# For a page that looks at others: faint(document) names the texts that are hard to read.
CONTRAST = r"""
function rgba(text) {
  const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number);
  return [r, g, b, a];
}
const over = (top, below) => [0, 1, 2].map((i) => top[i] * top[3] + below[i] * (1 - top[3])).concat(1);
const luminance = (c) => {
  const [r, g, b] = c.map((v) => (v /= 255) <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4);
  return .2126 * r + .7152 * g + .0722 * b;
};
// Text that is not as far from its background as WCAG 2.1 AA wants: 4.5, large text 3.
function faint(page) {
  const found = {}, view = page.defaultView;
  for (const place of page.body.querySelectorAll("*")) {
    if (![...place.childNodes].some((child) => child.nodeType === 3 && child.data.trim())) continue;
    if (!place.getClientRects().length || place.closest("svg, [aria-hidden], [hidden], .headerlink, .katex-mathml, script, style")) continue;
    const style = view.getComputedStyle(place);
    if (style.visibility !== "visible") continue;
    const layers = [];
    let opacity = 1, hidden = false;
    for (let at = place; at; at = at.parentElement) {
      const look = view.getComputedStyle(at);
      layers.push(rgba(look.backgroundColor));
      opacity *= +look.opacity;
    }
    if (opacity < .05) continue;
    let below = [255, 255, 255, 1];
    for (const layer of layers.reverse()) below = over(layer, below);
    const colour = rgba(style.color);
    const text = over([colour[0], colour[1], colour[2], colour[3] * opacity], below);
    const [light, dark] = [luminance(text), luminance(below)].sort((a, b) => b - a);
    const ratio = (light + .05) / (dark + .05), size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && +style.fontWeight >= 700);
    if (ratio < (large ? 3 : 4.5)) {
      found[`${place.tagName.toLowerCase()}.${place.className} in ${place.parentElement.className}`] =
          `${ratio.toFixed(2)}: ${place.textContent.trim().slice(0, 30)}`;
    }
  }
  return found;
}
"""

# A page that looks at others by its function look(), and reports `seen`.
READER = """<!doctype html><body style="margin:0"><script>
"use strict";
const seen = {errors: []};
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const until = async (what, test) => {
  for (;;) { const value = test(); if (value) return value; await wait(25); }
};
// Until what has changed is laid out and drawn.
const laidOut = (page) => new Promise((done) => page.requestAnimationFrame(() => page.requestAnimationFrame(done)));
// A page in a frame, alone.
async function open(name, width, height) {
  const frame = document.createElement("iframe");
  frame.style.cssText = `border:0;width:${width}px;height:${height}px`;
  frame.src = name + ".html";
  document.body.replaceChildren(frame);
  await new Promise((done) => frame.addEventListener("load", done, {once: true}));
  const page = frame.contentWindow, dom = frame.contentDocument;
  page.addEventListener("error", (e) => seen.errors.push(e.message));
  dom.addEventListener("securitypolicyviolation", (e) => seen.errors.push("asked for " + e.blockedURI));
  return {frame, page, dom};
}
LOOK
look().catch((e) => seen.errors.push(String(e.stack))).then(() => fetch("/seen", {method: "POST", body: JSON.stringify(seen)}));
</script>"""
SOFTWARE_GL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]

HANGS_S = 900  # no page takes as long, even on a machine with much other work


def visit(pages, folder, flags):
    """Opens "/" of `pages` (path: (bytes, content type)).

    Returns the page's report, Chromium's log, and the requested paths.
    """
    if shutil.which("chromium") is None:
        sys.exit("there is no chromium (cmake/packages/test.txt)")
    done = threading.Event()
    seen = {}
    asked = []

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            asked.append(self.path)
            body, kind = pages.get(self.path, (b"", "text/html"))
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

    class Server(http.server.ThreadingHTTPServer):
        request_queue_size = 128  # the default of five refuses some requests of a page with many files

    server = Server(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with open(folder / "chromium.log", "w+") as log:
        browser = subprocess.Popen(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--no-first-run", "--mute-audio", *flags, f"--user-data-dir={folder / 'profile'}",
             "--remote-debugging-port=0", f"http://127.0.0.1:{server.server_port}/"],
            stdout=log, stderr=log)
        reported = done.wait(HANGS_S)
        browser.terminate()
        try:
            browser.wait(10)
        except subprocess.TimeoutExpired:
            browser.kill()
            browser.wait()
        server.shutdown()
        server.server_close()
        log.seek(0)
        text = log.read()
    if not reported:
        sys.exit("the page did not report:\n" + text[-3000:])
    return seen, text, asked


def read(look, pages, folder, flags):
    """The report of the script `look` on `pages` (name: HTML), which ask for nothing and log nothing."""
    html = "text/html; charset=utf-8"
    served = {f"/{name}.html": (page, html) for name, page in pages.items()}
    served["/"] = (READER.replace("LOOK", look).encode(), html)
    seen, log, asked = visit(served, folder, [*SOFTWARE_GL, "--enable-logging=stderr", *flags])
    assert seen["errors"] == [], seen["errors"]
    console = [line for line in log.splitlines() if "CONSOLE" in line and "GPU stall" not in line]
    assert console == [], console
    assert sorted(set(asked) - {"/favicon.ico"}) == sorted(served), asked
    return seen


def run(test):
    """Calls a test with the folder of the programs, the first argument, and one of its own."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        test(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(folder))
