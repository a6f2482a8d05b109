"""`breakwater identify` and bw.identify() on records of an independent simulator: SciPy's, with a smooth friction."""

import json
import subprocess
import unittest
import warnings

import numpy as np
import pandas
from scipy.integrate import solve_ivp

import breakwater as bw
import methods
from support import BIN, temporary_folder

TRUE = {"inertia_kgm2": 2.1e-3, "viscous_Nms": 6e-3, "coulomb_Nm": 0.09, "offset_Nm": -0.03, "delay_s": 4.4e-3}
QUANTUM = 2 * np.pi / 10000  # 2500 lines, four counts each
FREQUENCIES = np.array([0.6, 1.3, 2.2, 3.7, 6.1])


def record(seed, rate=500, duration=4.0, mean=0.0, swing=0.35, inertia=TRUE["inertia_kgm2"]):
    """A motor whose friction F tanh(v/0.002) is close to that of Coulomb; a jittering clock; noise of 0.4 counts."""
    random = np.random.default_rng(seed)
    time = (np.arange(int(duration * rate)) + random.uniform(-0.05, 0.05, int(duration * rate))) / rate
    phases = random.uniform(0, 2 * np.pi, len(FREQUENCIES))
    u = mean + swing * np.sin(2 * np.pi * np.outer(time, FREQUENCIES) + phases).sum(axis=1)

    def slope(t, x, torque):
        friction = TRUE["coulomb_Nm"] * np.tanh(x[1] / 0.002)
        return [x[1], (torque - TRUE["offset_Nm"] - TRUE["viscous_Nms"] * x[1] - friction) / inertia]

    # From one change of the input, or one sample, to the next.
    changes = time + TRUE["delay_s"]
    events = np.unique(np.concatenate([time, changes[changes < time[-1]]]))
    state = np.array([0.7 * random.uniform(), 0.0])
    at = {events[0]: state[0]}
    for start, end in zip(events[:-1], events[1:]):
        i = max(np.searchsorted(changes, start, side="right") - 1, 0)
        done = solve_ivp(slope, (start, end), state, method="LSODA", rtol=1e-8, atol=1e-9, args=(u[i],))
        state = done.y[:, -1]
        at[end] = state[0]
    q = np.array([at[t] for t in time]) + 0.4 * QUANTUM * random.standard_normal(len(time))
    return {"time_s": time, "u": u, "y": QUANTUM * np.floor(q / QUANTUM)}


def write(file, data):
    np.savetxt(file, np.column_stack(list(data.values())), delimiter=",", fmt="%.10g", comments="",
               header=",".join(data))


def call(folder, *words, status=0):
    done = subprocess.run([BIN / "breakwater", *map(str, words)], cwd=folder, text=True, capture_output=True)
    assert done.returncode == status, (done.returncode, done.stderr)
    return done


def identify(folder, *arguments, status=0):
    return call(folder, "identify", *arguments, status=status)


class Identify(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.data = record(1)
        cls.other = record(2, duration=2.0)

    def setUp(self):
        self.folder = self.enterContext(temporary_folder())

    def assert_close_to_truth(self, parameters):
        for key, tolerance in (("inertia_kgm2", 0.01), ("viscous_Nms", 0.02), ("coulomb_Nm", 0.03)):
            self.assertAlmostEqual(parameters[key].value / TRUE[key], 1.0, delta=tolerance, msg=key)
        self.assertAlmostEqual(parameters["offset_Nm"].value, TRUE["offset_Nm"], delta=1e-3)
        self.assertAlmostEqual(parameters["delay_s"].value, TRUE["delay_s"], delta=0.25 / 500)

    def found(self):
        return json.loads((self.folder / "id" / "identified.json").read_text())

    def test_the_record_of_another_simulator_gives_its_parameters(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the friction is not quite that of the model
            found = bw.identify(self.data, holdout=self.other)
        self.assertTrue(found.converged)
        self.assert_close_to_truth(found.parameters)
        self.assertAlmostEqual(found.fit["quantum_rad"], QUANTUM, delta=1e-9)
        self.assertTrue(all(p.identifiable for p in found.parameters.values()))
        self.assertIn("data-chart=\"position-1\"", found.report())
        self.assertRegex(repr(found), r"inertia_kgm2 = 0\.002\d+ \[0\.002\d+, 0\.002\d+\]")

    def test_the_files_run_and_the_counts_of_repairs_are_printed(self):
        write(self.folder / "bench.csv", self.data)
        lines = (self.folder / "bench.csv").read_text().splitlines()
        lines[500] = lines[500].rsplit(",", 1)[0] + ",NaN"
        (self.folder / "bench.csv").write_text("\n".join(lines) + "\n")
        done = identify(self.folder, "bench.csv", "--out", "id")
        self.assertIn("bench.csv: repaired: 1 row without a position left out (in line 501)", done.stderr)
        found = self.found()
        self.assertEqual(set(TRUE) | {"fit"}, set(found))
        run = bw.run("motor_estimation", config=self.folder / "id" / "identified.toml", duration=0.5)
        self.assertGreater(len(run.time_s), 200)
        self.assertTrue((self.folder / "id" / "report.html").exists())

    def test_the_studies_draw_the_plant(self):
        write(self.folder / "bench.csv", self.data)
        identify(self.folder, "bench.csv", "--out", "id")
        found = self.found()
        runs = bw.sweep("motor_estimation", config=self.folder / "id" / "identified.toml", seeds=[1], duration=0.1,
                        vary=dict(pandas.read_csv(self.folder / "id" / "draws.csv")), method="list")
        self.assertEqual(len(runs), 32)
        self.assertEqual(set(runs["status"]), {"complete"})
        for key, name in (("plant.inertia_ratio", "inertia_kgm2"), ("plant.coulomb_friction_Nm", "coulomb_Nm"),
                          ("disturbance.offset_Nm", "offset_Nm"), ("control.delay_s", "delay_s")):
            low, high = found[name]["low"], found[name]["high"]
            inside = np.mean((runs[key] >= low) & (runs[key] <= high))
            self.assertGreater(inside, 0.85, key)
            self.assertGreater(np.ptp(runs[key]), 0.8 * (high - low), key)

    def test_the_estimate_file_runs_on_the_record_with_a_tuned_observer(self):
        write(self.folder / "bench.csv", self.data | {"y": np.round(self.data["y"] / QUANTUM)})
        identify(self.folder, "bench.csv", "--out", "id", "--set", f"csv.position_scale={QUANTUM!r}")
        tuned = (self.folder / "id" / "identified.toml").read_text()
        tuned = tuned.replace('name = "stf"', 'name = "kfd"').replace("process_noise = 0.0", "process_noise = 612.5")
        tuned = tuned.replace('process_noise_on = "input"', 'process_noise_on = "disturbance"')
        (self.folder / "tuned.toml").write_text(tuned)
        done = call(self.folder, "estimate", "--config", "id/estimate.toml", "--tuned", "tuned.toml", "--out", "est")
        self.assertEqual("", done.stderr)
        self.assertIn("estimate kfd:", done.stdout)
        config = (self.folder / "est" / "config.toml").read_text()
        self.assertIn('name = "kfd"', config)
        self.assertIn("process_noise = 612.5\n", config)
        estimates = bw.load(self.folder / "est")
        moving = np.abs(estimates["velocity_hat_rad_s"]) > 1.0
        # Coulomb friction and offset are the disturbance.
        friction = np.mean(estimates["d_hat_Nm"] * np.sign(estimates["velocity_hat_rad_s"]), where=moving)
        self.assertAlmostEqual(friction, TRUE["coulomb_Nm"], delta=0.3 * TRUE["coulomb_Nm"])

    def test_forgotten_scales_are_warned_of(self):
        slow = {**self.data, "time_s": 1e3 * self.data["time_s"], "y": np.round(self.data["y"] / QUANTUM)}
        write(self.folder / "bench.csv", slow)
        done = identify(self.folder, "bench.csv", "--out", "id", "--set", "csv.time_scale=1e-3",
                        f"csv.position_scale={QUANTUM!r}")
        self.assertNotIn("csv.", done.stderr)
        # One cause, one warning: its consequences are not told.
        done = subprocess.run([BIN / "breakwater", "identify", "bench.csv", "--out", "id", "--set",
                               "csv.time_scale=1e-3"], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(done.stderr.count("warning"), 1, done.stderr)
        self.assertIn("set csv.position_scale to one count", done.stderr)
        done = subprocess.run([BIN / "breakwater", "estimate", "--csv", "bench.csv", "--out", "est", "--set",
                               "plant.inertia=1", "encoder.quantum=1"], cwd=self.folder, text=True, capture_output=True)
        self.assertIn("the rows are 2 s apart. If the times are milliseconds, set csv.time_scale=1e-3", done.stderr)
        self.assertIn("set csv.position_scale to one count", done.stderr)
        self.assertNotIn("does not explain the data", done.stderr)

    def test_a_masked_row_is_left_out(self):
        y = np.ma.array(self.other["y"], mask=np.arange(len(self.other["y"])) == 300)
        with self.assertWarnsRegex(UserWarning, "1 row without a position left out"):
            bw.identify({**self.other, "y": y})

    def test_a_given_inertia_and_a_false_model_are_said(self):
        write(self.folder / "bench.csv", self.data)
        done = identify(self.folder, "bench.csv", "--inertia", TRUE["inertia_kgm2"], "--out", "id")
        found = self.found()
        self.assertEqual(found["inertia_kgm2"]["value"], TRUE["inertia_kgm2"])
        self.assertTrue(found["inertia_kgm2"]["given"])
        self.assertAlmostEqual(found["torque_constant"]["value"], 1.0, delta=0.01)
        # The smooth friction of this simulator is not that of the model.
        self.assertFalse(found["fit"]["white"])
        self.assertTrue(found["coulomb_Nm"]["too_narrow"])
        self.assertIn("yes, interval too narrow", done.stdout)

    def test_a_motor_and_a_load_have_a_file_that_runs(self):
        bench = methods.TwoInertiaBench(rate_Hz=500, duration_s=0.6, backlash=0, offset=0, delay_s=0, noise_counts=0.3)
        record = methods.record(bench, 1)
        write(self.folder / "bench.csv", {"time_s": record.times_s, "u": record.inputs, "y": record.positions})
        done = identify(self.folder, "bench.csv", "--model", "two_inertia", "--inertia", bench.motor_inertia, "--out", "id")
        found = self.found()
        self.assertNotIn("inertia_kgm2", found)
        self.assertEqual(found["motor_inertia_kgm2"]["value"], bench.motor_inertia)
        self.assertTrue(found["motor_inertia_kgm2"]["given"])
        self.assertAlmostEqual(found["load_inertia_kgm2"]["value"] / bench.load_inertia, 1.0, delta=0.02)
        self.assertAlmostEqual(found["stiffness_Nm_rad"]["value"] / bench.stiffness, 1.0, delta=0.02)
        self.assertFalse((self.folder / "id" / "draws.csv").exists())
        self.assertIn("load_inertia_kgm2", done.stdout)
        run = bw.run("two_inertia", config=self.folder / "id" / "identified.toml", duration=0.5)
        self.assertGreater(len(run.time_s), 200)

    def test_clocks_that_differ_are_found(self):
        shifted = dict(self.data)
        # The row of u is 0.31 s late.
        shifted["u"] = np.interp(self.data["time_s"] + 0.31, self.data["time_s"], self.data["u"])
        with self.assertWarnsRegex(UserWarning, r"the clocks of u and y differ: u acts later by 0\.3\d* s"):
            found = bw.identify(shifted)
        self.assertAlmostEqual(found.parameters["inertia_kgm2"].value / TRUE["inertia_kgm2"], 1.0, delta=0.02)
        self.assertFalse(found.parameters["delay_s"].identifiable)

    def test_the_folder_is_replaced_as_a_whole_or_left_alone(self):
        write(self.folder / "bench.csv", self.data)
        identify(self.folder, "bench.csv", "--out", "id")
        identify(self.folder, "bench.csv", "--out", "id", "--inertia", TRUE["inertia_kgm2"])
        self.assertIn("given", (self.folder / "id" / "identified.json").read_text())
        self.assertEqual({file.name for file in self.folder.iterdir()}, {"bench.csv", "id"})
        (self.folder / "id" / "notes.txt").write_text("mine")
        done = identify(self.folder, "bench.csv", "--out", "id", status=2)
        self.assertIn("holds notes.txt", done.stderr)

    def test_what_a_record_cannot_show_is_said(self):
        with self.assertWarnsRegex(UserWarning, "coulomb_Nm is not identifiable: the records do not separate it from: .*offset torque"):
            found = bw.identify(record(3, mean=0.8, swing=0.1), out=self.folder / "kept")
        self.assertFalse(found.parameters["coulomb_Nm"].identifiable)
        self.assertIn("reverse", found.parameters["coulomb_Nm"].excitation)
        self.assertTrue(found.parameters["inertia_kgm2"].identifiable)
        self.assertEqual((self.folder / "kept" / "identified.toml").read_text(), found.to_toml())

    def test_a_held_out_record_of_another_axis_ends_with_status_3(self):
        write(self.folder / "bench.csv", self.data)
        write(self.folder / "other.csv", record(4, duration=2.0, inertia=1.3 * TRUE["inertia_kgm2"]))
        done = identify(self.folder, "bench.csv", "--holdout", "other.csv", "--out", "id", status=3)
        self.assertIn("the held-out records disagree", done.stderr)

    def test_a_record_of_less_than_a_count_and_a_wrong_one_are_refused(self):
        write(self.folder / "bench.csv", self.data)
        self.assertIn("the position moves by",
                      identify(self.folder, "bench.csv", "--set", "encoder.quantum=10", status=2).stderr)
        self.assertFalse((self.folder / "runs").exists())
        self.assertRaisesRegex(bw.InputError, "columns time_s, u and y", bw.identify, {"time_s": [1.0]})


if __name__ == "__main__":
    unittest.main()
