"""Sweeps from Python: the same folder as from the command, and a DataFrame."""

import csv
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np
import pandas

import breakwater as bw
from support import BIN, Drive, Still, temporary_folder

MOTOR = dict(case=["idob", "stf"], vary={"encoder.bits": [6, 8]}, seeds=range(1, 4),
             set={"noise.std_rad": 0.1}, duration=0.05)
WORDS = ["motor_estimation", "--case", "idob,stf", "--vary", "encoder.bits=6,8", "--seeds", "1..3",
         "--set", "noise.std_rad=0.1", "--duration", "0.05"]
RUNS = 12


def command(*words):
    subprocess.run([BIN / "breakwater", "sweep", "--quiet", *map(str, words)], check=True)


def lose_half(folder):
    """Simulate a killed study: remove some lines of its shards."""
    lines = [line for shard in sorted((folder / "shards").iterdir()) for line in shard.read_bytes().splitlines(True)]
    for shard in (folder / "shards").iterdir():
        shard.unlink()
    (folder / "shards" / "left.shard").write_bytes(b"".join(lines[: len(lines) // 2]) + lines[-1][:20])
    (folder / "results.csv").unlink()


class SameAsTheCommand(unittest.TestCase):
    def test_the_folder_has_the_commands_bytes(self):
        with temporary_folder() as folder:
            command(*WORDS, "--baseline", "idob", "--out", folder / "theirs")
            table = bw.sweep("motor_estimation", **MOTOR, baseline="idob", out=folder / "ours")
            files = sorted(path.name for path in (folder / "theirs").iterdir())
            self.assertEqual(sorted(path.name for path in (folder / "ours").iterdir()), files)
            for name in ("results.csv", "comparison.csv", "study.toml"):
                self.assertEqual((folder / "ours" / name).read_bytes(), (folder / "theirs" / name).read_bytes(), name)
            with open(folder / "theirs" / "results.csv", newline="") as file:
                header, *rows = csv.reader(file)
        self.assertEqual(list(table.columns), header)
        self.assertEqual(len(table), RUNS)
        for name, *cells in zip(header, *rows):
            numbers = name not in ("point", "case", "status", "state_hash")
            # All digits: each number is the measured double.
            expected = [float(cell) if cell else np.nan for cell in cells] if numbers else cells
            np.testing.assert_array_equal(table[name].to_numpy(), expected, name)

    def test_a_scenario_file_is_swept(self):
        file = pathlib.Path(__file__).parents[2] / "templates" / "plant" / "my_plant.toml"
        table = bw.sweep(file, seeds=[1], duration=0.1)
        self.assertEqual(list(table["state_hash"]), [bw.run(str(file), duration=0.1).state_hash])

    def test_each_row_is_the_run_of_that_configuration(self):
        table = bw.sweep("motor_estimation", **MOTOR)
        self.assertEqual(list(table["case"]), ["idob", "stf"] * 6)
        self.assertEqual(list(table["seed"]), [1, 1, 2, 2, 3, 3] * 2)
        self.assertEqual(list(table["encoder.bits"]), [6] * 6 + [8] * 6)
        self.assertGreater(len(set(table["state_hash"])), RUNS // 2)
        for row in table.to_dict("records"):
            run = bw.run("motor_estimation", case=row["case"], seed=row["seed"], duration=0.05,
                         set={"noise.std_rad": 0.1, "encoder.bits": row["encoder.bits"]})
            self.assertEqual(run.state_hash, row["state_hash"])
            self.assertEqual({name: row[name] for name in run.metrics}, run.metrics)

    def test_a_study_that_was_killed_goes_on_by_either(self):
        with temporary_folder() as folder:
            bw.sweep("motor_estimation", **MOTOR, out=folder / "study")
            whole = (folder / "study" / "results.csv").read_bytes()
            study_file = (folder / "study" / "study.toml").read_bytes()
            for go_on in (lambda: bw.sweep("motor_estimation", **MOTOR, out=folder / "study"),
                          lambda: bw.sweep(folder / "study"),
                          lambda: bw.sweep("motor_estimation", **MOTOR, out=folder / "study", jobs=1),
                          lambda: command(*WORDS, "--out", folder / "study")):
                lose_half(folder / "study")
                go_on()
                self.assertEqual((folder / "study" / "results.csv").read_bytes(), whole)
                kept = [line for shard in (folder / "study" / "shards").iterdir() if shard.stem != "left"
                        for line in shard.read_text().splitlines() if "\tasked\t" in line]
                self.assertLess(len(kept), RUNS)  # the existing half was not run again
                self.assertGreater(len(kept), 0)
            self.assertEqual((folder / "study" / "study.toml").read_bytes(), study_file)
            with self.assertRaisesRegex(bw.InputError, "another study"):
                bw.sweep("motor_estimation", **{**MOTOR, "duration": 0.06}, out=folder / "study")
            begun = bw.sweep("motor_estimation", case="idob", duration=0.05, out=folder / "other")
            self.assertEqual(len(bw.sweep("motor_estimation", case="idob", duration=0.05, rerun=True,
                                          out=folder / "other")), len(begun))

    def test_a_study_file_and_what_lies_on_top_of_it(self):
        with temporary_folder() as folder:
            (folder / "study.toml").write_text(
                'scenario = "motor_estimation"\nseeds = [5, 7]\n[set]\n"run.duration_s" = 0.02\n'
                '[vary]\n"noise.std_rad" = "lin(0.001,0.002,3)"\n')
            table = bw.sweep(folder / "study.toml", case="stf", out=folder / "out")
            self.assertEqual(list(table["noise.std_rad"]), [0.001, 0.001, 0.0015, 0.0015, 0.002, 0.002])
            self.assertEqual(set(table["case"]), {"stf"})
            self.assertEqual(list(table["seed"]), [5, 7] * 3)
            (folder / "study.toml").write_text('scenario = "motor_estimation"\n[vary]\n"encoder.bit" = [3]\n')
            with self.assertRaisesRegex(bw.InputError, "study.toml:3: vary.encoder.bit.*did you mean encoder.bits"):
                bw.sweep(str(folder / "study.toml"))


class Values(unittest.TestCase):
    def test_are_lists_arrays_rules_and_distributions(self):
        brief = dict(case="idob", duration=0.01)
        bits = np.array([6, 8], dtype=np.uint8)
        for given, expected in ((bits, [6, 8]), ((6, 8), [6, 8]), (range(6, 8), [6, 7]), ([np.int64(7)], [7]),
                                (pandas.Series([9, 6]), [9, 6]), ("lin(6,8,3)", [6, 7, 8])):
            table = bw.sweep("motor_estimation", vary={"encoder.bits": given}, **brief)
            self.assertEqual(list(table["encoder.bits"]), expected)
        exact = np.random.default_rng(1).uniform(1e-4, 1e-3, size=3)
        table = bw.sweep("motor_estimation", method="list", **brief,
                         vary={"noise.std_rad": exact, "encoder.bits": [6, 6, 8]})
        np.testing.assert_array_equal(table["noise.std_rad"].to_numpy(), exact)
        self.assertEqual(list(table["encoder.bits"]), [6, 6, 8])
        table = bw.sweep("motor_estimation", vary={"observer.name": ["qvff", "stf"]}, case="stf", duration=0.01)
        self.assertEqual(list(table["observer.name"]), ["qvff", "stf"])

    def test_are_drawn(self):
        vary = {"noise.std_rad": {"log_uniform": [1e-4, 1e-2]}, "disturbance.amplitude_Nm": {"normal": (1.0, np.float32(0.5))}}
        drawn = dict(case="idob", duration=0.01, method="sobol", samples=np.int64(8))
        table = bw.sweep("motor_estimation", vary=vary, **drawn)
        self.assertEqual(len(set(table["noise.std_rad"])), 8)
        self.assertTrue(table["noise.std_rad"].between(1e-4, 1e-2).all())
        other = bw.sweep("motor_estimation", vary=vary, sampling_seed=2, **drawn)
        self.assertFalse((table["noise.std_rad"] == other["noise.std_rad"]).any())
        with temporary_folder() as folder:
            command("motor_estimation", "--case", "idob", "--duration", "0.01", "--method", "sobol", "--samples", "8",
                    "--vary", "noise.std_rad=log_uniform(1e-4,1e-2)", "--vary", "disturbance.amplitude_Nm=normal(1,0.5)",
                    "--out", folder / "theirs")
            bw.sweep("motor_estimation", vary=vary, **drawn, out=folder / "ours")
            self.assertEqual((folder / "ours" / "results.csv").read_bytes(),
                             (folder / "theirs" / "results.csv").read_bytes())

    def test_seeds_are_whole_numbers_of_any_kind(self):
        for given, expected in ((range(1, 4), [1, 2, 3]), (range(1, 6, 2), [1, 3, 5]), (np.arange(2, 4), [2, 3]),
                                ([np.uint8(9), 4], [9, 4])):
            table = bw.sweep("motor_estimation", case="idob", duration=0.01, seeds=given)
            self.assertEqual(list(table["seed"]), expected)

    def test_a_failed_run_is_a_row(self):
        with temporary_folder() as folder:
            table = bw.sweep("motor_estimation", case="stf", duration=0.02, keep="failed", out=folder / "study",
                             vary={"fault.at_s": [0.01, 1.0]}, set={"fault.sensor": "angle"})
            self.assertEqual(list(table["status"]), ["failed", "complete"])
            metrics = table.columns[list(table.columns).index("state_hash") + 1 :]
            self.assertTrue(table.loc[0, metrics].isna().all())
            failed = bw.load(folder / "study" / "runs" / table.loc[0, "point"])
            self.assertEqual(failed.state_hash, table.loc[0, "state_hash"])
            self.assertAlmostEqual(failed.failure[0], 0.01)
            (folder / "stop.toml").write_text('scenario = "motor_estimation"\ncase = "stf"\non_failure = "stop"\n[set]\n'
                                              '"run.duration_s" = 0.02\n"fault.sensor" = "angle"\n"fault.at_s" = 0.01\n')
            self.assertRaisesRegex(RuntimeError, "failed: at 0.01 s", bw.sweep, folder / "stop.toml")


class Warned(unittest.TestCase):
    def of(self, *words, **arguments):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            bw.sweep("motor_estimation", *words, duration=0.01, **arguments)
        self.assertEqual({pathlib.Path(one.filename).name for one in caught} - {"sweeps_test.py"}, set())
        return [str(one.message) for one in caught]

    def test_of_keys_without_effect_and_of_seeds_that_change_nothing(self):
        poles = {"observer.poles_rad_s": [[-10, -20, -30], [-11, -20, -30]]}
        (ineffective,) = self.of(case="stf", vary=poles)
        self.assertRegex(
            ineffective, "^vary: observer.poles_rad_s: has an effect only where observer.name is ")
        self.assertEqual(self.of(case=["stf", "idob"], vary=poles), [])
        (seeds,) = self.of(case="idob", seeds=[1, 2], set={"noise.std_rad": 0})
        self.assertEqual(seeds, "seeds: the 2 of each sample gave the same run: no noise reaches them")
        with temporary_folder() as folder:  # repeated for an existing study
            again = dict(case="idob", seeds=[1, 2], set={"noise.std_rad": 0}, out=folder / "study")
            self.assertEqual(self.of(**again), self.of(**again))


class Nonsense(unittest.TestCase):
    def test_of_the_study_folder(self):
        with temporary_folder() as folder:
            brief = dict(case=["idob", "stf"], duration=0.01)
            self.assertRaises(bw.InputError, bw.sweep, "motor_estimation", **brief, keep="some", out=folder / "new")
            self.assertEqual(list(folder.iterdir()), [])
            (folder / "mine").mkdir()
            (folder / "mine" / "notes.txt").write_text("mine")
            with self.assertRaisesRegex(bw.InputError, "holds something that is not a study"):
                bw.sweep("motor_estimation", **brief, out=folder / "mine")
            self.assertRaisesRegex(bw.InputError, "no study's folder", bw.sweep, folder / "mine")
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                bw.sweep("motor_estimation", **brief, metrics="nothing", out=folder / "new")
            self.assertIn("nothing", str(caught[0].message))
            self.assertEqual(pathlib.Path(caught[0].filename).name, "sweeps_test.py")
            with self.assertRaisesRegex(bw.InputError, "leave case, vary, out"):
                bw.sweep(folder / "new", case="idob")


TUNING = """scenario = "motor_estimation"
case = "idob"
algorithm = "cmaes"
budget = 10
population = 5
seeds = [1, 2]
[set]
"run.duration_s" = 2.5
"noise.std_rad" = 0.01
[search]
"encoder.bits" = [6, 7, 8, 9, 10]
[objective]
rms_torque_Nm = { goal = "min" }
"""


class PartsInPython(unittest.TestCase):
    def test_a_sweep_has_the_runs_of_their_objects_on_any_number_of_workers(self):
        study = dict(case="idob", vary={"encoder.bits": [6, 8]}, seeds=[1, 2], duration=0.05,
                     set={"noise.std_rad": 0.1})
        for parts in (lambda: dict(controller=Drive(3.0)), lambda: dict(estimator=Still())):
            with temporary_folder() as folder:
                table = bw.sweep("motor_estimation", **study, **parts(), jobs=2, out=folder / "two")
                bw.sweep("motor_estimation", **study, **parts(), jobs=1, out=folder / "one")
                for name in ("results.csv", "study.toml"):
                    self.assertEqual((folder / "one" / name).read_bytes(), (folder / "two" / name).read_bytes())
            self.assertEqual(len(table), 4)
            for row in table.to_dict("records"):
                run = bw.run("motor_estimation", case="idob", seed=row["seed"], duration=0.05, **parts(),
                             set={"noise.std_rad": 0.1, "encoder.bits": row["encoder.bits"]})
                self.assertEqual(run.state_hash, row["state_hash"])

    def test_an_axis_of_a_plant_has_its_own(self):
        table = bw.sweep("plant", seeds=[1, 2], duration=0.05, controllers={"elbow": Drive(2.0)})
        run = bw.run("plant", seed=2, duration=0.05, controllers={"elbow": Drive(2.0)})
        self.assertEqual(list(table["state_hash"])[1], run.state_hash)

    def test_a_study_goes_on_with_the_same_object_alone(self):
        with temporary_folder() as folder:
            def study(law, seeds):
                return bw.sweep("motor_estimation", case="idob", seeds=seeds, duration=0.05, controller=law,
                                out=folder / "s")

            study(Drive(2.0), [1])
            shards = len(list((folder / "s" / "shards").iterdir()))
            grown = study(Drive(2.0), [1, 2, 3])
            self.assertEqual(len(grown), 3)
            self.assertEqual(len(list((folder / "s" / "shards").iterdir())), shards + 2)
            for law in (Drive(4.0), None):
                with self.assertRaisesRegex(bw.InputError, "another (program|class in Python)|another study"):
                    study(law, [1, 2, 3])
            used = Drive(2.0)
            bw.run("motor_estimation", case="idob", duration=0.05, controller=used)
            used.runs = 0
            bw.sweep(folder / "s", controller=used)

    def test_a_tuning_is_the_same_on_any_number_of_workers(self):
        with temporary_folder() as folder:
            (folder / "t.toml").write_text(TUNING)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tables = [bw.tune(folder / "t.toml", controller=Drive(1.0), jobs=jobs, out=folder / str(jobs))
                          for jobs in (1, 2)]
                plain = bw.tune(folder / "t.toml", out=folder / "plain")
            pandas.testing.assert_frame_equal(*tables)
            for name in ("results.csv", "tune.toml"):
                self.assertEqual((folder / "1" / name).read_bytes(), (folder / "2" / name).read_bytes())
            self.assertNotEqual(float(tables[0]["rms_torque_Nm"][0]), float(plain["rms_torque_Nm"][0]))
            self.assertIn('"controller.name" = "Drive"', (folder / "1" / "tune.toml").read_text())

    def test_an_interruption_ends_the_copies(self):
        code = ("import sys; sys.path.insert(0, sys.argv[2]); import breakwater as bw\n"
                "from support import Drive\n"
                "bw.sweep('motor_estimation', case='idob', seeds=range(1, 200), controller=Drive(1), out=sys.argv[1])")
        with temporary_folder() as folder:
            child = subprocess.Popen([sys.executable, "-c", code, folder / "s", pathlib.Path(__file__).parent],
                                     stderr=subprocess.PIPE, text=True, start_new_session=True)
            while not list((folder / "s").glob("shards/*")):
                time.sleep(0.05)
            os.killpg(child.pid, signal.SIGINT)
            self.assertIn("KeyboardInterrupt", child.communicate(timeout=60)[1])
            self.assertRaises(ProcessLookupError, os.killpg, child.pid, 0)


class Processes(unittest.TestCase):
    def test_without_out_nothing_is_left(self):
        with temporary_folder() as folder:
            before, tempfile.tempdir = tempfile.tempdir, str(folder)
            try:
                bw.sweep("motor_estimation", case="idob", duration=0.01)
                self.assertRaises(bw.InputError, bw.sweep, "motor_estimation", case="nobody")
            finally:
                tempfile.tempdir = before
            self.assertEqual(list(folder.iterdir()), [])

    def test_other_threads_go_on(self):
        done = []
        thread = threading.Thread(target=lambda: done.append(bw.sweep("motor_estimation", **{**MOTOR, "duration": 1})))
        thread.start()
        laps = 0
        while thread.is_alive():
            laps += 1
            time.sleep(1e-3)
        self.assertGreater(laps, 10)
        self.assertEqual(len(done[0]), RUNS)

    def test_ctrl_c_stops_it_and_the_same_call_goes_on(self):
        study = dict(case="idob", seeds=range(1, 401), duration=2)
        for interrupt in (os.kill, os.killpg):  # like another process, and like a shell or a notebook
            with self.subTest(interrupt.__name__), temporary_folder() as folder:
                program = ("import breakwater as bw\n"
                           f"try:\n    bw.sweep('motor_estimation', **{study}, out=r'{folder / 'study'}')\n"
                           "except KeyboardInterrupt:\n    print('stopped', flush=True)\n")
                with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True,
                                      start_new_session=True) as child:
                    shards = folder / "study" / "shards"
                    until = time.monotonic() + 100
                    while not (shards.is_dir() and any(shard.stat().st_size > 2000 for shard in shards.iterdir())):
                        self.assertLess(time.monotonic(), until)
                        time.sleep(0.01)
                    interrupt(child.pid, signal.SIGINT)
                    self.assertEqual(child.communicate(timeout=100)[0], "stopped\n")
                command(folder / "study", "--collect")
                begun = (folder / "study" / "results.csv").read_text().splitlines()
                self.assertTrue(1 < len(begun) < 401, len(begun))
                self.assertEqual(len(bw.sweep("motor_estimation", **study, out=folder / "study")), 400)
                rows = (folder / "study" / "results.csv").read_text().splitlines()
                self.assertEqual(set(begun) - set(rows), set())


if __name__ == "__main__":
    unittest.main()
