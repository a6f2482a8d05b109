"""mkdocs hooks for docs/: navigation, links to files outside docs/, notebooks, gallery and headers. Pages of
docs/ are built unchanged.

docs/X is at X on the site. Other Markdown and pictures of the tree, T, are at source/T. A notebook becomes a
page with its cells. Any other text file becomes a page source/T.md that shows it.
"""

import base64
import json
import os
import pathlib
import re
import shutil
import sys
import tomllib
import urllib.parse
import xml.etree.ElementTree

from mkdocs.structure.files import File

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import markdown_pages  # noqa: E402
import numbers_of_tables  # noqa: E402
from markdown_pages import DOCS, ROOT  # noqa: E402

WORK = ROOT / "build/docs"
MADE = WORK / "made"  # generated pages
REFERENCE = WORK / "reference"  # pages written by the program, if it exists
KATEX = pathlib.Path("/usr/share/javascript/katex")
DATA = {".csv", ".h5", ".mp4"}  # copied unchanged
PICTURES = {".png", ".jpg", ".svg", ".gif"}
LANGUAGES = {".h": "cpp", ".cpp": "cpp", ".py": "python", ".toml": "toml", ".sh": "bash",
             ".cmake": "cmake", ".xml": "xml", ".urdf": "xml", ".json": "json"}


# Where a file of the tree is in the site.

def place_of(file):
    """The path of a file or folder among the site's sources."""
    inside = file.is_relative_to(DOCS)
    path = file.relative_to(DOCS) if inside else pathlib.Path("source") / file.relative_to(ROOT)
    if file.is_dir():
        return path / "index.md"
    if file.suffix == ".ipynb":
        return path.with_suffix(".md")
    if file.suffix == ".md" or file.suffix in PICTURES | DATA:
        return path
    return (pathlib.Path("source") / file.relative_to(ROOT)).with_name(file.name + ".md")


def at_home(text, page, place):
    """The page's Markdown with links relative to `place`."""
    lines = text.split("\n")
    for number, line in markdown_pages.prose(text):
        plain = markdown_pages.without_code(line)
        for link in reversed(list(markdown_pages.LINK.finditer(plain))):
            path, hash_, fragment = link[3].partition("#")
            if not path or "://" in path:
                continue
            file = pathlib.Path(os.path.normpath(page.parent / urllib.parse.unquote(path)))
            target = os.path.relpath(place_of(file), place.parent) + hash_ + fragment
            line = line[:link.start(3)] + target + line[link.end(3):]
        lines[number - 1] = line
    return "\n".join(lines)


# Generated pages.

def shown(file):
    """A page that shows a text file."""
    language = LANGUAGES.get(file.suffix, "text")
    text = file.read_text(encoding="utf-8")
    fence = "`" * max([3, *(len(run) + 1 for run in re.findall("`{3,}", text))])
    return f"# {file.relative_to(ROOT)}\n\n{fence}{language}\n{text}\n{fence}\n"


def listed(folder):
    """A page that lists the pages of a folder by title."""
    name = folder.relative_to(DOCS if folder.is_relative_to(DOCS) else ROOT)
    lines = [f"# {str(name).capitalize()}", ""]
    for file in sorted(folder.iterdir()):
        if file.suffix == ".md":
            title = next(markdown_pages.headings(file.read_text(encoding="utf-8")))[2]
        elif file.suffix == ".ipynb":
            title = title_of_notebook(json.loads(file.read_text(encoding="utf-8")))
        elif file.is_file() and not folder.is_relative_to(DOCS):
            title = file.name
        else:
            continue
        lines.append(f"- [{title}]({file.name})")
    return at_home("\n".join(lines) + "\n", folder / "index.md", place_of(folder))


def title_of_notebook(notebook):
    return re.search(r"^# (.*)$", "".join(notebook["cells"][0]["source"]), re.M)[1]


def write_notebook(file, place):
    """Write a page with the cells of a notebook and their stored outputs."""
    notebook = json.loads(file.read_text(encoding="utf-8"))
    title = title_of_notebook(notebook)
    parts, pictures = [], 0
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(at_home(source, file, place))
            continue
        parts.append(f"```python\n{source}\n```")
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/png" in data:
                pictures += 1
                name = f"{file.stem}-{pictures}.png"
                (MADE / place.parent / name).write_bytes(base64.b64decode(data["image/png"]))
                parts.append(f"![Figure {pictures} of the notebook “{title}”]({name})")
            elif text := "".join(output.get("text", data.get("text/plain", ""))):
                parts.append(f"```text\n{text.rstrip()}\n```")
    parts.insert(1, f"As a [notebook for Jupyter]({file.name}).")
    return "\n\n".join(parts) + "\n"


def headers():
    """A page of the rooms' headers, with their first comments and links to Doxygen's pages."""
    tags = xml.etree.ElementTree.parse(WORK / "api.tag")
    pages = {}
    for compound in tags.iter("compound"):
        if compound.get("kind") == "file" and compound.findtext("name").endswith(".h"):
            path = compound.findtext("path", "") + compound.findtext("name")
            page = compound.findtext("filename")
            pages[path[path.index("breakwater/"):]] = page if page.endswith(".html") else page + ".html"
    lines = ["# C++ headers", "",
             "The headers of an installation, room by room ([architecture](explanation/architecture.md)); "
             '<a href="api/annotated.html">all classes</a>, <a href="api/globals_func.html">functions</a>.']
    room = None
    for path in sorted(pages):
        _, here, name = path.split("/", 2)
        if here != room:
            room = here
            lines += ["", f"## {room}", "", "| header | |", "|---|---|"]
        first = (ROOT / "src" / room / name).read_text(encoding="utf-8").split("#pragma")[0]
        about = " ".join(line.lstrip("/ ") for line in first.split("\n")).strip().replace("|", "\\|")
        lines.append(f'| <a href="api/{pages[path]}"><code>&lt;{path}&gt;</code></a> | {about} |')
    return "\n".join(lines) + "\n"


def gallery():
    """The page of the stored replays and videos."""
    kept = WORK / "gallery"
    exhibits = tomllib.loads((pathlib.Path(__file__).parent / "gallery.toml").read_text("utf-8"))
    lines = ["# Gallery", "", exhibits["introduction"].strip(), ""]
    for exhibit in exhibits["exhibit"]:
        folder = f"gallery/{exhibit['name']}"
        lines += [f"## {exhibit['title']}", "", exhibit["text"].strip(), ""]
        if not (kept / exhibit["name"] / "made.json").exists():
            # Without its runs a picture that is kept stands here.
            (MADE / folder).mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / "renders/gallery" / exhibit["picture"], MADE / folder / "still.png")
            lines += [f'<img src="{folder}/still.png" alt="{exhibit["alt"]}">', "", "```", *exhibit["runs"], "```", ""]
            continue
        lines += [
            f'<video controls preload="none" playsinline poster="{folder}/still.png" width="960" height="540"'
            f' src="{folder}/video.mp4" aria-label="{exhibit["alt"]}">{exhibit["alt"]}</video>', "",
            f'<a class="md-button" href="{folder}/replay.html">Replay in three dimensions</a>', "",
            "```", *exhibit["runs"], "```", ""]
        for name in ("still.png", "video.mp4", "replay.html"):
            (MADE / folder).mkdir(parents=True, exist_ok=True)
            shutil.copy(kept / exhibit["name"] / name, MADE / folder / name)
    return "\n".join(lines)


# mkdocs' events.

def on_config(config):
    """Take the navigation from docs/README.md: its sections in order, with the pages that they name.

    Pages of a folder in a section's folder (explanation/methods) are a separate group.
    """
    text = (DOCS / "README.md").read_text(encoding="utf-8")
    nav, section, named = [], None, set()
    for number, line in markdown_pages.prose(text):
        if title := re.match(r"\*\*([^*]+)\*\*", line):
            section = []
            nav.append({markdown_pages.plain_text(title[1]): section})
        for _, _, _, target in markdown_pages.links(line):
            path = target.partition("#")[0]
            file = DOCS / path
            if section is None or path in named or "://" in path or path.startswith(".."):
                continue
            named.add(path)
            if file.is_dir():
                pages = [page for page in sorted(file.iterdir()) if page.suffix in {".md", ".ipynb"}]
                group(section, file.name).extend(str(place_of(page)) for page in [file, *pages])
            elif file.suffix == ".md":
                parent = file.parent.relative_to(DOCS).parts
                (group(section, parent[1]) if len(parent) > 1 else section).append(path)
    for page in sorted(REFERENCE.rglob("*.md")):
        reference = next(entry["Reference"] for entry in nav if "Reference" in entry)
        parent = page.relative_to(REFERENCE).parts[:-1]
        (group(reference, parent[0]) if parent else reference).append(f"reference/{page.relative_to(REFERENCE)}")
    here = next(iter(nav[0].values()))
    here.append("README.md")
    config["nav"] = [*nav, {"Gallery": "gallery.md"}, {"C++ headers": "headers.md"},
                     {"Contributing": "source/CONTRIBUTING.md"}, {"Changes": "source/CHANGELOG.md"}]
    return config


def group(section, name):
    """The group of a section's navigation. It is made if it does not exist."""
    title = name.capitalize()
    found = next((entry[title] for entry in section if isinstance(entry, dict) and title in entry), None)
    if found is None:
        found = []
        section.append({title: found})
    return found


def on_files(files, config):
    shutil.rmtree(MADE, ignore_errors=True)
    wanted = {ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md"}
    for page in markdown_pages.pages():
        for _, _, _, target in markdown_pages.links_of(page, page.read_text(encoding="utf-8")):
            path = target.partition("#")[0]
            if path and "://" not in path:
                wanted.add(pathlib.Path(os.path.normpath(page.parent / urllib.parse.unquote(path))))
    wanted |= set((DOCS / "notebooks").glob("*.ipynb"))
    have = {file.src_path for file in files}

    def add(place, content):
        (MADE / place).parent.mkdir(parents=True, exist_ok=True)
        (MADE / place).write_bytes(content if isinstance(content, bytes) else content.encode())

    for file in sorted(wanted):
        place = place_of(file)
        if str(place) in have:
            continue
        (MADE / place).parent.mkdir(parents=True, exist_ok=True)
        if file.is_dir():
            add(place, listed(file))
        elif file.suffix == ".ipynb":
            add(place, write_notebook(file, place))
        elif file.suffix == ".md":
            add(place, at_home(file.read_text(encoding="utf-8"), file, place))
        elif file.suffix in PICTURES | DATA:
            add(place, file.read_bytes())
        else:
            add(place, at_home(shown(file), file, place))
    for page in sorted(REFERENCE.rglob("*.md")):
        add(pathlib.Path("reference") / page.relative_to(REFERENCE), page.read_bytes())
    add(pathlib.Path("headers.md"), headers())
    add(pathlib.Path("gallery.md"), gallery())
    for file in sorted(MADE.rglob("*")):
        if file.is_file():
            files.append(File(str(file.relative_to(MADE)), str(MADE), config["site_dir"],
                              use_directory_urls=False))
    return files


def on_post_build(config):
    """Add files of other packages (KaTeX, Doxygen's pages), and forward old addresses."""
    site = pathlib.Path(config["site_dir"])
    moved = tomllib.loads((pathlib.Path(__file__).parent / "moved.toml").read_text("utf-8"))
    for old, new in moved.items():
        forward(site, pathlib.Path(old).with_suffix(".html"), pathlib.Path(new).with_suffix(".html"))
    katex = site / "assets/katex"
    (katex / "fonts").mkdir(parents=True)
    for name in ("katex.js", "katex.min.css"):
        shutil.copy(KATEX / name, katex / name)
    for font in sorted((KATEX / "fonts").glob("*.woff2")):
        shutil.copy(font, katex / "fonts" / font.name)
    shutil.copytree(WORK / "api", site / "api")
    # Source pages are not in the search index. theme/assets/from-disk.js needs a script.
    index_file = site / "search/search_index.json"
    index = json.loads(index_file.read_text(encoding="utf-8"))
    index["docs"] = [entry for entry in index["docs"]
                     if not entry["location"].startswith("source/") or
                     entry["location"].startswith(("source/CHANGELOG.html", "source/CONTRIBUTING.html"))]
    text = json.dumps(index, ensure_ascii=False, separators=(",", ":"))
    index_file.write_text(text, encoding="utf-8")
    index_file.with_suffix(".js").write_text(f"breakwaterSearchIndex({text});\n", encoding="utf-8")


def forward(site, old, new):
    """Write a page at an old address that forwards to the new one and keeps the anchor."""
    target = os.path.relpath(new, old.parent)
    (site / old).parent.mkdir(parents=True, exist_ok=True)
    (site / old).write_text(
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>This page has moved</title>\n'
        f'<meta http-equiv="refresh" content="0; url={target}"><link rel="canonical" href="{target}">\n'
        f'<script>location.replace("{target}" + location.hash)</script>\n'
        f'<p>This page has moved: <a href="{target}">{target}</a></p></html>\n', encoding="utf-8")


def on_page_markdown(markdown, page, config, files):
    file = pathlib.Path(page.file.abs_src_path)
    if file.is_relative_to(DOCS):
        markdown = with_csv_tables(numbers_of_tables.with_commands(markdown, file), file)
        markdown = at_home(markdown, file, place_of(file))
    return for_python_markdown(markdown)


def with_csv_tables(text, page):
    """A page with its CSV files as sortable tables (theme/assets/breakwater.js). The links stay."""
    lines = text.split("\n")
    for number, line in markdown_pages.prose(text):
        if rows := markdown_pages.csv_table(page, line):
            head, *body = [[cell.replace("|", "\\|") for cell in row] for row in rows]
            table = [f"| {' | '.join(row)} |" for row in [head, ["---"] * len(head), *body]]
            lines[number - 1] = "\n".join([
                line.partition("<!--")[0], "", '<div class="sortable" markdown="1">', "", *table, "", "</div>"])
    return "\n".join(lines)


def for_python_markdown(text):
    """Convert lists: a forge needs no empty line before them, and indents by two spaces."""
    lines, outside = text.split("\n"), {number for number, _ in markdown_pages.prose(text)}
    result, item = [], re.compile(r"([-*]|\d+\.) ")
    for number, line in enumerate(lines, 1):
        before = lines[number - 2] if number > 1 else ""
        if number in outside and item.match(line) and before.strip() and not (
                item.match(before) or before.startswith(" ")):
            result.append("")
        top_fence = number not in outside and not line.startswith("  ")
        if re.match(r"  \S|   +\S", line) and not top_fence and in_list(lines, number - 1):
            line = "  " + line
        result.append(line)
    return "\n".join(result)


def in_list(lines, index):
    """Whether an indented line belongs to a list's item."""
    for line in reversed(lines[:index]):
        if line.strip() and not line.startswith(" "):
            return bool(re.match(r"([-*]|\d+\.) ", line))
    return False
