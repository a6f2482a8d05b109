"""`record.stream`: a killed run leaves a log that any reader of HDF5 opens.

Usage: cut_run_test.py [--study] BIN_FOLDER
"""

import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time
import unittest

import h5py
import numpy as np

from called_program import BIN, Folder, environment

STUDY = "--study" in sys.argv
if STUDY:
    sys.argv.remove("--study")
KILLS = 200 if STUDY else 4
STREAM = ["--quiet", "--set", "record.stream=true"]
ENDLESS = ["motor_estimation", *STREAM, "--duration", "20000", "--out", "run"]


class CutRun(Folder):
    def start(self, *words):
        return subprocess.Popen([BIN / words[0], *words[1:]], cwd=self.folder, text=True,
                                stderr=subprocess.PIPE, env=environment())

    def partial(self, process):
        """The folder of the streamed run, once it has its log."""
        while not (found := [path.parent for path in self.folder.glob(".run.partial-*/kept")]):
            self.assertIsNone(process.poll(), "the run does not begin")
            time.sleep(0.01)
        self.assertEqual(len(found), 1)
        return found[0]

    def rows(self, partial):
        """The number of rows with a time."""
        with h5py.File(partial / "log.h5") as log:
            return int(np.isfinite(log["control/time_s"][:]).sum())

    def grown(self, partial, rows=0):
        """The number of rows once there are more."""
        while (now := self.rows(partial)) <= rows:
            time.sleep(0.01)
        return now

    def cut(self, sent=signal.SIGKILL):
        """The partial folder, the exit status and stderr of a run that got a signal."""
        process = self.start(*ENDLESS)
        partial = self.partial(process)
        self.grown(partial)
        process.send_signal(sent)
        return partial, process.wait(), process.communicate()[1]

    def datasets(self, name):
        found = {}
        with h5py.File(self.folder / name / "log.h5") as log:
            log.visititems(lambda path, data: found.update({path: data[:]})
                           if isinstance(data, h5py.Dataset) else None)
        return {path: data for path, data in found.items() if "index_" not in path}

    def test_a_kill_at_any_time_leaves_a_beginning_of_the_run(self):
        arm = ["arm_wall_contact", "--quiet", "--set", "record.fine_from_s=0", "record.fine_to_s=30"]
        self.call(*arm, "--duration", "40", "--out", "whole")  # from memory
        arm.append("record.stream=true")
        whole = self.datasets("whole")
        self.assertEqual({path.split("/")[0] for path in whole}, {"control", "physics"})
        rng = random.Random(1)
        for _ in range(KILLS):
            process = self.start(*arm, "--duration", "40", "--out", "run")
            partial = self.partial(process)
            time.sleep(rng.uniform(0, 1.2))
            process.kill()
            process.communicate()
            if not partial.exists():
                continue  # it ended before
            part = self.datasets(partial.name)
            self.assertEqual(part.keys(), whole.keys())
            for path, values in part.items():
                rows = int(np.isfinite(part[path.split("/")[0] + "/time_s"]).sum())
                np.testing.assert_array_equal(values[:rows], whole[path][:rows], path)
            self.call("breakwater", "diff", "--quiet", partial.name, "whole", status=1)
            subprocess.run(["rm", "-r", partial], check=True)
            self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["whole"])

    def test_the_log_ends_in_the_last_second(self):
        """A slow run: its rows come from the clock's half second."""
        slow = ["quadrotor_waves", *STREAM, "--case", "mpc-forecast", "--duration", "2000",
                "--out", "run"]
        process = self.start(*slow)
        partial = self.partial(process)
        rows, used_s = 0, []  # the processor time at each write, which other work does not use
        for _ in range(5):
            rows = self.grown(partial, rows)
            fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
            used_s.append((int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"))
        process.kill()
        process.communicate()
        self.assertLess(np.diff(used_s).max(), 1.0)

    def says_that_it_was_cut(self, name):
        said = f"{name}: was cut at "
        for words, code in ((("report", name), 0),
                            (("compare", "whole", name), 0),
                            (("diff", "whole", name), 1)):
            with self.subTest(words[0]):
                _, err = self.call("breakwater", *words, status=code)
                self.assertIn(said, err)
        self.assertIn("This run was cut at ", (self.folder / "report.html").read_text())

    def test_everyone_says_that_it_was_cut(self):
        partial, status, _ = self.cut()
        self.assertEqual(status, -signal.SIGKILL)
        self.assertIn("  cut ", self.call("breakwater", "ls", ".")[0])
        entry, = json.loads(self.call("breakwater", "ls", ".", "--json")[0])
        self.assertEqual((entry["status"], entry["scenario"], entry["seed"], entry["reason"]),
                         ("cut", "motor_estimation", "1", "its process ended before the run did"))
        # The next run does not remove it.
        self.call("motor_estimation", "--quiet", "--duration", "2", "--out", "whole")
        self.call("motor_estimation", "--quiet", "--duration", "2", "--out", "run")
        self.says_that_it_was_cut(partial.name)
        for words in (("replay", partial.name, "--out", "replay.html"),
                      ("still", partial.name, "--at", "0.1", "--out", "still.png"),
                      ("video", partial.name, "--to", "0.1", "--size", "320x240", "--out", "cut.mp4")):
            self.call("breakwater", *words)
        partial.rename(self.folder / "saved")
        self.says_that_it_was_cut("saved")
        with h5py.File(self.folder / "saved/log.h5", "r+") as log:  # killed before the first row
            log["control/time_s"][:] = np.nan
        self.says_that_it_was_cut("saved")

    def test_a_full_disk_leaves_the_log(self):
        (self.folder / "small").mkdir()
        script = f"""mount -t tmpfs -o size=3m none small && cd small && echo mounted || exit
            {BIN}/motor_estimation --quiet --duration 100 --set record.stream=true --out run 2>&1; echo $?
            ls -A; cp -r .run* ../saved"""
        for unshare in (["unshare", "-rm"], ["unshare", "-m"]):
            done = subprocess.run([*unshare, "sh", "-c", script], cwd=self.folder, text=True, capture_output=True)
            if done.stdout.startswith("mounted"):
                break
        else:
            self.skipTest("no file system can be mounted here")
        lines = done.stdout.splitlines()
        self.assertRegex(lines[1], r"^\S*/log.h5: cannot be written \(No space left on device\); its log so far is "
                                   r"in \S*/\.run\.partial-\S*$")
        self.assertEqual(lines[2], "2")
        self.assertRegex(lines[3], r"^\.run\.partial-")
        self.assertGreater(self.rows(self.folder / "saved"), 0)

    def test_a_signal_leaves_the_log(self):
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            partial, status, err = self.cut(sent)
            self.assertEqual(status, 130)
            self.assertEqual(err, f"motor_estimation: interrupted; its log so far is in {partial}\n")
            self.call("breakwater", "report", partial.name)
            partial.rename(self.folder / f"saved-{sent}")

    def test_a_folder_without_its_files_is_refused(self):
        partial, _, _ = self.cut()
        manifest = (partial / "manifest.json").read_text()
        (partial / "manifest.json").write_text(manifest[:100])
        self.assertIn("damaged", self.call("breakwater", "ls", ".")[0])
        (partial / "manifest.json").write_text(manifest)
        (partial / "log.h5").unlink()
        _, err = self.call("breakwater", "report", partial.name, status=2)
        self.assertIn("the run is incomplete: it has no log.h5", err)

    def test_a_complete_run_that_did_not_get_its_name_is_complete(self):
        self.call("motor_estimation", *STREAM, "--duration", "0.5", "--out", "whole")
        partial, _, _ = self.cut()
        for path in (self.folder / "whole").iterdir():
            shutil.copy(path, partial / path.name)
        self.call("breakwater", "diff", "--quiet", partial.name, "whole")
        told = json.loads(self.call("breakwater", "ls", ".", "--json")[0])
        self.assertEqual([entry["status"] for entry in told], ["complete", "complete"])

    def test_is_refused_while_the_run_goes_on(self):
        process = self.start(*ENDLESS)
        partial = self.partial(process)
        self.assertIn("  running ", self.call("breakwater", "ls", ".")[0])
        _, err = self.call("breakwater", "report", partial.name, status=2)
        self.assertEqual(err, f"{partial.name}: a process still writes this run\n")
        process.kill()
        process.communicate()

    def test_memory_does_not_grow_with_the_run(self):
        def peak_kB(duration, *more):
            process = self.start("motor_estimation", "--quiet", "--duration", duration, "--out", "x", *more)
            peak = 0
            while process.poll() is None:
                status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
                if "VmHWM:" in status:  # until it has ended
                    peak = int(status.partition("VmHWM:")[2].split()[0])
                time.sleep(0.002)
            process.communicate()
            self.assertEqual(process.returncode, 0)
            return peak

        # 1 kHz and 29 values: 0.23 MB a second.
        stream = ["--set", "record.stream=true"]
        grown = peak_kB("40", *stream) - peak_kB("10", *stream)
        self.assertLess(grown, 1000)
        self.assertGreater(peak_kB("40") - peak_kB("10"), 5000)


if __name__ == "__main__":
    unittest.main()
