"""The parts of the documentation's Markdown, as a forge reads it: headings, links, tables.

Fenced code has no links, headings or tables.
"""

import csv
import pathlib
import re
import unicodedata

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+(?:\([^()]*\)[^()\s]*)?)\)")
CSV_TABLE = re.compile(r"\[[^\]]*\]\(([^()\s]+\.csv)\)<!-- table -->$")


def pages():
    """All pages whose links are checked."""
    return [*(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")), *sorted(DOCS.rglob("*.md"))]


def prose(text):
    """Yields (line number from 1, line) without fenced code."""
    fence = None
    for number, line in enumerate(text.split("\n"), 1):
        mark = re.match(r"\s*(```+|~~~+)", line)
        if fence is None and mark:
            fence = mark[1]
        elif fence is not None:
            if mark and mark[1].startswith(fence):
                fence = None
        else:
            yield number, line


def without_code(line):
    """The line with blanks in place of `code`, so that columns stay."""
    return re.sub(r"(`+)(?!`).*?(?<!`)\1(?!`)", lambda code: " " * len(code[0]), line)


def links(text):
    """Yields (line number, is an image, label, target)."""
    for number, line in prose(text):
        plain = without_code(line)
        for link in LINK.finditer(plain):
            yield number, link[1] == "!", line[link.start(2):link.end(2)], link[3]


def plain_text(markdown):
    """A label without Markdown marks."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", markdown)
    return re.sub(r"[*`]", "", text).strip()


def csv_table(page, line):
    """The rows of the CSV file that a line of a page shows as a table, its head first; or None."""
    link = CSV_TABLE.match(line)
    if link is None:
        return None
    with open(page.parent / link[1], newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def links_of(page, text):
    """The links of a page, and those in the cells of the CSV files that it shows as tables."""
    yield from links(text)
    for number, line in prose(text):
        try:
            rows = csv_table(page, line) or []
        except FileNotFoundError:
            continue  # the link to the file itself is broken
        for row in rows:
            for _, *link in links(" ".join(row)):
                yield number, *link


def headings(text):
    """Yields (line number, level, text)."""
    for number, line in prose(text):
        heading = re.match(r"(#{1,6})\s+(.*?)\s*#*$", line)
        if heading:
            yield number, len(heading[1]), heading[2]


def anchor(heading):
    """GitHub's anchor of a heading: small letters, digits, _ and -, a - for each space."""
    text = unicodedata.normalize("NFC", plain_text(heading)).lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(text):
    """Every anchor of a page; equal headings are counted."""
    seen = {}
    found = set(re.findall(r'\bid="([^"]+)"', text))
    for _, _, heading in headings(text):
        name = anchor(heading)
        found.add(name if name not in seen else f"{name}-{seen[name]}")
        seen[name] = seen.get(name, 0) + 1
    return found
