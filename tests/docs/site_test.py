"""The site in Chromium: it asks no other host, its maths is set, and its search finds pages. Its texts have
enough contrast in light and in dark.

Usage: site_test.py WORK_FOLDER
"""

import json
import mimetypes
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from chromium import CONTRAST, visit  # noqa: E402

SKIPPED = 77
SITE = ROOT / "build/site"

DRIVER = """<!doctype html><title>driver</title>
<iframe id="frame" style="width:1300px;height:900px;border:0"></iframe>
<script>
const frame = document.getElementById("frame");
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const open = (path) => new Promise((resolve) => {
  frame.onload = () => resolve(frame.contentDocument);
  frame.src = path;
});

CONTRAST
async function look() {
  const seen = { pages: {}, requests: [], faint: {} };
  const note = () => seen.requests.push(...frame.contentWindow.performance.getEntriesByType("resource").map((r) => r.name));
  for (const path of PAGES) {
    const page = await open(path);
    seen.pages[path] = {
      errors: [...page.querySelectorAll(".katex-error")].map((e) => e.title),
      unset: [...page.querySelectorAll(".arithmatex")].filter((e) => !e.querySelector(".katex")).length,
      formulas: page.querySelectorAll(".katex").length,
      dollars: [...page.querySelectorAll(".md-content p, .md-content li, .md-content td")]
          .map((e) => { const copy = e.cloneNode(true); copy.querySelectorAll("code, .katex").forEach((c) => c.remove()); return copy.textContent; })
          .filter((text) => text.includes("$")),
      unnamed: [...page.querySelectorAll("img:not([alt]), img[alt=''], video:not([aria-label]), iframe:not([title])")].map((e) => e.outerHTML.slice(0, 80)),
      missing: [...page.images].filter((i) => i.complete && !i.naturalWidth && i.loading !== "lazy").map((i) => i.src),
      language: page.documentElement.lang,
      skip: !!page.querySelector("a.md-skip"),
    };
    note();
    if (LOOKED_AT.includes(path)) {
      for (const scheme of ["default", "slate"]) {
        page.body.dataset.mdColorScheme = scheme;
        const changes = page.getAnimations().filter((a) => a.transitionProperty);  // colours change slowly
        await Promise.all(changes.map((a) => a.finished.catch(() => {})));
        seen.faint[`${path} ${scheme}`] = faint(page);
      }
    }
  }
  const study = await open(SORTABLE);
  const column = () => [...study.querySelectorAll(".sortable tbody tr")].map((row) => +row.cells[0].textContent);
  seen.sorted = [];
  for (let press = 0; press < 2; ++press) {
    study.querySelector(".sortable th button").click();
    seen.sorted.push(column());
  }
  const page = await open("/index.html");
  const input = page.querySelector(".md-search__input");
  const says = page.querySelector(".md-search-result__meta");
  const until = async (holds) => { while (!holds()) await sleep(100); };
  // A key that is pressed while its index arrives takes the index's place in the theme's queue of
  // one, and the search never begins.
  await until(() => !says.textContent.includes("Initializing"));
  input.focus();
  input.value = "limit cycles of stiffness";
  input.dispatchEvent(new KeyboardEvent("keyup", { bubbles: true }));
  await until(() => page.querySelector(".md-search-result__link"));
  seen.found = [...page.querySelectorAll(".md-search-result__link")].map((a) => new URL(a.href).pathname);
  seen.search_says = says.textContent.trim();
  note();
  return seen;
}
look().catch((error) => ({ error: String(error.stack) })).then((seen) =>
  fetch("/report", { method: "POST", body: JSON.stringify(seen) }));
</script>
"""

LOOKED_AT = ["/index.html", "/explanation/methods/force-control.html", "/tutorials/own-controller.html", "/how-to/sweeps.html"]
SORTABLE = "/explanation/studies/least-free-motion-time.html"


class Site(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        done = subprocess.run(["/usr/bin/python3", ROOT / "scripts/docs/site.py", "--no-gallery"],
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            raise AssertionError(done.stdout)
        files = [file for file in SITE.rglob("*") if file.is_file() and
                 (file.relative_to(SITE).parts[0] not in {"api", "gallery"} or file.name == "still.png")]
        cls.html = {"/" + str(file.relative_to(SITE)): file.read_text(encoding="utf-8")
                    for file in files if file.suffix == ".html" and file.name != "404.html"}
        cls.forwards = {path: html for path, html in cls.html.items() if 'http-equiv="refresh"' in html}
        pages = sorted(path for path in cls.html if not path.startswith("/source/") and path not in cls.forwards)
        driver = DRIVER.replace("CONTRAST", CONTRAST, 1).replace("PAGES", json.dumps(pages), 1).replace("LOOKED_AT", json.dumps(LOOKED_AT)).replace("SORTABLE", json.dumps(SORTABLE))
        served = {"/" + str(file.relative_to(SITE)): (
            file.read_bytes(), mimetypes.guess_type(file.name)[0] or "application/octet-stream") for file in files}
        served["/"] = (driver.encode(), "text/html; charset=utf-8")
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)
        cls.seen, _, _ = visit(served, WORK, ["--window-size=1400,1000"])
        if "error" in cls.seen:
            raise AssertionError(cls.seen["error"])

    def each(self, key):
        return {path: page[key] for path, page in self.seen["pages"].items() if page[key]}

    def test_nothing_is_asked_of_another_host(self):
        others = [url for url in self.seen["requests"] if not re.match(r"http://127\.0\.0\.1:\d+/", url)]
        self.assertEqual(others, [])
        self.assertGreater(len(self.seen["requests"]), 100)
        for path, html in self.html.items():
            self.assertEqual(re.findall(r"<(?:script|img|link|iframe|video|source)\b[^>]*(?:src|href)=\"?https?:[^>]*>", html),
                             [], path)

    def test_maths_is_set(self):
        self.assertEqual(self.each("errors"), {})
        self.assertEqual(self.each("unset"), {})
        self.assertEqual(self.each("dollars"), {})
        self.assertGreater(self.seen["pages"]["/explanation/methods/model-predictive-control.html"]["formulas"], 80)

    def test_a_csv_file_is_a_table_that_can_be_sorted(self):
        rising, falling = self.seen["sorted"]
        self.assertGreater(len(rising), 10)
        self.assertEqual(rising, sorted(rising))
        self.assertEqual(falling, sorted(rising, reverse=True))

    def test_search_finds_the_page(self):
        self.assertIn("/explanation/studies/contact-stiffness.html", self.seen["found"], self.seen["search_says"])

    def test_pictures_have_words_and_are_there(self):
        self.assertEqual(self.each("unnamed"), {})
        self.assertEqual(self.each("missing"), {})

    def test_text_can_be_read_in_light_and_in_dark(self):
        self.assertEqual([f"{page}: {place}: {ratio}" for page, found in self.seen["faint"].items()
                          for place, ratio in found.items()], [])

    def test_the_keyboard_gets_past_the_navigation(self):
        for path, page in self.seen["pages"].items():
            self.assertTrue(page["skip"] or "Decisions" in self.html[path], path)
            self.assertEqual(page["language"], "en")

    def test_links_and_anchors_hold(self):
        ids = {path: set(re.findall(r'\bid="([^"]+)"', html)) for path, html in self.html.items()}
        for path, html in self.html.items():
            for target in re.findall(r'<a\b[^>]*\bhref="([^"]+)"', html):
                if re.match(r"[a-z]+:", target):
                    continue
                name, _, anchor = target.partition("#")
                file = (SITE / path[1:]).parent / name if name else SITE / path[1:]
                file = file / "index.html" if file.is_dir() else file
                place = "/" + str(pathlib.Path(*file.resolve().relative_to(SITE.resolve()).parts))
                if name.startswith("gallery/"):  # files of the gallery
                    continue
                self.assertTrue(file.is_file(), f"{path}: {target}")
                if anchor and place in ids and anchor != "__tabbed":
                    self.assertIn(anchor, ids[place], f"{path}: {target}")

    def test_old_addresses_lead_to_the_pages(self):
        moved = tomllib.loads((ROOT / "scripts/docs/moved.toml").read_text(encoding="utf-8"))
        self.assertEqual(set(self.forwards), {f"/{old.removesuffix('.md')}.html" for old in moved})
        for path, html in self.forwards.items():
            target, = re.findall(r'content="0; url=([^"]+)"', html)
            self.assertTrue(((SITE / path[1:]).parent / target).is_file(), path)

    def test_tutorials_come_first(self):
        nav = self.html["/index.html"].split('<nav class="md-nav md-nav--primary')[1]
        links = re.findall(r'<a href="([^"#]+\.html)" class="md-nav__link"', nav)
        self.assertEqual(links[:3], [f"tutorials/{page}.html" for page in ("first-run", "own-controller", "own-observer")])


if __name__ == "__main__":
    WORK = pathlib.Path(sys.argv.pop()).resolve()
    for program, package in (("mkdocs", "mkdocs-material"), ("doxygen", "doxygen")):
        if shutil.which(program) is None:
            print(f"skipped: there is no {program} (Debian's {package}, cmake/packages/docs.txt)")
            sys.exit(SKIPPED)
    unittest.main()
