"""chaos.py finds a missing fsync and an unchecked write in the real programs, and nothing without them.

Usage: planted_test.py BUILD_FOLDER
"""

import pathlib
import subprocess
import sys
import unittest

BUILD = sys.argv.pop()
CHAOS = pathlib.Path(__file__).with_name("chaos.py")
# The run's folder, and a page of a single file.
CUT = ["--workload", "run", "--faults", "end:1:cut"]
TORN = ["--workload", "report", "--faults", "write:1:ENOSPC"]


class PlantedDefects(unittest.TestCase):
    def chaos(self, *words):
        done = subprocess.run([sys.executable, CHAOS, BUILD, "--jobs", "1", *words], capture_output=True, text=True)
        return done.returncode, done.stdout

    def found(self, defect, *words):
        status, said = self.chaos("--planted", defect, *words)
        self.assertEqual(status, 1, said)
        self.assertEqual(self.chaos(*words)[0], 0)
        return said

    def test_a_missing_fsync_is_found(self):
        self.assertIn("run is neither the earlier one nor the new one", self.found("no_fsync", "--seeds", "1..8", *CUT))

    def test_a_write_that_is_not_checked_is_found(self):
        said = self.found("unchecked_write", "--seeds", "1..1", *TORN)
        self.assertIn("status 0, and report.html is another one", said)
        # The line below names the fault that shows it again.
        self.assertIn("./dev chaos --seeds 1..1 --workload report --faults write:", said)

    def test_the_fault_that_has_no_part_in_it_is_left_out(self):
        status, said = self.chaos("--planted", "unchecked_write", "--seeds", "1..1", "--workload", "report",
                                  "--faults", "clock:1:step7,write:1:ENOSPC")
        self.assertEqual(status, 1)
        self.assertIn("--faults write:1:ENOSPC --planted unchecked_write\n", said)


if __name__ == "__main__":
    unittest.main()
