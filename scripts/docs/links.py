#!/usr/bin/python3
"""links.py [PAGE...]: broken links and missing anchors of the documentation, README and CHANGELOG.

A link is relative and names a file or folder of the tree. An anchor is a heading of its page. Links to other
hosts are not checked. Prints one line for each broken link; exit status 1.
"""

import pathlib
import sys
import urllib.parse

import markdown_pages


def broken(page):
    """Yields (line number, reason)."""
    text = page.read_text(encoding="utf-8")
    for number, image, label, target in markdown_pages.links_of(page, text):
        if "://" in target or target.startswith("mailto:"):
            continue
        path, _, fragment = target.partition("#")
        file = page if not path else page.parent / urllib.parse.unquote(path)
        if path.startswith("/"):
            yield number, f"{target}: not relative"
        elif not file.exists():
            yield number, f"{target}: there is no such file"
        elif fragment and (file.suffix != ".md" or
                           fragment not in markdown_pages.anchors(file.read_text(encoding="utf-8"))):
            yield number, f"{target}: there is no such heading"
        elif image and not label.strip():
            yield number, f"{target}: a picture without words for those who do not see it"


def main(arguments):
    pages = [pathlib.Path(name) for name in arguments] or markdown_pages.pages()
    findings = [f"{page}:{number}: {what}" for page in pages for number, what in broken(page)]
    print("\n".join(findings) if findings else f"{len(pages)} pages: all links hold")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
