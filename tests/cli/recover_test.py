"""`record.stream` and `recover`: a killed run leaves its log, up to the last second.

Usage: recover_test.py [--study] BIN_FOLDER
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

from called_program import BIN, FAILS, Folder, environment

STUDY = "--study" in sys.argv
if STUDY:
    sys.argv.remove("--study")
KILLS = 200 if STUDY else 4
STREAM = ["--quiet", "--set", "record.stream=true"]
ENDLESS = ["motor_estimation", *STREAM, "--duration", "20000", "--out", "run"]


class Recovery(Folder):
    def start(self, *words):
        return subprocess.Popen([BIN / words[0], *words[1:]], cwd=self.folder, text=True,
                                stderr=subprocess.PIPE, env=environment())

    def partial(self, process):
        """The folder of the streamed run, once it can be recovered."""
        while not (found := [path.parent for path in self.folder.glob(".run.partial-*/running.json")]):
            self.assertIsNone(process.poll(), "the run does not begin")
            time.sleep(0.01)
        self.assertEqual(len(found), 1)
        return found[0]

    def grown(self, journal, size=0):
        """The size of the journal once it is larger. It grows with each block."""
        while not (journal.exists() and journal.stat().st_size > size):
            time.sleep(0.01)
        return journal.stat().st_size

    def cut(self, sent=signal.SIGKILL):
        """The partial folder, the exit status and stderr of a run that got a signal."""
        process = self.start(*ENDLESS)
        partial = self.partial(process)
        self.grown(partial / "log.journal", self.grown(partial / "log.journal"))  # after some samples
        process.send_signal(sent)
        return partial, process.wait(), process.communicate()[1]

    def datasets(self, name):
        found = {}
        with h5py.File(self.folder / name / "log.h5") as log:
            log.visititems(lambda path, data: found.update({path: data[:]})
                           if isinstance(data, h5py.Dataset) else None)
        return {path: data for path, data in found.items() if "index_" not in path}

    def test_a_kill_at_any_time_leaves_a_beginning_of_the_run(self):
        arm = ["arm_wall_contact", *STREAM, "--set", "record.fine_from_s=0", "record.fine_to_s=30"]
        self.call(*arm, "--duration", "40", "--out", "whole")
        whole = self.datasets("whole")
        self.assertEqual({path.split("/")[0] for path in whole}, {"control", "physics"})
        rng = random.Random(1)
        for _ in range(KILLS):
            process = self.start(*arm, "--duration", "40", "--out", "run")
            partial = self.partial(process)
            time.sleep(rng.uniform(0, 0.6))
            process.kill()
            process.communicate()
            if not partial.exists():
                continue  # it ended before
            self.call("breakwater", "recover", partial.name)
            part = self.datasets("run")
            for path, values in part.items():
                np.testing.assert_array_equal(values, whole[path][:len(values)], path)
                rows = len(part[path.split("/")[0] + "/time_s"])
                self.assertEqual(len(values), rows)
            manifest = json.loads((self.folder / "run/manifest.json").read_text())
            self.assertEqual(manifest["status"], "cut")
            self.assertEqual(manifest["time_s"], part["control/time_s"][-1])
            self.call("breakwater", "diff", "--quiet", "run", "whole", status=1)
            subprocess.run(["rm", "-r", self.folder / "run"], check=True)
            self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["whole"])

    def test_the_log_ends_in_the_last_second(self):
        """A slow run: its rows come from the clock's half second."""
        slow = ["quadrotor_waves", *STREAM, "--case", "mpc-forecast", "--duration", "2000",
                "--out", "run"]
        process = self.start(*slow)
        partial = self.partial(process)
        size, used_s = 0, []  # the processor time at each block, which other work does not use
        for _ in range(5):
            size = self.grown(partial / "log.journal", size)
            fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
            used_s.append((int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"))
        process.kill()
        process.communicate()
        self.assertLess(np.diff(used_s).max(), 1.0)

    def test_everyone_says_that_it_was_cut(self):
        partial, status, _ = self.cut()
        self.assertEqual(status, -signal.SIGKILL)
        out, _ = self.call("breakwater", "ls", ".")
        self.assertIn("  cut ", out)
        self.assertIn(f"breakwater recover ./{partial.name}", " ".join(out.split()))
        _, err = self.call("breakwater", "report", partial.name, status=2)
        self.assertTrue(err.endswith(f"its log so far is kept: breakwater recover {partial.name}\n"), err)
        entry, = json.loads(self.call("breakwater", "ls", ".", "--json")[0])
        self.assertEqual((entry["status"], entry["scenario"], entry["seed"]),
                         ("cut", "motor_estimation", "1"))
        # Neither the next run nor rm removes it.
        self.call("motor_estimation", "--quiet", "--duration", "2", "--out", "run")
        self.assertIn("recover it, or delete the folder",
                      self.call("breakwater", "rm", "--failed", ".")[0].replace("\n", " "))
        _, err = self.call("breakwater", "recover", partial.name, status=2)
        self.assertEqual(err, "run: is there already: give another folder with --out\n")
        out, _ = self.call("breakwater", "recover", partial.name + "/", "--out", "saved")
        self.assertRegex(out, r"^recovered [0-9.]+ s of the run, which has no metrics\nresults: saved\n$")
        self.assertFalse(partial.exists())
        self.assertFalse((self.folder / "saved/metrics.json").exists())

        said = "saved: was cut at "
        told = {entry["folder"]: entry for entry in
                json.loads(self.call("breakwater", "ls", ".", "--json")[0])}
        self.assertEqual(told["./saved"]["status"], "cut")
        self.assertTrue(told["./saved"]["reason"].startswith("at "))
        for words, code in ((("report", "saved"), 0),
                            (("replay", "saved", "--out", "replay.html"), 0),
                            (("still", "saved", "--at", "0.1", "--out", "still.png"), 0),
                            (("video", "saved", "--to", "0.1", "--size", "320x240", "--out", "cut.mp4"), 0),
                            (("compare", "run", "saved"), 0),
                            (("diff", "run", "saved"), 1)):
            with self.subTest(words[0]):
                out, err = self.call("breakwater", *words, status=code)
                self.assertIn(said, err)
        self.assertIn("result: complete and was cut at ", out)
        self.assertIn("This run was cut at ", (self.folder / "report.html").read_text())
        self.assertIn("no failed or unfinished run", self.call("breakwater", "rm", "--failed", ".")[0])
        _, err = self.call("breakwater", "recover", "saved", status=2)
        self.assertEqual(err, "saved: is a finished run: there is nothing to recover\n")

    def test_a_full_disk_leaves_the_log(self):
        (self.folder / "small").mkdir()
        script = f"""mount -t tmpfs -o size=3m none small && cd small && echo mounted || exit
            {BIN}/motor_estimation --quiet --duration 100 --set record.stream=true --out run 2>&1; echo $?
            ls -A; {BIN}/breakwater recover .run* --out ../saved"""
        for unshare in (["unshare", "-rm"], ["unshare", "-m"]):
            done = subprocess.run([*unshare, "sh", "-c", script], cwd=self.folder, text=True, capture_output=True)
            if done.stdout.startswith("mounted"):
                break
        else:
            self.skipTest("no file system can be mounted here")
        lines = done.stdout.splitlines()
        self.assertRegex(lines[1], r"^\S*/log.h5: cannot be written \(No space left on device\); its log so far is "
                                   r"kept: breakwater recover \S*/\.run\.partial-\S*$")
        self.assertEqual(lines[2], "2")
        self.assertRegex(lines[3], r"^\.run\.partial-")
        self.assertRegex(lines[4], r"^recovered [1-9][0-9.]* s of the run")
        self.assertGreater(self.datasets("saved")["control/time_s"].size, 5000)

    def test_a_file_limit_is_told_before_the_run(self):
        done = subprocess.run(["sh", "-c", f"ulimit -f 4000; exec {BIN}/motor_estimation --quiet --duration 100 "
                               "--set record.stream=true --out run"], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"^\S*/log.h5: cannot be written \(File too large\)\n$")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_signal_leaves_the_log(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            partial, status, err = self.cut(sent)
            self.assertEqual(status, 130)
            self.assertEqual(err, "motor_estimation: interrupted; its log so far is kept: breakwater "
                                  f"recover {partial}\n")
            self.call("breakwater", "recover", partial.name, "--out", f"saved-{sent}")

    def test_nothing_is_lost(self):
        partial, _, _ = self.cut()
        config = partial / "config.toml"
        text = config.read_text()

        def refused(reason, *words):
            _, err = self.call("breakwater", "recover", partial.name, *words, status=2)
            self.assertIn(reason, err)
            self.assertTrue((partial / "log.h5").exists())
        refused("is inside the folder that is recovered", "--out", f"{partial.name}/inner/run")
        (partial / "notes.txt").write_text("mine")
        refused("holds notes.txt, which is not a run's: move it away first")
        (partial / "notes.txt").unlink()
        for damaged in ("", "\0"):
            config.write_text(damaged)
            refused(f"{partial.name}/config.toml")
        config.write_text(text)
        subprocess.run([BIN / "breakwater", "recover", "."], cwd=partial, env=environment(), check=True,
                       capture_output=True)
        self.call("breakwater", "diff", "run", "run")
        self.assertFalse(partial.exists())

    def test_a_folder_without_its_files_is_listed_as_damaged(self):
        partial, _, _ = self.cut()
        for name in ("log.h5", "log.journal", "running.json"):
            (partial / name).unlink()
            if name == "running.json":
                os.mkfifo(partial / name)  # must not be waited for
                self.assertNotIn(partial.name, self.call("breakwater", "ls", ".")[0])
            else:
                self.assertIn(f"{name}: is missing", " ".join(self.call("breakwater", "ls", ".")[0].split()))

    def test_a_complete_run_gets_its_name(self):
        self.call("motor_estimation", *STREAM, "--duration", "0.5", "--out", "whole")
        partial, _, _ = self.cut()
        for path in (self.folder / "whole").iterdir():
            shutil.copy(path, partial / path.name)
        out, _ = self.call("breakwater", "recover", partial.name, "--out", "new/parents/run")
        self.assertEqual(out, "the run is complete\nresults: new/parents/run\n")
        self.call("breakwater", "diff", "--quiet", "new/parents/run", "whole")
        self.assertEqual(sorted(path.name for path in (self.folder / "whole").iterdir()),
                         sorted(path.name for path in (self.folder / "new/parents/run").iterdir()))

    def test_is_refused_while_the_run_goes_on(self):
        process = self.start(*ENDLESS)
        partial = self.partial(process)
        self.assertIn("  running ", self.call("breakwater", "ls", ".")[0])
        _, err = self.call("breakwater", "recover", partial.name, status=2)
        self.assertEqual(err, f"{partial.name}: a process still writes this run: stop it first\n")
        process.kill()
        process.communicate()
        moved = self.folder / "copied"
        partial.rename(moved)
        _, err = self.call("breakwater", "recover", "copied", status=2)
        self.assertEqual(err, "copied: has another name than a killed run: give --out\n")
        self.call("breakwater", "recover", "copied", "--out", "saved")

    def test_a_run_that_fails_or_ends_is_that_without_a_stream(self):
        for words in ((), FAILS):
            status = 3 if words else 0
            self.push("memory", *words, status=status)
            self.push("stream", *(words or ["--set"]), "record.stream=true", status=status)
            memory, stream = self.folder / "memory", self.folder / "stream"
            self.assertEqual({path.name for path in memory.iterdir()},
                             {path.name for path in stream.iterdir()})
            self.assertEqual((memory / "log.h5").read_bytes(), (stream / "log.h5").read_bytes())
            hashes = [json.loads((run / "manifest.json").read_text())["state_hash"]
                      for run in (memory, stream)]
            self.assertEqual(*hashes)

    def test_refuses_what_needs_the_log_in_memory(self):
        _, err = self.call("motor_estimation", *STREAM, "--csv", status=2)
        self.assertEqual(err, "--csv: needs the log in memory, so leave out record.stream=true\n")
        _, err = self.call("motor_estimation", *STREAM, "record.compression=3", status=2)
        self.assertIn("record.stream: needs record.compression=0", err)

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
