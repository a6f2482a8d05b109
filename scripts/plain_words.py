#!/usr/bin/python3
"""plain_words.py [--count] [FILE...]: the rules of CONTRIBUTING.md for plain words, as far as a program can check them.

It reads pages, comments, and the messages and help texts in string literals. It finds long sentences,
words that the glossary's column "not" has in code type, and beginnings such as Of or What.
"""

import argparse
import bisect
import collections
import inspect
import io
import itertools
import pathlib
import re
import subprocess
import sys
import tokenize

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "scripts/docs"))
import markdown_pages  # noqa: E402

LONGEST = 25
FILES = [":/" + name for name in (
    "*.md", "src", "tests", "scenarios", "python", "scripts", "templates", "studies", "data")]
SUFFIXES = {".md", ".h", ".cpp", ".js", ".py", ".toml", ".sh"}
BEGINNING = re.compile(r"(Of|What|Who|Whose|Those|Else)\b")
ABBREVIATION = re.compile(r"\b(Eqs?|Figs?|Sec|cf|vs|al|e\.g|i\.e|approx|resp|no)\.(?=\s)")
CPP = re.compile(r'R"(\w*)\(.*?\)\1"|"(?P<text>(?:\\.|[^"\\\n])*)"|\'(?:\\.|[^\'\\\n])\'|//[/!]?<?(?P<line>[^\n]*)'
                 r'|/\*.*?\*/', re.S)
HASH = re.compile(r'"""(?:.*?)"""|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|(?:^|(?<=\s))#(?P<line>[^\n]*)', re.S | re.M)


class Block:
    """Text that is read in one go: pieces, each with its line. `kind`: prose, comment, table or string."""

    def __init__(self, kind, pieces):
        self.kind, self.lines = kind, [line for line, _ in pieces]
        separator = "" if kind == "string" else "\n"
        self.starts = [0, *itertools.accumulate(len(text) + len(separator) for _, text in pieces)][:-1]
        self.text = separator.join(text for _, text in pieces)

    def line_of(self, position):
        return self.lines[bisect.bisect_right(self.starts, position) - 1]


def paragraphs(kind, lines):
    """Blocks of lines of text: an empty one ends a block, an item of a list begins one."""
    pieces = []
    for line, text in lines:
        is_formula = kind == "comment" and re.match(r" {5,}\S|.*\S {2,}\S", text) is not None  # or a row of columns
        is_item = re.match(r"\s*([-*+]|\d+\.)\s", text) is not None
        if pieces and (not text.strip() or is_item or is_formula or line != pieces[-1][0] + 1):
            yield Block(kind, pieces)
            pieces = []
        if text.strip() and not is_formula:
            marks = re.match(r"\s*(?:[-*+]|\d+\.)\s|", text)[0]
            pieces.append((line, " " * len(marks) + text[len(marks):]))
    if pieces:
        yield Block(kind, pieces)


def of_page(text):
    text = re.sub(r"<!--.*?-->|\$\$.*?\$\$", lambda hidden: "\n" * hidden[0].count("\n"), text, flags=re.S)
    lines = []
    for line, words in markdown_pages.prose(text):
        if words.startswith("|"):
            yield from (Block("table", [(line, cell)]) for cell in words.split("|"))
        lines.append((line, "" if words.startswith(("|", "#", "<")) else words))
    yield from paragraphs("prose", lines)


def place(text, position):
    """The line of a position, counted from 1, and the text before it on this line."""
    return text.count("\n", 0, position) + 1, text[text.rfind("\n", 0, position) + 1:position]


def of_comments(found):
    """Blocks of comments: (line, the line before it, text). A comment below another in one column continues it."""
    for _, run in itertools.groupby(found, key=lambda comment: len(comment[1])):
        yield from paragraphs("comment", [piece for line, before, text in run for piece in
                                          [(line, "")] * bool(before.strip()) + [(line, text)]])


def of_string(pieces):
    """Blocks of a message or a help text: two line breaks or an indented line begin one."""
    block = Block("string", pieces)
    for part in re.finditer(r"(?:(?!\\n\\n|\\n\s{2}|\n\n|\n\s{6}).)+", block.text, re.S):
        if len(re.findall(r"\b[a-z]+\b", words := re.sub(r"\\n|\n", " ", part[0]))) >= 3:
            yield Block("string", [(block.line_of(part.start()), words)])


def of_cpp(text, with_strings):
    comments, strings, end = [], [], 0
    for match in CPP.finditer(text):
        line, before = place(text, match.start())
        if match["line"] is not None:
            comments.append((line, before, match["line"]))
        elif match["text"] is not None and with_strings:
            if strings and not text[end:match.start()].strip():
                strings[-1].append((line, match["text"]))
            else:
                strings.append([(line, match["text"])])
            end = match.end()
    yield from of_comments(comments)
    for pieces in strings:
        yield from of_string(pieces)


def of_python(text, with_strings):
    comments, before = [], tokenize.NEWLINE
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            comments.append((token.start[0], token.line[:token.start[1]], token.string.lstrip("#!")))
        elif token.type == tokenize.STRING and before not in {tokenize.OP, tokenize.NAME, tokenize.STRING}:
            lines = inspect.cleandoc(token.string.strip('rf"')).split("\n")
            yield from paragraphs("comment", enumerate((" " + words for words in lines), token.start[0]))
        elif token.type == tokenize.STRING and with_strings and '"""' not in token.string:
            yield from of_string([(token.start[0], token.string.strip("rf").strip("\"'"))])
        before = token.type if token.type not in {tokenize.COMMENT, tokenize.NL} else before
    yield from of_comments(comments)


def of_hash(text):
    return of_comments([(*place(text, match.start()), match["line"])
                        for match in HASH.finditer(text) if match["line"] is not None and not match[0].startswith("#!")])


def blocks_of(name, text):
    suffix, with_strings = pathlib.Path(name).suffix, "tests" not in pathlib.Path(name).parts
    if suffix == ".md":
        return of_page(text)
    if suffix == ".py":
        return of_python(text, with_strings)
    return of_cpp(text, with_strings and suffix != ".js") if suffix in {".h", ".cpp", ".js"} else of_hash(text)


def plain(text):
    """The text with a word in the place of code and maths, and of a link its label. No line break is lost."""
    kept = lambda match: "x" * (len(match[0]) - match[0].count("\n")) + "\n" * match[0].count("\n")  # noqa: E731
    text = re.sub(r"(`+)(?!`).*?(?<!`)\1(?!`)|\$[^$\s](?:[^$]*[^$\s])?\$", kept, text, flags=re.S)
    text = re.sub(r"\]\([^()\s]*\)|[\[\]*]", lambda match: " " * len(match[0]), text)
    return ABBREVIATION.sub(lambda match: match[1] + " ", text)


def not_said():
    """{word: the glossary's term for it}"""
    words = {}
    for line, text in markdown_pages.prose((markdown_pages.DOCS / "reference/glossary.md").read_text("utf-8")):
        cells = [cell.strip() for cell in text.split("|")[1:-1]]
        if len(cells) > 2:
            words |= dict.fromkeys(re.findall("`([^`]+)`", cells[-2]), cells[0])
    return words


def findings(name, text, words):
    """Yields (line, what is wrong)."""
    said = re.compile(r"\b(" + "|".join(sorted(map(re.escape, words), key=len, reverse=True)).replace(r"\ ", r"\s+") + r")\b", re.I)
    for block in blocks_of(name, text):
        read = plain(block.text)
        for match in said.finditer(read):
            word = " ".join(match[0].split())
            yield block.line_of(match.start()), f"“{word}”: {words[word.lower()]}"
        if block.kind == "table":
            continue
        for sentence in re.finditer(r"\S.*?(?:[.!?][)”\"’]?(?=\s|$)|$(?!\n)|:(?=\s*\Z))", read, re.S):
            start = sentence[0].lstrip("(“\" ")
            is_first = not read[:sentence.start()].strip()
            if beginning := BEGINNING.match(start.capitalize() if is_first and block.kind == "comment" else start):
                yield block.line_of(sentence.start()), f"begins with “{beginning[0]}”"
            count = len([word for word in sentence[0].split() if re.search(r"\w", word)])
            if count > LONGEST:
                yield block.line_of(sentence.start()), f"{count} words: {' '.join(sentence[0].split()[:6])} …"


def main(arguments):
    parser = argparse.ArgumentParser(prog="scripts/plain_words.py", description=__doc__.split("\n")[0])
    parser.add_argument("--count", action="store_true", help="print the number of findings of each file")
    parser.add_argument("files", nargs="*", metavar="FILE", help="check these files or folders alone")
    options = parser.parse_args(arguments)
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "--full-name",
                             "--error-unmatch", *(options.files or FILES)], text=True, capture_output=True)
    if listed.returncode != 0:
        parser.error(listed.stderr.splitlines()[0].removeprefix("error: "))
    names = [name for name in listed.stdout.splitlines() if (ROOT / name).is_file() and
             pathlib.Path(name).suffix in SUFFIXES and name != "CHANGELOG.md"]  # history, as it was written
    words, counts = not_said(), collections.Counter()
    for name in names:
        for line, what in sorted(findings(name, (ROOT / name).read_text(encoding="utf-8"), words)):
            counts[name] += 1
            if not options.count:
                print(f"{name}:{line}: {what}")
    if options.count:
        print(*(f"{count:5} {name}" for name, count in counts.most_common()), f"{counts.total():5} in all", sep="\n")
    return 1 if counts else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
