"""Links, tables and their numbers: the checks find errors, and the tree has none. The list of experiments is whole.

Usage: docs_test.py BUILD_BIN_FOLDER WORK_FOLDER
"""

import contextlib
import io
import pathlib
import re
import sys
import tempfile
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts/docs")]
import links  # noqa: E402
import markdown_pages  # noqa: E402
import numbers_of_tables  # noqa: E402
import plain_words  # noqa: E402

BINARIES, WORK = None, None


def said(command, *arguments):
    """Exit status and output lines of a command of scripts/docs."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = command([str(argument) for argument in arguments])
    return status, out.getvalue()


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = pathlib.Path(folder.name) / "page.md"

    def write(self, text):
        self.page.write_text(text, encoding="utf-8")
        return self.page


class Links(Page):
    def test_those_of_the_documentation_hold(self):
        status, text = said(links.main)
        self.assertEqual(status, 0, text)

    def test_a_missing_file_is_found(self):
        status, text = said(links.main, self.write("# A\n\nsee [b](b.md)\n"))
        self.assertEqual(status, 1)
        self.assertIn("page.md:3: b.md: there is no such file", text)

    def test_a_missing_heading_is_found_here_and_on_other_pages(self):
        (self.page.parent / "other.md").write_text("# Other\n\n## What it is\n", encoding="utf-8")
        status, text = said(links.main, self.write(
            "# A b\n[x](#a-b) [y](#b) [z](other.md#what-it-is) [w](other.md#what-it-was)\n"))
        self.assertEqual(status, 1)
        self.assertEqual(re.findall(r": (\S+): there is no such heading", text), ["#b", "other.md#what-it-was"])

    def test_a_picture_needs_words(self):
        (self.page.parent / "a.png").write_bytes(b"")
        self.assertEqual(said(links.main, self.write("![words](a.png)"))[0], 0)
        self.assertEqual(said(links.main, self.write("![](a.png)"))[0], 1)

    def test_code_has_no_links(self):
        self.assertEqual(said(links.main, self.write("`[a](b.md)`\n\n```\n[a](b.md)\n# no heading\n```\n"))[0], 0)

    def test_anchors_are_those_of_a_forge(self):
        # Anchors as GitHub makes them.
        for heading, anchor in [("2.3 The cart, under `predictive` control", "23-the-cart-under-predictive-control"),
                                ("The KFD's start", "the-kfds-start"), ("A – b", "a--b"),
                                ("`a_b` and [c](d.md)", "a_b-and-c")]:
            self.assertEqual(markdown_pages.anchor(heading), anchor)
        self.assertEqual(markdown_pages.anchors("# A\n# A\n"), {"a", "a-1"})


class Thesis(unittest.TestCase):
    """The list of the thesis' experiments, and the tables of its claims."""

    SECTIONS = tomllib.loads((ROOT / "data/experiments.toml").read_text())["section"]
    CELLS = [cell for section in SECTIONS for table in section.get("table", []) for cell in table["cells"]]

    def test_has_every_table_and_figure(self):
        figures = {figure["n"].partition(" ")[0] for section in self.SECTIONS for figure in section.get("figures", [])}
        self.assertGreaterEqual(len(figures), 119)
        # Each printed number and verdict is judged somewhere, except two misprints. There are 56 + 14 of
        # the motor, 6 of the quadrotor, 12 + 8 + 12 and 5 of the cart, 18 + 5 of the arm.
        printed = {cell["printed"] for cell in self.CELLS if "printed" in cell}
        self.assertEqual(len(printed), 134)
        self.assertLessEqual({
            "offset_free.table_2_5.general_mpc.tracking", "cart_estimation.table_4_4.sine.second",
            "cart_estimation.table_4_5.gamma_1_00.response_s_at_least", "cart_estimation.table_4_7.sine.second_order_gamma",
            "motor_estimation.table_4_8.Ts_1e-2.n48[6]", "motor_estimation.table_4_9.variance_1e-4[6]",
            "quadrotor_waves.converges.ekf_none", "arm_wall_contact.force_5N.drac.mean_force_error_N",
            "arm_wall_contact.tuned.force_5N.peak_force_N"}, printed)
        self.assertFalse({"motor_estimation.table_4_8.Ts_1e-2.n48[0]", "motor_estimation.table_4_8.Ts_1e-3.n48[0]"} & printed)

    def test_every_cell_has_a_criterion_and_every_reason_a_cause(self):
        patterns = [re.escape(of).replace(r"\*", ".*")
                    for one in tomllib.loads((ROOT / "data/reproduced.toml").read_text())["class"] for of in one["of"]]
        for cell in self.CELLS:
            with self.subTest(cell):
                self.assertTrue("says" not in cell or "above" in cell or "below" in cell)
                self.assertTrue("printed" not in cell or any(re.fullmatch(one, cell["printed"]) for one in patterns))
                self.assertEqual("why" in cell, "cause" in cell)
        for section in self.SECTIONS:
            self.assertTrue((ROOT / "docs" / section["docs"]).is_file())

    def test_the_tables_of_claims_name_every_section_and_no_other(self):
        """Entries there have names such as "2.4.3.2: which"."""
        rows = []
        for table in (ROOT / "docs/reference/thesis-claims").iterdir():
            head, *lines = table.read_text().splitlines()
            self.assertEqual(head, "section,claim,entry", table)
            rows += lines
        self.assertGreater(len(rows), 120)
        row = r'[234][0-9.]*,.+,"?(none|as |the |beside: |Tables? |[0-9.]+: ).*'
        self.assertEqual([line for line in rows if not re.fullmatch(row, line)], [])
        named = {place for line in rows for place in re.findall(r'(?:,"?|; )([234](?:\.[0-9])+): ', line)}
        self.assertEqual(named, {section["id"] for section in self.SECTIONS})


class PlainWords(unittest.TestCase):
    LONG = "word " * 25

    def test_what_is_found(self):
        for name, text, found in [
                ("a.md", f"{self.LONG}.", []),
                ("a.md", f"one\n{self.LONG}.", ["1: 26 words"]),
                ("a.md", f"Short. {self.LONG}\nmore.", ["1: 26 words"]),
                ("a.md", f"{self.LONG}\n\nmore.", []),
                ("a.md", f"- {self.LONG}\n- more", []),
                ("a.md", f"{self.LONG}`a long command` $x + y$", ["1: 27 words"]),
                ("a.md", f"{self.LONG}[a label](of/a/link.md)", ["1: 27 words"]),
                ("a.md", f"| {self.LONG}{self.LONG} |\n# {self.LONG}{self.LONG}\n```\n{self.LONG}{self.LONG}\n```\n", []),
                ("a.md", f"$$ {self.LONG}{self.LONG} $$\n<!-- {self.LONG}{self.LONG} -->", []),
                ("a.md", "As in Fig. 4.1 and Eq. 2.3, e.g. Of here is no beginning.", []),
                ("a.md", "It runs.\nWhat it does is known. Of it no more.", ["2: begins with “What”", "2: begins with “Of”"]),
                ("a.md", "It runs, of course, as those do. Offset. Whatever.", []),
                ("a.md", "| Of one |", []),
                ("a.md", "A\nbank of\nfilters", ["2: “bank of filters”: multiple-model estimator"]),
                ("a.md", "| in vain |", ["1: “in vain”: ineffective key"]),
                ("a.md", "`vain` and ```vain```", []),
                ("a.h", "int a;  ///< what it counts", ["1: begins with “What”"]),
                ("a.h", f"int a;  ///< {self.LONG}\nint b;  ///< of two,\n        ///< what?", ["2: begins with “Of”"]),
                ("a.h", "// one\n// two. Else\n// three", ["2: begins with “Else”"]),
                ("a.h", f"/// {self.LONG}\n///      A formula of = many {self.LONG}\n/// more", []),
                ("a.h", f"/// {self.LONG}\n///  - more\n", []),
                ("a.cpp", "const char* a = \"Of http://x and 'y'\" \"and more.\";", ["1: begins with “Of”"]),
                ("a.cpp", f'f("{self.LONG}"\n  "more.");', ["1: 26 words"]),
                ("a.cpp", f'f("{self.LONG}\\n\\nmore words and more.");', []),
                ("a.cpp", 'f("vain");  // a name', []),
                ("tests/a.cpp", 'f("Of all of these things");', []),
                ("a.py", '"""Of this module."""\nx = """Of no module."""\n', ["1: begins with “Of”"]),
                ("a.py", "print('Of all of these things')  # else", ["1: begins with “Of”", "1: begins with “Else”"]),
                ("a.toml", "a = '#Of'  # of all\n# these", ["1: begins with “Of”"]),
                ("a.sh", "echo $# 'What'\n# Who", ["2: begins with “Who”"])]:
            with self.subTest(name=name, text=text):
                said = [f"{line}: {what}" for line, what in plain_words.findings(name, text, plain_words.not_said())]
                self.assertEqual([what.partition(" words")[0] + " words" if " words: " in what else what for what in said], found)


class Numbers(Page):
    def test_a_number_holds_if_it_is_the_rounded_one(self):
        for written, measured, holds in [
                ("0.528", 0.52849, True), ("0.528", 0.52851, False), (".10", 0.0951, True), ("−1.5", -1.46, True),
                ("1.5", -1.5, False), ("3·10⁻⁵", 2.6e-5, True), ("3·10⁻⁵", 2.4e-5, False), ("7e-14", 7.4e-14, True),
                ("< 1e-13", -9e-14, True), ("< 1e-13", 2e-13, False), ("1 891", 1891.2, True), ("33.5 %", 33.54, True),
                ("100000", 100001, False), ("2.0", 2.04, True), ("2.00", 2.04, False), ("5", float("nan"), False)]:
            with self.subTest(written=written, measured=measured):
                number, = numbers_of_tables.numbers_in(written)
                self.assertEqual(number.holds(measured), holds)

    def test_cells_with_several_numbers_are_read_in_order(self):
        for cell, values in [("0.063 (0.056–0.069)", [0.063, 0.056, 0.069]), ("**2.000**/−.485", [2, -.485]),
                             ("10 of 10", [10, 10]), ("`x2` never, l3", []), ("4.92 / 5.19", [4.92, 5.19]),
                             ("3.8–4.0 N", [3.8, 4.0]), ("3·10⁴, 10⁵", [3e4, 1e5])]:
            with self.subTest(cell=cell):
                found = [number.value for number in numbers_of_tables.numbers_in(cell)]
                self.assertEqual(len(found), len(values), found)
                for a, b in zip(found, values):
                    self.assertAlmostEqual(a, b, delta=1e-12 * max(1, abs(b)))

    def test_what_is_written_anew_looks_like_what_was_there(self):
        for written, measured, anew in [(".10", .1149, ".11"), ("3·10⁻⁵", 4.2e-6, "4·10⁻⁶"), ("1.0e-2", -0.0234, "−2.3e-2"),
                                        ("23", 24.4, "24"), ("0.528", -0.5, "−0.500")]:
            self.assertEqual(numbers_of_tables.numbers_in(written)[0].instead(measured), anew)

    def test_every_table_of_the_documentation_is_checked_or_says_why_not(self):
        status, text = said(numbers_of_tables.main, "--list")
        self.assertEqual(status, 0, text)
        self.assertGreater(text.count(": checked: "), 20)

    def test_a_new_table_with_numbers_must_say_where_they_come_from(self):
        table = "# A\n\n{}| case | peak N |\n|---|---|\n| a | 1.5 |\n"
        for command in ["--list"], []:
            status, text = said(numbers_of_tables.main, *command, self.write(table.format("")))
            self.assertEqual(status, 1)
            self.assertIn("page.md:3", text)
        status, text = said(numbers_of_tables.main, "--list", self.write(table.format(
            "<!-- numbers not checked: measured on a clock -->\n")))
        self.assertEqual(status, 0)
        self.assertIn("measured on a clock", text)

    def test_tables_of_words_need_nothing(self):
        self.assertEqual(said(numbers_of_tables.main, "--list", self.write(
            "| key | |\n|---|---|\n| `a.b2` | `1`, in words |\n"))[0], 0)

    def check(self, text):
        return said(numbers_of_tables.main, "--bin", BINARIES, "--runs", WORK, self.write(text))

    def test_a_number_that_was_changed_by_hand_is_found(self):
        whole = (ROOT / "docs/explanation/methods/model-predictive-control.md").read_text(encoding="utf-8")
        copy = re.search(r"<!-- numbers\nrun   = \"breakwater sweep cart_offset_free.*?\n\n", whole, re.S)[0]
        status, text = self.check(copy)
        self.assertEqual((status, text.strip()), (0, "12 numbers in 1 tables compared: nothing drifts"))
        changed = copy.replace("−0.639", "−0.640")
        self.assertNotEqual(changed, copy)
        status, text = self.check(changed)
        self.assertEqual(status, 1)
        self.assertIn("−0.640, the runs say −0.639", text)
        status, _ = said(numbers_of_tables.main, "--fix", "--bin", BINARIES, "--runs", WORK, self.page)
        self.assertEqual(self.page.read_text(encoding="utf-8"), copy)

    def test_a_number_where_there_is_none_and_none_where_there_is_one_are_found(self):
        text = ('<!-- numbers\nrun = "breakwater sweep cart_offset_free --case all"\nrows = "case"\n'
                'cells = "settling_time_s"\n-->\n| case | s |\n|---|---|\n| proposed | {} |\n')
        self.assertEqual(self.check(text.format("1.61"))[0], 0)
        self.assertEqual(self.check(text.format("–"))[0], 1)
        self.assertEqual(self.check(text.format("1.61, 2"))[0], 1)

    def test_a_table_that_is_a_csv_file_is_checked_as_any_other(self):
        file = self.page.parent / "times.csv"
        link = "[times](times.csv)<!-- table -->\n"
        comment = ('<!-- numbers\nrun = "breakwater sweep cart_offset_free --case all"\nrows = "case"\n'
                   'cells = "settling_time_s"\n-->\n')
        file.write_text("case,s\nproposed,1.61\n", encoding="utf-8")
        self.assertEqual(said(numbers_of_tables.main, "--list", self.write(link))[0], 1)
        self.assertEqual(self.check(comment + link)[0], 0)
        file.write_text("case,s\nproposed,1.62\n", encoding="utf-8")
        status, text = self.check(comment + link)
        self.assertEqual(status, 1)
        self.assertIn("proposed | s: 1.62, the runs say 1.61", text)

    def test_mistakes_are_one_line(self):
        table = "| case | s |\n|---|---|\n| proposed | 1.61 |\n"
        good = 'run = "breakwater sweep cart_offset_free --case all"\nrows = "case"\ncells = "settling_time_s"\n'
        for wrong, what in [(good.replace("settling_time_s", "settling_s"), "no column “settling_s”"),
                            (good.replace("cells", "cell"), "keys are"),
                            (good.replace('"case"', '"# none"'), "not one number is compared"),
                            (good.replace("all", "nothing"), "exit status 2"),
                            (good.replace("breakwater sweep", "rm"), "is no `breakwater sweep"),
                            (good + 'where = "seed=2"\n', "no run is"),
                            (good.replace('"case"', ""), "Invalid value")]:
            with self.subTest(what=what):
                status, text = self.check(f"<!-- numbers\n{wrong}-->\n{table}")
                self.assertEqual(status, 1)
                self.assertIn(what, text)
                self.assertNotIn("Traceback", text)


if __name__ == "__main__":
    WORK, BINARIES = pathlib.Path(sys.argv.pop()), pathlib.Path(sys.argv.pop())
    unittest.main()
