"""Little memory, of many sizes. The other limits of a machine are in commands.txt.

Usage: machine_limits_test.py BIN_FOLDER
"""

import shutil
import subprocess
import unittest

from called_program import BIN, Folder

STUDY = ["breakwater", "sweep", "cart_position", "--seeds", "1..40", "--duration", "0.2", "--quiet"]


class MachineLimits(Folder):
    def limited(self, mega_bytes, *words, limits=()):
        """Exit status and stderr with this much memory."""
        done = subprocess.run(["prlimit", f"--as={mega_bytes}000000", *limits, BIN / words[0], *words[1:]],
                              cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        return done.returncode, done.stderr

    def test_threads_that_have_no_room_for_their_runs_say_so(self):
        """Stacks of the usual size take all memory, so that some run gets none. With the most memory
        it depends on the thread that comes first whether all runs get theirs: the result is right then."""
        self.call(*STUDY, "--jobs", "1", "--out", "one")
        ends = []
        for mega_bytes in (40, 60, 80, 100, 300):
            status, text = self.limited(mega_bytes, *STUDY, "--jobs", "16", "--out", "many", limits=["--stack=8000000"])
            ends.append(status)
            if status == 0:
                self.assertEqual(*((self.folder / name / "results.csv").read_bytes() for name in ("one", "many")))
                shutil.rmtree(self.folder / "many")
                continue
            self.assertEqual(status, 2, text)
            self.assertRegex(text, r"\A.*memory.*\n\Z")
        self.assertIn(2, ends)

    def test_a_log_that_does_not_fit_is_refused(self):
        found = self.limited(1000000, "arm_wall_contact", "--duration", "1e7", limits=["--cpu=2"])
        said = "run.duration_s: the log of so long a run does not fit in memory: set record.stream=true\n"
        self.assertEqual((*found, *self.folder.iterdir()), (2, said))

    def test_a_study_without_memory_is_no_study_of_refused_runs(self):
        self.call(*STUDY, "--jobs", "1", "--out", "one")
        ends = set()
        for mega_bytes in range(16, 40):  # from too little for the system's loader to enough
            out = f"of_{mega_bytes}_MB"
            status, text = self.limited(mega_bytes, *STUDY, "--jobs", "1", "--out", out)
            with self.subTest(mega_bytes=mega_bytes):
                ends.add(status)
                if status == 0:
                    self.assertEqual(*((self.folder / name / "results.csv").read_bytes() for name in ("one", out)))
                else:
                    self.assertEqual(text.count("\n"), 1, text)
        self.assertLess({0}, ends)
        self.assertLessEqual(ends, {0, 2, 127})

    def test_too_little_memory_is_said(self):
        """Debian's HDF5 crashes where an allocation fails inside it (docs/reliability.md)."""
        ends = set()
        for mega_bytes in range(14, 40):
            status, text = self.limited(mega_bytes, "cart_position", "--duration", "0.2", "--out", "run")
            with self.subTest(mega_bytes=mega_bytes):
                ends.add(status)
                lines = text.count("\n")
                self.assertTrue(lines == int(status > 0) or status < 0 and lines <= 1, text)
                self.assertNotIn("duration", text)
        ends = {status for status in ends if status >= 0}
        self.assertLess({0}, ends)
        self.assertLessEqual(ends, {0, 2, 127})


if __name__ == "__main__":
    unittest.main()
