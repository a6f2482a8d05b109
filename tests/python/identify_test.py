"""`breakwater identify` and bw.identify() on records of an independent simulator: SciPy's, with a smooth friction."""

import json
import subprocess
import unittest
import warnings

import numpy as np
from scipy.integrate import solve_ivp

import breakwater as bw
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


def identify(folder, *arguments, status=0):
    done = subprocess.run([BIN / "breakwater", "identify", *map(str, arguments)], cwd=folder, text=True,
                          capture_output=True)
    assert done.returncode == status, (done.returncode, done.stderr)
    return done


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

    def test_the_record_of_another_simulator_gives_its_parameters(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the friction is not quite that of the model
            found = bw.identify(self.data, holdout=self.other)
        self.assertTrue(found.converged)
        self.assert_close_to_truth(found.parameters)
        self.assertAlmostEqual(found.fit["quantum_rad"], QUANTUM, delta=1e-9)
        self.assertTrue(all(p.identifiable for p in found.parameters.values()))
        self.assertLess(10 * found.fit["held_out"]["rms_rad"], found.fit["held_out"]["plain_rms_rad"])
        self.assertIn("<svg", found.report())
        self.assertRegex(repr(found), r"inertia_kgm2 = 0\.002\d+ \[0\.002\d+, 0\.002\d+\]")

    def test_the_files_run_and_the_counts_of_repairs_are_printed(self):
        write(self.folder / "bench.csv", self.data)
        lines = (self.folder / "bench.csv").read_text().splitlines()
        lines[500] = lines[500].rsplit(",", 1)[0] + ",NaN"
        (self.folder / "bench.csv").write_text("\n".join(lines) + "\n")
        done = identify(self.folder, "bench.csv", "--out", "id")
        self.assertIn("bench.csv: repaired: 1 row without a position left out (in line 501)", done.stderr)
        found = json.loads((self.folder / "id" / "identified.json").read_text())
        self.assertEqual(set(TRUE) | {"fit"}, set(found))
        run = bw.run("motor_estimation", config=self.folder / "id" / "identified.toml", duration=0.5)
        self.assertGreater(len(run.time_s), 200)
        self.assertTrue((self.folder / "id" / "report.html").exists())

    def test_what_a_record_cannot_show_is_said(self):
        with self.assertWarnsRegex(UserWarning, "coulomb_Nm is not identifiable: the velocity never reverses"):
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

    def test_wrong_arguments_are_refused(self):
        write(self.folder / "bench.csv", self.data)
        (self.folder / "word.csv").write_text("time_s,u,y\n0,1,2\n1,x,2\n2,1,2\n")
        for arguments, message in [
            (["nowhere.csv"], "nowhere.csv"),
            (["word.csv"], 'word.csv:3: u: must be a finite number, is "x"'),
            ([], "breakwater identify: FILE is missing"),
            (["--design", "bench.csv"], "breakwater identify: --design: takes no FILE"),
            (["--design", "--limits", "torque=5"], "breakwater identify: --limits: speed is missing"),
            (["--design", "--limits", "torqe=5"], "must be torque=VALUE[,speed=VALUE], is torqe=5"),
            (["--design", "--limits", "torque=5,speed=20", "--duration", "0.01"], "gives 10 rows"),
            (["bench.csv", "--model", "arm"], "--model"),
            (["bench.csv", "--set", "csv.time_scal=1"], "csv.time_scal"),
            (["bench.csv", "--set", "csv.input_scale=0"], "csv.input_scale: must not be 0"),
            (["bench.csv", "--set", "encoder.quantum=10"], "the position moves by"),
        ]:
            self.assertIn(message, identify(self.folder, *arguments, status=2).stderr, arguments)
            self.assertFalse((self.folder / "runs").exists())
        self.assertRaisesRegex(bw.InputError, "columns time_s, u and y", bw.identify, {"time_s": [1.0]})


if __name__ == "__main__":
    unittest.main()
