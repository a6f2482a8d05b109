"""Runs from Python: equal to those of the programs, and safe to use."""

import concurrent.futures
import gc
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import unittest
import warnings

import numpy as np
import xarray

import breakwater as bw
from support import BIN, temporary_folder

BRIEF = 0.1
MOTOR = dict(case="stf", duration=0.3)


class Hashes(unittest.TestCase):
    def test_every_case_of_every_scenario_gives_the_programs_state_hash(self):
        cases = 0
        for scenario in bw.scenarios():
            with temporary_folder() as folder:
                subprocess.run([BIN / "breakwater", "run", scenario, "--case", "all", "--quiet",
                                "--duration", str(BRIEF), "--out", folder / "all"], check=True)
                for case in bw.cases(scenario):
                    manifest = json.loads((folder / "all" / case / "manifest.json").read_text())
                    with self.subTest(scenario=scenario, case=case):
                        run = bw.run(scenario, case=case, duration=BRIEF)
                        self.assertEqual(run.state_hash, manifest["state_hash"])
                        self.assertEqual(run.scenario, scenario)
                        self.assertEqual(run.case, case)
                        self.assertAlmostEqual(run.time_s[-1], BRIEF, delta=0.011)
                        self.assertTrue(np.isfinite(list(run.metrics.values())).all())
                        cases += 1
        self.assertGreater(cases, 40)

    def test_keys_and_seed_are_those_of_the_command_line(self):
        with temporary_folder() as folder:
            subprocess.run([BIN / "motor_estimation", "--case", "stf", "--seed", "7", "--set",
                            "encoder.bits=8", "noise.std_rad=1e-3", "run.duration_s=0.3",
                            "observer.name=qvff", "--quiet", "--out", folder / "run"], check=True)
            theirs = bw.load(folder / "run")
        ours = bw.run("motor_estimation", case="stf", seed=7, duration=0.3,
                      set={"encoder.bits": np.int64(8), "noise.std_rad": np.float64(1e-3),
                           "observer.name": "qvff"})
        self.assertEqual(ours.state_hash, theirs.state_hash)
        self.assertEqual(ours.config_text, theirs.config_text)
        other = bw.run("motor_estimation", case="stf", seed=8, duration=0.3,
                       set={"encoder.bits": 8, "noise.std_rad": 1e-3, "observer.name": "qvff"})
        self.assertNotEqual(ours.state_hash, other.state_hash)

    def test_lists_and_bools_of_numpy_are_toml(self):
        run = bw.run("motor_estimation", case="idob", duration=0.1,
                     set={"observer.poles_rad_s": np.array([-5.0, -6.0, -7.0])})
        self.assertEqual(run.config["observer"]["poles_rad_s"], [-5, -6, -7])
        wave = bw.run("quadrotor_waves", duration=0.05, set={"controller.compensate": np.bool_(False)})
        self.assertIs(wave.config["controller"]["compensate"], False)


class Metrics(unittest.TestCase):
    def test_a_missing_one_says_why(self):
        run = bw.run("motor_estimation", "idob", duration=0.02)
        for name, why in {"rmse_velocity_rad_s": "the run does not cover its window",
                          "unheard_of": "the run has no such metric"}.items():
            with self.assertRaisesRegex(KeyError, f"{name}: {why}"):
                run.metrics[name]
        self.assertIsNone(run.metrics.get("unheard_of"))


class Warnings(unittest.TestCase):
    def test_of_seeds_that_change_nothing(self):
        def said(**keys):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                runs = [bw.run("motor_estimation", "idob", duration=0.02, seed=seed, **keys)
                        for seed in (1, 2, 3)]
            self.assertEqual([line for run in runs for line in run.warnings],
                             [str(warning.message) for warning in caught])
            return [str(warning.message) for warning in caught]

        same = "gave the same run: no noise reaches them"
        self.assertEqual(said(set={"noise.std_rad": 0}),
                         [f"seed: 1 and 2 {same}", f"seed: 1 and 3 {same}"])
        self.assertEqual(said(set={"noise.std_rad": 0.01}), [])

    def test_of_a_reference_that_is_not_held(self):
        with temporary_folder() as folder:
            with self.assertWarnsRegex(UserWarning, "does not hold its reference"):
                run = bw.run("cart_position", "idob", set={"controller.kp": 1e-3}, out=folder / "far")
            self.assertEqual(bw.load(folder / "far").warnings, run.warnings)
        self.assertIn("does not hold its reference", run.warnings[0])
        self.assertIn(", 1 warning,", repr(run))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertNotIn("warning", repr(bw.run("cart_position", "idob")))


class Logs(unittest.TestCase):
    def test_a_signal_is_a_view_without_a_copy_that_outlives_its_run(self):
        run = bw.run("arm_push", case="proposed-link1", duration=0.05)
        angles = run["q_true_rad"]
        self.assertEqual(angles.shape, (len(run.time_s), 3))
        self.assertFalse(angles.flags.owndata)
        self.assertFalse(angles.flags.writeable)
        self.assertTrue(np.shares_memory(angles, run["q_true_rad[2]"]))
        self.assertTrue(angles.flags.c_contiguous)
        copy = angles.copy()
        del run
        gc.collect()
        rubbish = [np.full(1000, 1e300) for _ in range(100)]
        np.testing.assert_array_equal(angles, copy)
        del rubbish

    def test_names_groups_indices_and_units(self):
        run = bw.run("arm_wall_contact", case="hpfc-2N", duration=0.2,
                     set={"record.fine_from_s": 0.1, "record.fine_to_s": 0.15})
        self.assertEqual(run.groups, ["control", "physics"])
        self.assertEqual(len(run["physics/time_s"]), 500)
        self.assertEqual(run["physics/qpos"].shape, (500, 3))
        np.testing.assert_array_equal(run["q_true_rad[3]"], run["q_true_rad"][:, 2])
        np.testing.assert_array_equal(run["control/time_s"], run.time_s)
        self.assertEqual(run.time_s[-1], 0.199)
        self.assertEqual(run.unit("torque_command_Nm"), "N m")
        self.assertIn("force", run.description("force_true_N"))
        self.assertIn("force_true_N", run)
        self.assertNotIn("nothing", run)
        for wrong in ("force_tru_N", "q_true_rad[4]", "q_true_rad[0]", "nowhere/qpos", "", 3):
            with self.assertRaisesRegex(KeyError, "signal"):
                run[wrong]
        with self.assertRaisesRegex(KeyError, "did you mean force_true_N"):
            run["force_tru_N"]

    def test_a_saved_run_is_read_as_it_was(self):
        with temporary_folder() as folder:
            run = bw.run("motor_estimation", **MOTOR, out=folder / "run")
            self.assertEqual(run.folder, folder / "run")
            saved = bw.load(folder / "run")
            self.assertEqual(saved.state_hash, run.state_hash)
            self.assertEqual(saved.config, run.config)
            self.assertEqual(saved.metrics, run.metrics)
            self.assertCountEqual(saved.signals, run.signals)
            for signal in [*run, "time_s"]:
                np.testing.assert_array_equal(saved[signal], run[signal])
                self.assertEqual(saved.unit(signal), run.unit(signal))
            config = folder / "run" / "config.toml"
            self.assertEqual(bw.cases(config), [run.case])
            again = bw.run(config)
            self.assertEqual(again.state_hash, run.state_hash)
            self.assertIsNone(again.folder)
            values = saved["position_hat_rad"]
            del saved
            gc.collect()
            np.testing.assert_array_equal(values, run["position_hat_rad"])

    def test_pandas_and_xarray(self):
        with temporary_folder() as folder:
            run = bw.run("arm_push", case="drac-link1", duration=0.1, out=folder / "run")
            frame = run.to_pandas()
            np.testing.assert_array_equal(frame["q_true_rad_2"], run["q_true_rad"][:, 1])
            np.testing.assert_array_equal(frame.index, run.time_s)
            dataset = run.to_xarray()
            # The file needs no module of ours.
            file = xarray.open_dataset(folder / "run" / "log.h5", group="control", engine="h5netcdf",
                                       phony_dims="sort")
            with file:
                self.assertEqual(set(file.variables), set(dataset.variables) - {"index_3"})
                for name in file.variables:
                    np.testing.assert_array_equal(file[name].values, dataset[name].values)
                self.assertEqual(file["torque_command_Nm"].attrs["units"], "N m")
            self.assertEqual(dataset["torque_command_Nm"].attrs["units"], "N m")
            self.assertEqual(dataset["time_s"].attrs["units"], "s")
            self.assertAlmostEqual(float(dataset["q_true_rad"].sel(time_s=0.05, index_3=2)),
                                   run["q_true_rad"][50, 1])

    def test_a_run_that_failed_tells_when_why_and_what_was_logged(self):
        with temporary_folder() as folder:
            with self.assertRaises(bw.RunFailed) as caught:
                bw.run("motor_estimation", case="stf", duration=1, out=folder / "run",
                       set={"fault.sensor": "angle", "fault.at_s": 0.5})
            failed = caught.exception
            self.assertAlmostEqual(failed.time_s, 0.5)
            self.assertIn("angle", failed.reason)
            self.assertIn("0.5", str(failed))
            self.assertEqual(len(failed.run.time_s), 500)
            self.assertEqual(failed.run.metrics, {})
            self.assertEqual(bw.load(folder / "run").failure, (failed.time_s, failed.reason))


class Nonsense(unittest.TestCase):
    def test_a_name_that_is_no_text_is_no_signal(self):
        self.assertNotIn("\ud800", bw.run("arm_push", duration=0.01))

    def test_a_log_that_does_not_fit_is_a_memory_error(self):
        self.assertRaisesRegex(MemoryError, "run.duration_s", bw.run, "arm_wall_contact", duration=1e7)

    def test_leaves_nothing_behind(self):
        with temporary_folder() as folder:
            (folder / "mine").mkdir()
            (folder / "mine" / "notes.txt").write_text("mine")
            with self.assertRaisesRegex(bw.InputError, "notes.txt|mine"):
                bw.run("arm_push", duration=0.01, out=folder / "mine")
            self.assertRaises(bw.InputError, bw.run, "arm_push", duration=-1, out=folder / "new")
            self.assertEqual(os.listdir(folder), ["mine"])
            self.assertEqual(os.listdir(folder / "mine"), ["notes.txt"])


class Processes(unittest.TestCase):
    def test_two_runs_in_two_threads_are_the_same_as_alone_and_let_others_work(self):
        alone = [bw.run("motor_estimation", case=case, duration=2).state_hash for case in ("stf", "idob")]
        hashes = {}
        laps = 0

        def work(case):
            hashes[case] = bw.run("motor_estimation", case=case, duration=2).state_hash

        threads = [threading.Thread(target=work, args=(case,)) for case in ("stf", "idob")]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads):
            laps += 1
            time.sleep(1e-4)
        self.assertEqual([hashes["stf"], hashes["idob"]], alone)
        self.assertGreater(laps, 10)

    def test_of_two_threads_with_one_folder_one_makes_its_run_whole(self):
        begun, go_on = threading.Event(), threading.Event()

        class Waiting(bw.Estimator):
            def reset(self, x):
                begun.set()
                go_on.wait()

            def update(self, u, y):
                return [0.0, 0.0, 0.0]

        made = []
        with temporary_folder() as folder:
            out = folder / "run"
            thread = threading.Thread(target=lambda: made.append(
                bw.run("motor_estimation", duration=0.1, estimator=Waiting(), out=out)))
            thread.start()
            self.assertTrue(begun.wait(60))
            finished = bw.run("motor_estimation", **MOTOR)
            try:
                for attempt in (lambda: bw.run("motor_estimation", **MOTOR, out=out), lambda: finished.save(out)):
                    with self.assertRaisesRegex(bw.InputError, "run: another thread of this process makes a run"):
                        attempt()
            finally:
                go_on.set()
                thread.join()
            self.assertEqual(bw.load(out).state_hash, made[0].state_hash)
            self.assertEqual([path.name for path in folder.iterdir()], ["run"])
            bw.run("motor_estimation", **MOTOR, out=out)

    def test_a_daemon_thread_in_a_run_or_a_filter_lets_python_exit(self):
        waiting = """
class Part(bw.Estimator):
    def reset(self, x): pass
    def update(self, u, y):
        WAIT
"""
        filtering = """
f = bw.Mdob(1.0, cutoff_rad_s=50.0, period_s=1e-3)
zeros = np.zeros((2_000_000, 1))
"""
        for name, preamble, work in (
            ("runs", "", "bw.run('arm_wall_contact', out='out/run')"),
            ("filters", filtering, "f.filter(zeros, zeros)"),
            ("waits", waiting.replace("WAIT", "time.sleep(1000)"), "bw.run('motor_estimation', estimator=Part())"),
            ("works", waiting.replace("WAIT", "while True: pass"), "bw.run('motor_estimation', estimator=Part())"),
        ):
            script = f"""
import breakwater as bw, numpy as np, threading, time
{preamble}
def work():
    while True:
        {work}
for _ in range(2 if {name!r} != "runs" else 1):
    threading.Thread(target=work, daemon=True).start()
time.sleep(0.7)
print("main ends")
"""
            with self.subTest(name), temporary_folder() as folder:
                done = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True,
                                      timeout=120)
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "main ends\n", ""))
                left = [path for path in folder.rglob(".*")]
                self.assertEqual(left, [])

    def test_another_process_returns_its_run(self):
        with concurrent.futures.ProcessPoolExecutor(1) as pool, temporary_folder() as folder:
            with warnings.catch_warnings(record=True):
                made = pool.submit(bw.run, "motor_estimation", **MOTOR, set={"observer.gamma": 1.1}).result()
                own = bw.run("motor_estimation", **MOTOR, set={"observer.gamma": 1.1})
            self.assertIsNone(made.folder)
            self.assertEqual((made.metrics, made.config, made.warnings), (own.metrics, own.config, own.warnings))
            self.assertCountEqual(made.signals, own.signals)
            for signal_name in own.signals:
                np.testing.assert_array_equal(made[signal_name], own[signal_name])
            again = pickle.loads(pickle.dumps(made))  # by its copy
            self.assertRaisesRegex(bw.InputError, "^file: must be given", again.replay)
            for _ in range(2):  # the second one in place of the first
                self.assertEqual(bw.load(again.save(folder / "made")).state_hash, own.state_hash)

            saved = bw.run("motor_estimation", **MOTOR, out=folder / "run")
            self.assertEqual(pickle.loads(pickle.dumps(saved)).folder, folder / "run")
            packed = pickle.dumps(bw.load(folder / "run"))
            loaded = bw.load(folder / "run")
            bw.run("motor_estimation", case="idob", duration=0.1, out=folder / "run")
            self.assertEqual(pickle.loads(packed).state_hash, saved.state_hash)
            self.assertEqual(pickle.loads(pickle.dumps(saved)).state_hash, saved.state_hash)
            self.assertRaisesRegex(bw.InputError, "^pickle: there is another run in", pickle.dumps, loaded)

            failed = pool.submit(bw.run, "motor_estimation", case="stf", duration=1,
                                 set={"fault.sensor": "angle", "fault.at_s": 0.5}).exception()
            self.assertIsInstance(failed, bw.RunFailed)
            self.assertAlmostEqual(failed.time_s, 0.5)
            self.assertEqual(len(failed.run.time_s), 500)

    def test_a_forked_process_runs_as_its_parent(self):
        expected = bw.run("motor_estimation", **MOTOR).state_hash
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                os.write(write, bw.run("motor_estimation", **MOTOR).state_hash.encode())
            finally:
                os._exit(0)
        os.close(write)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        with os.fdopen(read) as pipe:
            self.assertEqual(pipe.read(), expected)

    def test_ctrl_c_stops_a_run(self):
        program = ("import breakwater as bw\n"
                   "try:\n    print('ready', flush=True)\n    bw.run('arm_wall_contact', duration=3000)\n"
                   "except KeyboardInterrupt:\n    print('stopped', flush=True)\n")
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as child:
            self.assertEqual(child.stdout.readline(), "ready\n")
            time.sleep(1)
            child.send_signal(signal.SIGINT)
            self.assertEqual(child.communicate(timeout=120)[0], "stopped\n")

    def test_a_video_of_a_run_without_a_folder(self):
        run = bw.run("arm_push", case="drac-link1", duration=0.3)
        with temporary_folder() as folder:
            made = run.video(folder / "push.mp4", from_s=0, to_s=0.1, size="128x96", look="fast")
            self.assertGreater(made.stat().st_size, 1000)
            self.assertRaisesRegex(bw.InputError, "size", run.video, folder / "push.mp4", size="huge")
            self.assertRaisesRegex(bw.InputError, "file", run.video)


if __name__ == "__main__":
    unittest.main()
