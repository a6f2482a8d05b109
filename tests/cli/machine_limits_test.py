"""Limits of a machine: full devices, files that cannot grow, little memory.

Usage: machine_limits_test.py BIN_FOLDER [--study]
"""

import os
import resource
import shutil
import subprocess
import sys
import unittest

from called_program import BIN, Folder

STEP_MB = 8 if "--study" in sys.argv else 24
if "--study" in sys.argv:
    sys.argv.remove("--study")

STUDY = ["breakwater", "sweep", "cart_position", "--seeds", "1..40", "--duration", "0.2", "--quiet"]


class MachineLimits(Folder):
    def limited(self, *words, stdout=os.devnull, stderr=None, limits={}):
        """Exit status and stderr."""
        def set_limits():
            for kind, most in limits.items():
                resource.setrlimit(kind, most if isinstance(most, tuple) else (most, most))
        with open(stdout, "w") as out, open(stderr or self.folder / "stderr", "w") as err:
            done = subprocess.run([BIN / words[0], *words[1:]], cwd=self.folder, stdout=out, stderr=err,
                                  preexec_fn=set_limits)
        text = "" if stderr else (self.folder / "stderr").read_text()
        (self.folder / "stderr").unlink(missing_ok=True)
        return done.returncode, text

    def test_standard_output_that_cannot_be_written_is_status_4(self):
        self.call("cart_position", "--quiet", "--duration", "0.2", "--out", "made")
        for words in (["breakwater", "list"], ["breakwater", "--help"], ["breakwater", "ls", "."],
                      ["breakwater", "run", "arm_wall_contact", "--print-config"],
                      ["breakwater", "run", "quadrotor_waves", "--list-cases"], ["breakwater", "--version"],
                      ["cart_position", "--duration", "0.2", "--out", "run"],
                      ["breakwater", "compare", "made", "made"], ["breakwater", "report", "made"]):
            with self.subTest(words=words):
                self.assertEqual(self.limited(*words, stdout="/dev/full"), (
                    4, "standard output: cannot be written (No space left on device)\n"))
        self.assertTrue((self.folder / "run" / "manifest.json").exists())

    def test_standard_error_that_cannot_be_written_leaves_the_status(self):
        self.assertEqual(self.limited("cart_position", "--case", "nosuch", stderr="/dev/full")[0], 2)

    def test_a_file_that_may_not_grow_is_as_on_a_full_disk(self):
        self.call("cart_position", "--quiet", "--duration", "0.2", "--out", "run")
        before = (self.folder / "run" / "log.h5").read_bytes()
        for out in ("run", "deep/fresh"):
            with self.subTest(out=out):
                status, text = self.limited("cart_position", "--duration", "5", "--out", out,
                                            limits={resource.RLIMIT_FSIZE: 20_000})
                self.assertEqual(status, 2)
                self.assertRegex(text, r"\A.*log\.h5: cannot be written \(File too large\)\n\Z")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["run"])
        self.assertEqual((self.folder / "run" / "log.h5").read_bytes(), before)
        status, text = self.limited("breakwater", "report", "run", "--out", "page",
                                    limits={resource.RLIMIT_FSIZE: 20_000})
        self.assertEqual(status, 2)
        self.assertRegex(text, r"\A.*report\.html: cannot be written \(File too large\)\n\Z")
        self.assertEqual(list((self.folder / "page").iterdir()), [])

    def test_fewer_threads_do_the_work_where_there_is_no_room_for_their_stacks(self):
        """Two stacks of 600 MB fit into the memory, a third one does not."""
        self.call(*STUDY, "--jobs", "1", "--out", "one")
        status, text = self.limited(*STUDY, "--jobs", "16", "--out", "many",
                                    limits={resource.RLIMIT_STACK: 600_000_000,
                                            resource.RLIMIT_AS: 1_800_000_000})
        self.assertEqual(status, 0, text)
        self.assertNotIn("memory", text)
        self.assertEqual(*((self.folder / name / "results.csv").read_bytes() for name in ("one", "many")))

    def test_threads_that_have_no_room_for_their_runs_say_so(self):
        """Stacks of the usual size take all memory, so that some run gets none. With the most memory
        it depends on the thread that comes first whether all runs get theirs: the result is right then."""
        self.call(*STUDY, "--jobs", "1", "--out", "one")
        ends = []
        for mega_bytes in (40, 60, 80, 100, 300):
            status, text = self.limited(*STUDY, "--jobs", "16", "--out", "many",
                                        limits={resource.RLIMIT_STACK: 8_000_000,
                                                resource.RLIMIT_AS: mega_bytes * 1_000_000})
            ends.append(status)
            if status == 0:
                self.assertEqual(*((self.folder / name / "results.csv").read_bytes() for name in ("one", "many")))
                shutil.rmtree(self.folder / "many")
                continue
            self.assertEqual(status, 2, text)
            self.assertRegex(text, r"\A.*memory.*\n\Z")
        self.assertIn(2, ends)

    def test_a_study_without_memory_is_no_study_of_refused_runs(self):
        self.call(*STUDY, "--jobs", "1", "--out", "one")
        ends = set()
        for mega_bytes in range(24, 380, STEP_MB):
            out = f"of_{mega_bytes}_MB"
            status, text = self.limited(*STUDY, "--jobs", "1", "--out", out,
                                        limits={resource.RLIMIT_AS: mega_bytes * 1_000_000})
            with self.subTest(mega_bytes=mega_bytes):
                ends.add(status == 0)
                if status != 0:
                    self.assertIn(status, (2, 127), text)
                    self.assertEqual(text.count("\n"), 1, text)
                else:
                    self.assertEqual(*((self.folder / name / "results.csv").read_bytes() for name in ("one", out)))
        self.assertEqual(ends, {True, False})

    def test_files_are_opened_up_to_the_hard_limit_and_their_lack_is_named(self):
        study = [*STUDY, "--keep", "all", "--jobs", "16", "--out"]
        status, text = self.limited(*study, "few", limits={resource.RLIMIT_NOFILE: 8})
        self.assertEqual(status, 2)
        self.assertRegex(text, r"\A.*\(Too many open files\)\n\Z")
        status, text = self.limited(*study, "many", limits={resource.RLIMIT_NOFILE: (8, 1000)})
        self.assertEqual(status, 0, text)
        self.assertNotIn("refused", (self.folder / "many" / "results.csv").read_text())

    def test_too_little_memory_is_said(self):
        for mega_bytes in range(40, 200, 10):
            status, text = self.limited("cart_position", "--duration", "0.2", "--out", "run",
                                        limits={resource.RLIMIT_AS: mega_bytes * 1_000_000})
            with self.subTest(mega_bytes=mega_bytes):
                if status == 127 or "loading shared libraries" in text:
                    continue  # too little for the system's loader
                self.assertIn(status, (0, 2), text)
                self.assertEqual(text.count("\n"), 1 if status == 2 else 0, text)
                self.assertNotIn("duration", text)


if __name__ == "__main__":
    unittest.main()
