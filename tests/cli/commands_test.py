"""Commands, as a user calls them: a table of refusals.txt or commands.txt, which say what their rows mean.

Usage: commands_test.py BIN_FOLDER FILE TABLE
"""

import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv[1]).resolve()
# A build without optimisation may take longer.
AT_ONCE_S = 5.0 if "CMAKE_BUILD_TYPE:STRING=Debug" in (BIN.parent / "CMakeCache.txt").read_text() else 1.0


def table_of(file, wanted):
    """The heading of a table and its rows: (number of the line, cells)."""
    heading, rows, name = "", [], None
    for number, line in enumerate((ROOT / file).read_text().splitlines(), 1):
        if head := re.match(r"\[([A-Z]\w*)\] ?(.*)", line):
            name = head[1]
        if name == wanted and line and line[0] != "#":
            if head:
                heading = head[2]
            elif line.startswith("+ "):
                heading += line[1:]
            else:
                rows.append((number, ["" if cell == "-" else cell for cell in line.split(" | ")]))
    assert rows, f"{file} has no table {wanted}"
    return heading, rows


class Table:
    def __init__(self, heading, folder):
        self.heading, self.folder, self.file, self.begin, self.wrong = heading, folder, "", "", []

    def expect(self, holds, *said):
        if not holds:
            self.wrong.append((*self.at, *(str(one)[:4000] for one in said)))

    def source_of(self, name):
        own = self.folder / name
        return ROOT / name.removeprefix("PROJECT/") if name.startswith("PROJECT/") or not own.exists() else own

    def filled(self, text):
        """The text with LINE(FILE: TEXT) and REPEAT(N, TEXT) replaced."""
        def number_of(match):
            lines = self.source_of(match[1]).read_text().splitlines()
            return str(next(number for number, line in enumerate(lines, 1) if match[2] in line))
        text = re.sub(r"LINE\(([^:)]*): ([^)]*)\)", number_of, text)
        return re.sub(r"REPEAT\((\d+), ([^)]*)\)", lambda match: match[2] * int(match[1]), text)

    def whole(self, text):
        """The same for a command, the text of a file, or a part of an output."""
        text = self.filled(text)
        for short, long in (("\\n", "\n"), ("\\t", "\t"), ("HERE", str(self.folder)), ("BIN/", f"{BIN}/"),
                            ("TEST/", f"{BIN.parent}/tests/"), ("PROJECT/", f"{ROOT}/")):
            text = text.replace(short, long)
        return text

    def run(self, command):
        """Status, outputs and processor time [s]. Blanks separate the words, except between '…'."""
        words = ["".join(part[1:-1] if part[:1] == "'" else part for part in re.findall("'[^']*'|[^ ']+", word))
                 for word in re.findall(r"(?:'[^']*'|[^ '])+", command)]
        program = BIN / words[0]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([program if program.exists() else BIN.parent / "tests" / words[0], *words[1:]], cwd=self.folder,
                              stdin=subprocess.DEVNULL, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        status = done.returncode if done.returncode >= 0 else 128 - done.returncode
        out, err = (output.decode(errors="surrogateescape") for output in (done.stdout, done.stderr))
        return status, out, err, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def command_of(self, own):
        """The heading stands before each command, except before the absolute path of a program."""
        return self.whole(own if own.startswith("/") or not self.heading else f"{self.heading} {own}".rstrip(" ")
                          if own not in ("", "-") else self.heading)

    def write(self, name, text):
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / name).write_text(text)

    def prepare(self, what, name, *cells):
        if what == "run":
            status, _, err, _ = self.run(self.whole(name))
            assert status == (int(cells[0]) if cells else 0), (name, status, err)
        elif what == "folder":
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        elif what == "remove":
            path = self.folder / name
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
        elif what == "write":
            self.write(name, self.whole(cells[0]))
        elif what == "file":
            self.file, self.begin = name, cells[0]
        else:
            text, old = self.source_of(cells[0]).read_text(), self.whole(cells[1])
            assert old in text, f"{cells[0]} has no {old}"
            begin, _, rest = text.partition(old)
            self.write(name, begin + self.whole(cells[2]) + (rest if what == "copy" else ""))

    def entries(self, name="."):
        folder = self.folder / name
        return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))

    def content_of(self, where, result):
        _, out, err, _ = result
        if where in ("out", "err", "both"):
            return {"out": out, "err": err, "both": err + out}[where]
        if where.startswith("hash:"):
            return re.search('"state_hash": "(.*?)"', (self.folder / where[5:] / "manifest.json").read_text())[1]
        is_there = (self.folder / where).is_file()
        self.expect(is_there, f"there is no {where}")
        return (self.folder / where).read_bytes().decode(errors="surrogateescape") if is_there else ""

    def check(self, check, result):
        where, verb, *text = check.split(" ", 2)
        text = text[0] if text else ""
        if verb in ("exists", "absent"):
            return self.expect((self.folder / where).exists() == (verb == "exists"), check)
        if verb == "holds":
            return self.expect(self.entries(where) == text.split(), check, self.entries(where))
        content, whole = self.content_of(where, result), self.whole(text)
        if verb == "has":
            at = 0
            for part in map(self.whole, text.split(" … ")):
                place = content.find(part, at)
                self.expect(place >= 0, check, part, content)
                at = place + len(part)
        elif verb in ("equals", "differs"):
            self.expect((content == self.content_of(text, result)) == (verb == "equals"), check, content)
        else:
            holds = {"lacks": lambda: whole not in content, "begins": lambda: content.startswith(whole),
                     "is": lambda: content == (whole and whole + "\n"), "lines": lambda: len(content.splitlines()) == int(text)}
            self.expect(holds[verb](), check, content)

    def refuse(self, command, status, line):
        before = self.entries()
        code, out, err, seconds = self.run(command)
        err = err.replace(str(self.folder), "HERE").replace(f"{ROOT}/", "PROJECT/")
        self.expect(code == status and out == "", command, code, out, err)
        self.expect(err.startswith(line[:-1]) and err.count("\n") == 1 if line.endswith("…") else err == line + "\n", command, err)
        self.expect(seconds < AT_ONCE_S, command, f"takes {seconds} s")
        self.expect(self.entries() == before, command, "something was left behind")

    def row(self, cells):
        first = cells[0]
        if first.startswith("! "):
            self.prepare(first[2:], *cells[1:])
        elif first.startswith("> "):
            command = self.command_of(first[2:])
            result = self.run(command)
            self.expect(result[0] == int(cells[1]), command, *result)
            for check in cells[2:]:
                self.check(check, result)
        else:
            _, status, line = cells
            if first.startswith("< "):
                self.write(self.file, self.whole(self.begin + first[2:]))
                first = ""
            self.refuse(self.command_of(first), int(status), self.filled(line))


def main():
    file, name = sys.argv[2:]
    heading, rows = table_of(file, name)
    with tempfile.TemporaryDirectory(prefix=f"breakwater_test_{os.getpid()}_") as folder:
        table = Table(heading, pathlib.Path(folder))
        for number, cells in rows:
            table.at = (f"{file}:{number}", " | ".join(cells)[:300])
            table.row(cells)
    for one in table.wrong:
        print(*one, sep="\n  ")
    return 1 if table.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
