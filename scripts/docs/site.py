#!/usr/bin/python3
"""site.py [--serve]: the documentation as a site in build/site, without any other host.

Slow parts are stored in build/docs. The runs of the gallery, their videos and replays stay until the
program or gallery.toml changes, Doxygen's pages until a header changes.
"""

import argparse
import concurrent.futures
import functools
import hashlib
import http.server
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import time
import tomllib

from markdown_pages import ROOT

HERE = pathlib.Path(__file__).resolve().parent
WORK = ROOT / "build/docs"
SITE = ROOT / "build/site"
BREAKWATER = ROOT / "build/bin/breakwater"


def digest(*parts):
    total = hashlib.sha256()
    for part in parts:
        total.update(part if isinstance(part, bytes) else part.read_bytes())
    return total.hexdigest()


def run(*command):
    done = subprocess.run([str(word) for word in command], cwd=ROOT, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0:
        sys.exit(f"{shlex.join(str(word) for word in command)}: exit status {done.returncode}\n{done.stdout}")


def draw(exhibit, program):
    """Make the missing runs of an exhibit and their pictures."""
    folder = WORK / "gallery" / exhibit["name"]
    made = {"made_of": digest(json.dumps(exhibit, sort_keys=True).encode(), program.encode())}
    stamp = folder / "made.json"
    if stamp.exists() and json.loads(stamp.read_text()) == made:
        return
    print(f"  {exhibit['title']}", flush=True)
    shutil.rmtree(folder, ignore_errors=True)
    for number, command in enumerate(exhibit["runs"]):
        words = shlex.split(command)
        run(BREAKWATER, *words[1:], "--quiet", "--out", folder / "runs" / str(number))
    runs = sorted(path.parent for path in (folder / "runs").rglob("manifest.json"))
    run(BREAKWATER, "video", *runs, "--size", "960x540", "--out", folder / "video.mp4")
    run(BREAKWATER, "replay", *runs, "--out", folder / "replay.html")
    # The picture before the video plays.
    run(BREAKWATER, "still", *runs[:1], "--at", exhibit["at_s"], "--size", "960x540",
        "--out", folder / "still.png")
    stamp.write_text(json.dumps(made))


def gallery():
    if not BREAKWATER.exists():
        print("  there is no build/bin/breakwater (./dev build): the gallery shows what was kept")
        return
    program = digest(BREAKWATER)
    exhibits = tomllib.loads((HERE / "gallery.toml").read_text(encoding="utf-8"))["exhibit"]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda exhibit: draw(exhibit, program), exhibits))


def reference():
    shutil.rmtree(WORK / "reference", ignore_errors=True)
    if not BREAKWATER.exists():
        print("  there is no build/bin/breakwater (./dev build): the site has no pages of commands and scenarios")
        return
    run(BREAKWATER, "reference", "--out", WORK / "reference")


def headers():
    include = WORK / "include"
    include.mkdir(parents=True, exist_ok=True)
    link = include / "breakwater"
    if not link.is_symlink():
        link.symlink_to(ROOT / "src")
    sources = sorted((ROOT / "src").rglob("*.h"))
    made = digest(HERE / "Doxyfile", HERE / "equations.awk", HERE / "headers.md", *sources) + "\n"
    stamp = WORK / "api.made"
    if stamp.exists() and stamp.read_text() == made:
        return
    shutil.rmtree(WORK / "api", ignore_errors=True)
    run("doxygen", HERE / "Doxyfile")
    stamp.write_text(made)


def step(what, work):
    start = time.monotonic()
    print(what, flush=True)
    work()
    print(f"  {time.monotonic() - start:.1f} s")


def serve():
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=SITE)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 8000), handler) as server:
        print("http://127.0.0.1:8000 (Ctrl-C ends it)", flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            pass


def main():
    parser = argparse.ArgumentParser(prog="./dev docs", description="The documentation as a site.")
    parser.add_argument("--serve", action="store_true", help="then show it at http://127.0.0.1:8000")
    parser.add_argument("--no-gallery", action="store_true", help="make no runs: what was kept")
    options = parser.parse_args()
    if not options.no_gallery:
        step("the gallery's runs", gallery)
    step("the reference, by the program", reference)
    step("the headers, by Doxygen", headers)
    step("the pages, by mkdocs", lambda: run("mkdocs", "build", "--strict", "--quiet",
                                             "--config-file", HERE / "mkdocs.yml"))
    print(f"{SITE / 'index.html'}")
    if options.serve:
        serve()


if __name__ == "__main__":
    main()
