#!/usr/bin/python3
"""The numbers of the documentation's tables, and the runs that they come from: `./dev docs --check`.

A comment in TOML above a table states the runs of its numbers:

    <!-- numbers
    run     = "breakwater sweep studies/contact-damping.toml"
    rows    = "case"                        # the first column names the case
    columns = "contact.damping_Ns_m"        # the head has the damping
    cells   = "peak_force_raw_N, peak_force_filtered_N, bounce_count"
    -->
    | case | B = 1 | 3 | …

or why it is not checked: <!-- numbers not checked: measured on a clock -->. For all tables of a page without a
comment: <!-- numbers of this page not checked: … -->. CONTRIBUTING.md has the keys.

A number is right if it equals the run's value, rounded to the written digits.
"""

import argparse
import ast
import csv
import dataclasses
import fnmatch
import hashlib
import html
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tomllib

import numpy

import markdown_pages
from markdown_pages import ROOT

COMMENT = re.compile(r"<!-- numbers\b(.*?)-->", re.S)
NUMBER = re.compile(r"(?<![\w.])(?P<below>< ?)?(?P<sign>(?<![\d)])[−-])?"
                    r"(?P<digits>\d{1,3}(?:[ \u202f\u00a0]\d{3})+(?![\d.])|\d+\.?\d*|\.\d+)"
                    r"(?:e(?P<e>[-+]?\d+)|·10(?P<ten>[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)|(?P<power>[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?")
SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
BELOW = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Mistake(Exception):
    """An error in a comment or in a run, in one line."""


# Tables and their comments.

@dataclasses.dataclass
class Table:
    page: pathlib.Path
    line: int           # line of its head
    head: list
    rows: list          # (line number, cells)
    is_csv: bool        # a CSV file shown on the page
    commented: int      # line of its comment; 0: none
    spec: dict | None   # contents of the comment
    reason: str | None  # reason why it is not checked
    compared: int = 0   # number of compared numbers

    def __str__(self):
        return f"{os.path.relpath(self.page, ROOT)}:{self.line}"


def borders_of(line):
    """The positions of the bars in a table's line, except those in code or behind a backslash."""
    plain = re.sub(r"\\\|", "  ", markdown_pages.without_code(line))
    return [i for i, letter in enumerate(plain) if letter == "|"]


def cells_of(line):
    borders = borders_of(line)
    return [line[a + 1:b].strip() for a, b in zip(borders, borders[1:])]


def tables(page, text=None):
    text = page.read_text(encoding="utf-8") if text is None else text
    lines = dict(markdown_pages.prose(text))
    everywhere = re.search(r"<!-- numbers of this page not checked: (.*?) -->", text, re.S)
    found = []
    for number in lines:
        shown = markdown_pages.csv_table(page, lines[number])
        if shown:
            head, rows = shown[0], [(number, cells) for cells in shown[1:]]
        elif lines[number].startswith("|") and re.match(r"\|[-: |]+\|$", lines.get(number + 1, "")):
            head, rows, at = cells_of(lines[number]), [], number + 2
            while lines.get(at, "").startswith("|"):
                rows.append((at, cells_of(lines[at])))
                at += 1
        else:
            continue
        above = "\n".join(text.split("\n")[:number - 1])
        comment = None
        for comment in COMMENT.finditer(above):
            pass
        comment = comment if comment and comment.end() == len(above) else None
        reason = everywhere[1] if everywhere else None
        spec = None
        if comment:
            if why := re.match(r" not checked: (.*?) *$", comment[1], re.S):
                reason = " ".join(why[1].split())
            else:
                reason = None
                try:
                    spec = tomllib.loads(comment[1])
                    if back := spec.pop("like_above", 0):
                        spec = [table.spec for table in found if table.spec][-back] | spec
                except (tomllib.TOMLDecodeError, IndexError) as error:
                    raise Mistake(f"{os.path.relpath(page, ROOT)}:{number}: the comment above: {error}")
        commented = above.count("\n", 0, comment.start()) + 1 if comment else 0
        found.append(Table(page, number, head, rows, shown is not None, commented, spec, reason))
    return found


def has_numbers(table):
    """Whether a cell behind the first column begins with a number."""
    number = re.compile(r"[*<±−~ -]*\.?\d(?![\d.]*\.\d+[.\d]*[:–])")  # 2.3.4: and 2.3–2.5 are sections
    return any(number.match(cell) for _, cells in table.rows for cell in cells[1:])


def with_commands(text, page):
    """A page for readers: without the comments, and with the commands below the tables."""
    lines = text.split("\n")
    for table in reversed(tables(page, text)):
        if table.commented:
            lines[table.commented - 1:table.line - 1] = [""] * (table.line - table.commented)
        if table.spec:
            end = table.rows[-1][0] if table.rows else table.line + 1
            sources = as_list(table.spec.get("run", table.spec.get("csv")))
            commands = "<br>".join(f"<code>{html.escape(source)}</code>" for source in sources)
            lines.insert(end, f'\n<p class="made-by">from {commands}</p>\n')
    return re.sub(r"^<!-- numbers of this page .*? -->$", "", "\n".join(lines), flags=re.M)


# Numbers as they are written.

@dataclasses.dataclass
class Written:
    text: str
    start: int      # position in its cell
    value: float
    quantum: float  # unit of its last digit
    below: bool     # "< 1e-13"

    def holds(self, measured):
        if math.isnan(measured):
            return False
        if self.below:
            return abs(measured) < self.value
        return abs(measured - self.value) <= 0.5 * self.quantum * (1 + 1e-6)

    def instead(self, measured):
        """The measured value with the digits and the style of this number."""
        if math.isnan(measured):
            return "–"
        decimals = len(re.match(r"[^\d.]*\d*\.?(\d*)", self.text)[1])
        exponent = re.search(r"e|·10", self.text)
        if exponent and measured:
            mantissa, power = f"{measured:.{decimals}e}".split("e")
            shown = mantissa + (f"e{int(power)}" if exponent[0] == "e" else
                                "·10" + str(int(power)).translate(BELOW))
        else:
            shown = f"{measured:.{decimals}f}"
        if re.match(r"[<−-]? ?\.", self.text):
            shown = shown.replace("0.", ".", 1)
        return shown.replace("-", "−", 1) if measured < 0 else shown


def numbers_in(cell):
    """The numbers of a cell, in order."""
    found = []
    for token in NUMBER.finditer(cell):
        digits = re.sub(r"\s", "", token["digits"])
        if token["power"]:
            power, mantissa = 0, float(digits) ** int(token["power"].translate(SUPERSCRIPTS))
            quantum = mantissa
        else:
            power = int(token["e"] or (token["ten"] or "0").translate(SUPERSCRIPTS))
            mantissa = float(digits)
            quantum = 10.0 ** -len(digits.partition(".")[2])
        sign = -1.0 if token["sign"] else 1.0
        found.append(Written(token[0], token.start(), sign * mantissa * 10.0 ** power, quantum * 10.0 ** power,
                             bool(token["below"])))
    return found


# Runs.

def as_list(value):
    return value if isinstance(value, list) else [value]


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def rows_of(path):
    """The rows of a CSV file. Entries "key=value key=value" of a column `set` become columns too."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row |= dict(setting.split("=", 1) for setting in row.get("set", "").split())
    return rows


def swept(command, binaries, kept):
    """results.csv of a sweep. It is stored by its command, and `sweep` checks whether it is up to date."""
    words = shlex.split(command)
    if words[:2] != ["breakwater", "sweep"]:
        raise Mistake(f"`{command}` is no `breakwater sweep …`")
    folder = kept / hashlib.sha256(command.encode()).hexdigest()[:16]
    call = [str(binaries / "breakwater"), *words[1:], "--quiet", "--out", str(folder)]
    if not pathlib.Path(call[0]).exists():
        raise Mistake(f"there is no {call[0]}: ./dev build")
    for again in ([], ["--rerun"]):
        done = subprocess.run([*call, *again], cwd=ROOT, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        # Status 2: the stored study is from another program, scenario file or model.
        if done.returncode != 2 or not (folder / "study.toml").exists():
            break
    if done.returncode != 0:
        raise Mistake(f"`{command}`: exit status {done.returncode}: {(done.stdout or '').strip()[-300:]}")
    return rows_of(folder / "results.csv")


def results(spec, binaries, kept):
    """All rows for a table; `run` is the number of the command, from 1."""
    rows = []
    for number, run in enumerate(as_list(spec.get("run", [])), 1):
        rows += [row | {"run": str(number)} for row in swept(run, binaries, kept)]
    for file in as_list(spec.get("csv", [])):
        rows += rows_of(ROOT / file)
    if not rows:
        raise Mistake("neither `run` nor `csv` gives any row")
    return rows


# From rows to cells.

def matches(row, selector, labels):
    """Whether a row matches "key=value key<value".

    {1} is the label in column 1, {1.2} its second number, {} the label of the head.
    """
    for condition in shlex.split(selector):
        parts = re.match(r"([\w.\[\]-]+?)(=|<|>)(.*)$", condition)
        if not parts:
            raise Mistake(f"“{condition}” is no key=value")
        key, operation, wanted = parts.groups()
        have = row.get(key, "")
        if not is_number(have):
            words = re.sub(r"\{(\w*)\}", lambda name: first_word(labels, name[1]), wanted)
            if not fnmatch.fnmatch(have.lower(), words.lower()):
                return False
            continue
        if not wanted:  # "key=" selects rows without a value
            return False
        scaled, _, factor = wanted.partition("*")
        name = re.fullmatch(r"\{(\w*)(?:\.(\d+))?\}", scaled)
        value = (number_of(labels, *name.groups()) if name else float(scaled)) * float(factor or 1)
        difference = float(have) - value
        equal = abs(difference) <= 1e-9 * max(abs(value), 1e-300)
        if not (equal if operation == "=" else difference < 0 if operation == "<" else difference > 0):
            return False
    return True


def label(labels, name):
    if name not in labels:
        raise Mistake(f"there is no label {{{name}}}")
    return re.sub(r"\$.*?\$", "", markdown_pages.plain_text(labels[name]))


def first_word(labels, name):
    return (re.split(r"[\s,]+", label(labels, name).strip()) or [""])[0]


def number_of(labels, name, which=None):
    """The last number of a label (in "raw N, 1e-4 s" the timestep), or number `which`."""
    found = numbers_in(label(labels, name))
    if len(found) < int(which or 1):
        raise Mistake(f"no such number in “{label(labels, name)}”")
    return found[int(which) - 1 if which else -1].value


FUNCTIONS = {
    "median": numpy.nanmedian, "mean": numpy.nanmean, "min": numpy.nanmin, "max": numpy.nanmax,
    "count": numpy.count_nonzero, "len": numpy.size, "abs": numpy.abs, "sqrt": numpy.sqrt, "exp": numpy.exp,
    "atan2": numpy.arctan2, "pi": math.pi,
}


def evaluate(expression, rows, let):
    """The values of a Python expression over columns (as arrays) and the names of `let`."""
    def column(name):
        return numpy.array([float(row.get(name) or math.nan) for row in rows])

    dotted = sorted({name for row in rows for name in row if "." in name}, key=len, reverse=True)

    def value_of(text):
        text = " ".join(text.split())
        for name in dotted:
            text = text.replace(name, name.replace(".", "__"))
        known = FUNCTIONS | values | {"_": None}
        for node in ast.walk(ast.parse(text, mode="eval")):
            if isinstance(node, ast.Name) and node.id not in known:
                name = node.id.replace("__", ".")
                if not any(name in row for row in rows):
                    raise Mistake(f"the runs have no column “{name}”")
                known[node.id] = column(name)
        return eval(text, {"__builtins__": {}}, known)

    values = {}
    for name, text in let.items():
        if name in expression or any(name in other for other in let.values()):
            values[name] = value_of(text)
    result, flat = value_of(expression), []
    for value in result if isinstance(result, tuple) else (result,):
        flat += [None] if value is None else [float(item) for item in numpy.atleast_1d(value)]
    return flat


@dataclasses.dataclass
class Drift:
    line: int
    place: str      # "row | column"
    written: str
    measured: str
    says: str
    column: int | None = None   # position for --fix: the cell, and the number in it
    start: int | None = None


def drifted(table, all_rows):
    """Yields the wrong numbers."""
    spec = table.spec
    unknown = set(spec) - {"run", "csv", "where", "rows", "columns", "cells", "let"}
    if unknown or "cells" not in spec or "rows" not in spec:
        raise Mistake(f"keys are run or csv, where, rows, columns, cells, let; here: {', '.join(spec)}")
    rows_spec, cells_spec = spec["rows"], spec["cells"]
    if isinstance(rows_spec, list) and len(rows_spec) != len(table.rows):
        raise Mistake(f"{len(rows_spec)} rows are told of, {len(table.rows)} are there")
    columns = len(table.head) - 1
    heads = as_list(spec["columns"]) if "columns" in spec else [""]
    heads = heads * columns if len(heads) == 1 else heads
    if len(heads) != columns:
        raise Mistake(f"behind the first column are {columns}, `columns` has {len(heads)}")
    labels, compared = {}, 0
    for index, (line, cells) in enumerate(table.rows):
        labels |= {str(i): cell for i, cell in enumerate(cells, 1) if cell}
        row_selector = rows_spec[index] if isinstance(rows_spec, list) else rows_spec
        row_cells = cells_spec
        if isinstance(row_selector, dict):  # { select = "…", cells = … }: a row with other metrics
            row_selector, row_cells = row_selector["select"], row_selector["cells"]
        if row_selector.startswith("#"):
            continue
        if isinstance(row_cells, str):
            row_cells = [row_cells] * columns
        if len(row_cells) != columns:
            raise Mistake(f"behind the first column are {columns}, `cells` has {len(row_cells)}")
        for column, (head, expression) in enumerate(zip(heads, row_cells), 1):
            if not expression or expression.startswith("#") or head.startswith("#"):
                continue
            expression, _, where = expression.partition(" where ")
            selectors = [as_selector(row_selector, "{1}"), as_selector(head, "{}"), where,
                         spec.get("where", "")]
            chosen = [row for row in all_rows
                      if all(matches(row, selector, labels | {"": table.head[column]})
                             for selector in selectors)]
            place = f"{markdown_pages.plain_text(cells[0])} | {markdown_pages.plain_text(table.head[column])}"
            if not chosen:
                raise Mistake(f"{place}: no run is “{' '.join(filter(None, selectors))}”")
            measured = evaluate(expression, chosen, spec.get("let", {}))
            written = numbers_in(cells[column])
            while measured and measured[-1] is None and len(measured) > len(written):
                measured.pop()
            if not written and all(value is None or math.isnan(value) for value in measured):
                continue
            if len(written) != len(measured):
                yield Drift(line, place, cells[column] or "nothing", "", f"{len(measured)} numbers: " + ", ".join(
                    "–" if value is None else f"{value:.6g}" for value in measured))
                continue
            for number, value in zip(written, measured):
                if value is None:
                    continue
                compared += 1
                if not number.holds(value):
                    anew = number.instead(value)
                    where = (None, None) if table.is_csv else (column, number.start)
                    yield Drift(line, place, number.text, anew, f"{anew} ({value:.6g})", *where)
    table.compared = compared
    if compared == 0:
        raise Mistake("not one number is compared")


def as_selector(text, placeholder):
    """"case" is short for "case={1}" (in the head: "case={}")."""
    return f"{text}={placeholder}" if text and not re.search("[=<>]", text) else text


# The command.

def pages_of(arguments):
    return [pathlib.Path(name).resolve() for name in arguments] or [
        page for page in markdown_pages.pages() if page.name != "CHANGELOG.md"]


def list_tables(pages):
    """List the checked tables, and the reasons for the others. Exit status 1 if a table has neither."""
    status = 0
    for page in pages:
        for table in tables(page):
            if not has_numbers(table) and table.spec is None:
                continue
            if table.spec is None and table.reason is None:
                status = 1
            source = table.spec and ", ".join(as_list(table.spec.get("run", table.spec.get("csv", "?"))))
            print(f"{table}: " + (f"checked: {source}" if table.spec else
                                  f"not checked: {table.reason}" if table.reason else
                                  "NEITHER a command nor a reason stands above it"))
    return status


def write_anew(page, drifts):
    """Replace the wrong numbers by those of the runs."""
    lines = page.read_text(encoding="utf-8").split("\n")
    for drift in sorted(drifts, key=lambda drift: (drift.line, drift.column, drift.start), reverse=True):
        line = lines[drift.line - 1]
        borders = borders_of(line)
        cell = line[borders[drift.column] + 1:]
        start = borders[drift.column] + 1 + len(cell) - len(cell.lstrip()) + drift.start
        lines[drift.line - 1] = line[:start] + drift.measured + line[start + len(drift.written):]
    page.write_text("\n".join(lines), encoding="utf-8")


def check(pages, fix, binaries, runs):
    kept, status, count, checked = {}, 0, 0, 0
    for page in pages:
        drifts = []
        for table in tables(page):
            if table.spec is None:
                if table.reason is None and has_numbers(table):
                    print(f"{table}: neither a command nor a reason stands above the table")
                    status = 1
                continue
            try:
                source = repr((table.spec.get("run"), table.spec.get("csv")))
                if source not in kept:
                    kept[source] = results(table.spec, binaries, runs)
                for drift in drifted(table, kept[source]):
                    print(f"{os.path.relpath(page, ROOT)}:{drift.line}: {drift.place}: {drift.written}, "
                          f"the runs say {drift.says}", flush=True)
                    drifts += [drift] if drift.column else []
                    status = 1
                count += table.compared
                checked += 1
            except Mistake as mistake:
                print(f"{table}: {mistake}")
                status = 1
            except (SyntaxError, NameError, TypeError, ValueError, OSError) as error:
                print(f"{table}: {type(error).__name__}: {error}")
                status = 1
        if fix and drifts:
            write_anew(page, drifts)
    print(f"{count} numbers in {checked} tables compared" + ("" if status else ": nothing drifts"))
    return status


def main(arguments):
    parser = argparse.ArgumentParser(prog="./dev docs --check", description=__doc__.split("\n")[0])
    parser.add_argument("--list", action="store_true", help="which tables are checked, and why others are not")
    parser.add_argument("--fix", action="store_true", help="write what the runs say in the place of what has drifted")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/bin", help="where breakwater is")
    parser.add_argument("--runs", type=pathlib.Path, default=ROOT / "build/docs/runs",
                        help="where runs are kept; those of the same program, files and keys are not made again")
    parser.add_argument("pages", nargs="*", metavar="FILE", help="these pages alone")
    options = parser.parse_args(arguments)
    for name in options.pages:
        if not pathlib.Path(name).is_file():
            parser.error(f"{name}: there is no such page")
    pages = pages_of(options.pages)
    try:
        return list_tables(pages) if options.list else check(
            pages, options.fix, options.bin.resolve(), options.runs.resolve())
    except Mistake as mistake:
        print(mistake)
        return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
