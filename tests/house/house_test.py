"""Rules of the house: its rooms, its binaries, its mathematics, the code in its pages and the equations that it names.

Usage: house_test.py BUILD_FOLDER
"""

import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv.pop()).resolve()
SRC = ROOT / "src"
SCENARIOS = sorted(path for path in (ROOT / "scenarios").iterdir() if path.is_dir())
BINARIES = sorted((BUILD / "bin").iterdir())

# In ascending order: a room may only include earlier rooms.
ROOMS = ("math linear signals plants observers control world sim record render shell config experiment rigs statistics "
         "recorded study cluster search pictures pages thesis analysis identification program").split()
# Rooms that use only a few of the rooms below them.
KNOW_LITTLE = {
    "math": "", "linear": "math", "signals": "", "plants": "math linear signals", "observers": "math linear signals",
    "world": "math linear signals", "record": "signals", "render": "math linear signals world sim record",
    "shell": "signals record", "config": "math signals record shell",
    "experiment": "math linear signals plants sim record shell config", "statistics": "math"}
# A room for a single feature is not a dependency of other rooms.
WITHOUT = {
    "rigs": "render shell", "recorded": "render", "study": "rigs recorded render", "search": "rigs recorded render",
    "pictures": "rigs recorded study statistics", "pages": "rigs recorded", "thesis": "rigs recorded"}
# Included headers, and the only rooms that may.
HEADERS = {
    "mujoco|mjdata|mjmodel": "sim render", "EGL/|GL/|libav": "render", "tinyxml": "plants",
    "^hdf5": "record", r"toml\+\+": "config study search pictures thesis",
    "CLI/": "shell recorded study cluster pictures pages thesis analysis identification program",
    "nlohmann": "record experiment render study search pictures pages thesis identification program",
    "^ceres/": "identification", "mustache": "pages", "^boost/": "recorded study identification program"}


def files_below(*folders, endings=(".h", ".cpp")):
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*")) if path.suffix in endings]


def includes():
    """(file, room, header) of each, with ROOM/NAME.h for a header of our own."""
    for path in files_below("src"):
        for header in re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(), re.M):
            file = path.relative_to(SRC)
            yield file, file.parts[0] if file.parts[1:] else "", header.removeprefix("breakwater/")


def said(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


class Rule(unittest.TestCase):
    """A test that collects all that is wrong."""

    def none(self, wrong):
        wrong = list(wrong)
        self.assertEqual(wrong, [], "\n".join(map(str, wrong)))


class Rooms(Rule):
    def test_they_depend_one_way(self):
        allowed = {room: KNOW_LITTLE[room].split() if room in KNOW_LITTLE else ROOMS[:i] for i, room in enumerate(ROOMS)}
        found = list(includes())
        self.assertGreater(len(found), 100)
        self.none(f"{file} includes {header}" for file, room, header in found
                  if room not in allowed or
                  (target := header.partition("/")[0]) in ROOMS and target != room and target not in allowed[room])

    def test_their_table_has_their_order(self):
        table = (ROOT / "docs/explanation/architecture.md").read_text()
        self.assertEqual(re.findall(r"^\| `(\w+)/` \|", table, re.M), ROOMS[::-1])

    def test_they_leave_out_what_they_do_not_need(self):
        self.none(f"{file} includes {header}" for file, room, header in includes()
                  if header.partition("/")[0] in WITHOUT.get(room, "").split())

    def test_engine_and_file_formats_stay_in_theirs(self):
        self.none(f"{file} includes {header}" for file, room, header in includes()
                  for pattern, rooms in HEADERS.items() if re.search(pattern, header) and room not in rooms.split())

    def test_the_lowest_include_only_eigen(self):
        self.none(f"{file} includes {header}" for file, room, header in includes()
                  if room in ("math", "linear", "signals") and ("/" in header or ".h" in header)
                  and not header.startswith(("Eigen/", "unsupported/Eigen/", "math/", f"{room}/")))

    def test_none_names_a_scenario(self):
        # "plant" is also a word of the field, and "two_inertia" a model that identification fits.
        special = {"plant": '"plant"', "two_inertia": "scenarios/two_inertia"}
        words = [special.get(folder.name, folder.name) for folder in SCENARIOS]
        self.none(f"{path}: {word}" for path in sorted(SRC.rglob("*")) if path.is_file()
                  for word in words if word.encode() in path.read_bytes())

    def lines(self, is_wrong, *spared):
        files = [path for path in files_below("src", "scenarios") if not str(path.relative_to(ROOT)).startswith(spared)]
        self.assertGreater(len(files), 100)
        self.none(f"{path}: {line}" for path in files for line in path.read_text().splitlines() if is_wrong(line))

    def test_the_engines_names_are_used_in_sim_render_and_rigs_alone(self):
        def names_the_engine(line):
            return re.search(r"\bmj(Model|Data|Option|Contact|VFS|cb|[duvprst]?_|t[A-Z]|[A-Z]{2,}_?)",
                             line.partition("//")[0])
        for line in ("  sim.model().id(mjOBJ_GEOM, name)", "const mjData& data, mjtNum x, mju_copy(x), mj_step(m, d)"):
            self.assertTrue(names_the_engine(line))
        self.assertFalse(names_the_engine('bind_model(fields, mjcf_); "model.mjcf"  // as mj_loadXML'))
        self.lines(names_the_engine, "src/sim/", "src/render/", "src/rigs/")

    def test_the_environment_is_read_in_one_place(self):
        def reads_it(line):
            return re.search(r"(?<!fe)getenv\(", line)
        self.assertTrue(reads_it("std::getenv(name)"))
        self.assertFalse(reads_it("std::fegetenv(&environment)"))
        self.lines(reads_it, "src/signals/environment.h")

    def test_every_scenario_has_its_folder(self):
        for folder in SCENARIOS:
            self.assertTrue((folder / f"{folder.name}.toml").exists(), folder)
            # The model and the duration of "plant" are the user's. Without a list, pictures show them whole.
            self.assertEqual((folder / "shots.toml").exists(), folder.name != "plant", folder)

    def test_scenarios_are_built_like_a_users_scenario(self):
        rules = (ROOT / "scenarios/CMakeLists.txt").read_text()
        self.assertNotIn("add_executable(", rules)
        self.assertIn("breakwater_program(${scenario} ONE_SCENARIO", rules)

    def test_tests_have_names_that_can_be_read_and_typed(self):
        names = re.findall(r"^ *Test +#\d+: (.*)$", said("ctest", "--test-dir", BUILD, "-N"), re.M)
        self.assertGreater(len(names), 100)
        self.none(name for name in names if not re.fullmatch(r"[A-Za-z0-9_./-]+", name))


class Binaries(Rule):
    # An empty entry in a run path is the working folder: whoever can write there could run code. The libraries
    # would be loaded at every start, before a program prints anything, and few commands use them.
    def test_they_have_no_run_path_and_no_library_that_few_commands_use(self):
        self.assertGreaterEqual(len(BINARIES), 9)
        for program in BINARIES:
            section = said("readelf", "--dynamic", "--wide", program)
            self.assertIn("(NEEDED)", section, program)
            for word in ("RUNPATH", "RPATH", "libav", "libcairo", "libhdf5", "libnlopt", "libpagmo", "libtbb"):
                self.assertNotIn(word, section, program)


# glibc has one implementation of these, or all give the exact result. hypot and cabs are made of square roots,
# products and sums. fegetenv and fesetenv compute nothing.
SAME_EVERYWHERE = set(
    "ceil copysign fabs floor fma fmax fmin fmod frexp ldexp llrint llround lrint lround lroundf modf nearbyint nextafter "
    "remainder rint round scalbn sqrt sqrtf sqrtl trunc hypot cabs cabsl fegetenv fesetenv ilogb".split())
# render and pages only draw and write finished runs. record only writes.
STATE_CODE = ("math linear plants observers control world sim record experiment rigs published quadrotor statistics study "
              "axes_scenarios scenarios").split()
ONLY_DRAW = {"atan2f", "sincosf", "sinf", "tanf"}  # by MuJoCo


def symbols(*words):
    """The last word of each line of nm's output, without the symbol's version."""
    return {line.split()[-1].partition("@")[0] for line in said("nm", *words).splitlines() if line.split()}


class Mathematics(Rule):
    """Functions of the C library that code for the simulation's state may call."""

    @classmethod
    def setUpClass(cls):
        cls.program = BUILD / "bin/breakwater"
        cls.libraries = dict(re.findall(r"(\S+?)\.so\S* => (\S+)", said("ldd", cls.program)))
        cls.processor_dependent = symbols("-D", "--defined-only", cls.libraries["libm"]) - SAME_EVERYWHERE

    def test_state_code_calls_no_processor_dependent_function(self):
        self.assertLessEqual({"sin", "pow", "cexp"}, self.processor_dependent)
        for room in STATE_CODE:
            folder = "scenarios" if room.endswith("scenarios") else "src"
            called = symbols("--undefined-only", BUILD / folder / f"libbreakwater_{room}.a")
            self.assertTrue(called, room)
            self.none(f"{room} calls {name}: take math/functions.h's" for name in called & self.processor_dependent)

    def test_each_processor_dependent_function_of_mujoco_is_redirected(self):
        called = symbols("-D", "--undefined-only", self.libraries["libmujoco"])
        redirected = said("bash", "-c", f"{self.program} doctor; true")
        names = re.search(r"MuJoCo \S+\s+with\s+our\s+((?:\w+,\s+)*\w+)", redirected)[1]
        self.assertEqual(set(re.findall(r"\w+", names)), called & self.processor_dependent - ONLY_DRAW)


class Pages(Rule):
    def pages(self):
        return [(path, path.read_text()) for path in files_below("docs", endings=(".md",))]

    def test_a_block_behind_the_name_of_a_file_is_a_part_of_it(self):
        """The file is a test or a template, which the install tests build and run."""
        blocks = 0
        for path, page in self.pages():
            found = re.findall(r"<!-- ((?:templates|tests)/\S+) -->\n```[a-z]*\n([^`]*)```", page)
            self.assertEqual(len(re.findall("<!-- (?:templates|tests)/", page)), len(found), f"{path}: a mark without a block")
            self.none(f"{path}: not in {file}:\n{code}" for file, code in found if code not in (ROOT / file).read_text())
            blocks += len(found)
        self.assertGreater(blocks, 15)

    def test_named_headers_exist(self):
        """Users of the libraries need no files of src/: the included headers are installed."""
        self.none(f"{path} names {header}" for path, page in self.pages()
                  for header in re.findall(r"<breakwater/([a-z_]+/[a-z_]+\.h)>", page) if not (SRC / header).exists())


PAGE = ROOT / "docs/reference/from-equation-to-code.md"
LAST = {2: 93, 3: 31, 4: 27}  # equation of each chapter
NUMBER = r"([2-9])\.([0-9]+)(?!\.?[0-9])"  # not a section's number
NEXT = re.compile("(–|-| to |, and |, |; | and | or )" + NUMBER)


def read_list(text, at=0):
    """The equations of a list at a position, such as "2.4", "2.1–2.3" or "2.9, 2.10 and 4.1–4.4", and its end."""
    match, equations = re.compile("()" + NUMBER).match(text, at), []
    while match:
        equation = (int(match[2]), int(match[3]))
        if match[1] in ("–", "-", " to "):
            before = equations[-1]
            assert before[0] == equation[0] and before[1] < equation[1], f"no range: {before} to {equation}"
            equations += [(before[0], number) for number in range(before[1] + 1, equation[1])]
        equations.append(equation)
        at = match.end()
        match = NEXT.match(text, at)
    return equations, at


def named(source):
    """All equations that a text names by "Eq." or "Eqs.". A list may continue in the next line of a comment."""
    text = re.sub(r"[ \t]*\r?\n[ \t]*(///?<?|#)?[ \t]*", " ", source)
    return {equation for mark in re.finditer(r"\bEqs?\. ", text) for equation in read_list(text, mark.end())[0]}


class Equations(Rule):
    """The page of equations and the numbers in comments agree.

    A line that begins with equations is a row of a table with links to code, or an item of a list. An item explains
    why there is no code.
    """

    @classmethod
    def setUpClass(cls):
        """Tables are CSV files. Links in their cells start at the page."""
        tables = re.findall(r"\]\(([^()]+\.csv)\)<!-- table -->", PAGE.read_text())
        cls.files = [PAGE, *(PAGE.parent / table for table in tables)]
        cls.rows, cls.items = [], []  # (place, equations, code)
        for file in cls.files:
            for number, line in enumerate(file.read_text().splitlines(), 1):
                is_row, quoted = file != PAGE, line.startswith('"')
                if not is_row and not line.startswith("- "):
                    continue
                equations, end = read_list(line, quoted if is_row else 2)
                if not equations:
                    continue  # a table's head
                place = f"{file.name}:{number}"
                behind = '",' if quoted else "," if is_row else ": "
                assert line.startswith(behind, end), f"{place}: what follows the equations?"
                code = re.findall(r"\]\((?:\.\./)+((?:src|scenarios)/[^)#]+)\)", line)
                (cls.rows if is_row else cls.items).append((place, equations, code))

    def test_they_are_parsed_as_written(self):
        for text, found in (
                ("/// (Eq. 2.6): 0.5, 2.4", [(2, 6)]),
                ("// Eqs. 2.60–2.62, or Eqs. 3.7-3.9.", [(2, 60), (2, 61), (2, 62), (3, 7), (3, 8), (3, 9)]),
                ("(Eqs. 2.3, 2.54, 2.55)", [(2, 3), (2, 54), (2, 55)]),
                ("Eqs. 3.3 and 3.4, 4.1 to 4.3; 4.10", [(3, 3), (3, 4), (4, 1), (4, 2), (4, 3), (4, 10)]),
                ("  /// as Eqs. 2.71,\n  /// 2.72 say\n# Eq. 2.7\n# 3.5 kg", [(2, 7), (2, 71), (2, 72)]),
                ("the thesis' 2.4.3, and 4.2; Eq. 2.4.3, Eq. 2.5.1", [])):
            self.assertEqual(sorted(named(text)), found, text)

    def test_the_page_has_each_of_the_thesis_once(self):
        listed = [equation for _, equations, _ in self.rows + self.items for equation in equations]
        self.assertEqual(sorted(listed), [(chapter, n) for chapter, last in LAST.items() for n in range(1, last + 1)])

    def test_the_files_of_a_row_name_its_equations(self):
        self.none(place for place, _, code in self.items if code)
        self.none(place for place, _, code in self.rows if not code)
        self.none(f"{place}: {file} lacks Eq. {equation}" for place, equations, code in self.rows for file in code
                  for equation in set(equations) - named((ROOT / file).read_text()))
        self.assertGreater(len(self.rows), 50)

    def test_each_in_the_code_has_a_row(self):
        in_rows = {equation for _, equations, _ in self.rows for equation in equations}
        found = {path: named(path.read_text()) for path in files_below("src", "scenarios", endings=(".h", ".cpp", ".toml"))}
        self.none(f"{path} names Eq. {equation}" for path, there in found.items() for equation in there - in_rows)
        self.assertGreater(sum(map(bool, found.values())), 30)

    def test_the_pages_links_lead_somewhere(self):
        self.none(f"{file}: {link}" for file in self.files
                  for link in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", file.read_text())
                  if not (PAGE.parent / link).exists())


if __name__ == "__main__":
    unittest.main()
