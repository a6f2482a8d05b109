"""Opens a page in Chromium without a window. The page reports its observations.

Pages are served locally. A page reports by POSTing JSON.
"""

import http.server
import json
import shutil
import subprocess
import sys
import threading


def visit(pages, folder, flags, timeout_s):
    """Opens "/" of `pages` (path: (bytes, content type)).

    Returns the page's report, Chromium's log, and the requested paths.
    """
    if shutil.which("chromium") is None:
        sys.exit("there is no chromium (packages/test.txt)")
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
        reported = done.wait(timeout_s)
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
