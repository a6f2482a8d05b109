"""`breakwater estimate`, and its HDF5 log for other readers."""

import csv
import json
import subprocess
import unittest

import h5py
import numpy as np

import breakwater as bw
from support import BIN, temporary_folder

QUANTUM = 2 * np.pi / 2**12


def write(file, time_s, u, y, head=("time_s", "u", "y")):
    with open(file, "w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(head)
        writer.writerows(zip(map(repr, time_s.tolist()), map(repr, u.tolist()), map(repr, y.tolist())))


def breakwater(folder, *arguments):
    return subprocess.run([BIN / "breakwater", *map(str, arguments)], cwd=folder, text=True,
                          capture_output=True)


def estimate(folder, *arguments, status=0):
    done = breakwater(folder, "estimate", *arguments)
    assert done.returncode == status, (done.returncode, done.stderr)
    return done


class Estimate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_of_stf = bw.run("motor_estimation", case="stf", duration=1.5)
        run = cls.run_of_stf
        cls.record = run.time_s, run["applied_Nm"], run["position_measured_rad"]

    def setUp(self):
        self.folder = self.enterContext(temporary_folder())
        write(self.folder / "motor.csv", *self.record)
        self.period = ["csv.period_s=0.001", f"encoder.quantum={QUANTUM!r}", "plant.inertia=1",
                       "encoder.rounding=truncate"]

    def test_a_recorded_run_gives_the_estimates_that_it_had(self):
        estimate(self.folder, "--csv", "motor.csv", "--observer", "stf", "--out", "est", "--set",
                 *self.period)
        estimates = bw.load(self.folder / "est")
        for name in ("position_hat_rad", "velocity_hat_rad_s", "d_hat_Nm", "innovation", "lambda"):
            np.testing.assert_array_equal(estimates[name], self.run_of_stf[name], name)
        np.testing.assert_allclose(estimates["velocity_raw_rad_s"], self.run_of_stf["velocity_raw_rad_s"])
        self.assertEqual(estimates.metrics["gap_count"], 0)
        self.assertEqual(estimates.metrics["sample_count"], len(self.record[0]))
        with open(self.folder / "est" / "log.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual([float(row["d_hat_Nm"]) for row in rows], estimates["d_hat_Nm"].tolist())
        # Its config.toml reproduces it.
        estimate(self.folder, "--config", "est/config.toml", "--out", "again", "--quiet")
        self.assertEqual(bw.load(self.folder / "again").state_hash, estimates.state_hash)

    def test_a_run_of_an_estimator_without_a_case_is_called_after_it(self):
        estimate(self.folder, "--csv", "motor.csv", "--out", "est", "--quiet", "--set", *self.period)
        # This file has only the case stf, as for a user's own estimator.
        estimate(self.folder, "--config", "est/config.toml", "--observer", "idob", "--out", "own", "--quiet",
                 "--set", "observer.poles_rad_s=[-60,-61,-62]")
        estimate(self.folder, "--config", "own/config.toml", "--out", "again", "--quiet")
        for folder in ("own", "again"):
            manifest = json.loads((self.folder / folder / "manifest.json").read_text())
            self.assertEqual(manifest["case"], "idob")
        self.assertEqual(bw.load(self.folder / "again").state_hash, bw.load(self.folder / "own").state_hash)

    def test_nothing_moves_in_it_and_a_page_does_not_miss_it(self):
        estimate(self.folder, "--csv", "motor.csv", "--out", "est", "--quiet", "--set", *self.period)
        for command in (["report", "est"], ["compare", "est", "est"]):
            done = breakwater(self.folder, *command)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertNotIn("replay", done.stdout)
        done = breakwater(self.folder, "video", "est")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, 'est: is a run of "estimate", .* there is no motion to draw\n$')

    def test_every_estimator_works_and_a_whole_python_record_says_the_same(self):
        for name in ("qvff", "qbank", "kfd", "dkf", "fakfd", "idob", "mdob", "state_observer", "vfakfd"):
            with self.subTest(name):
                estimate(self.folder, "--csv", "motor.csv", "--observer", name, "--out", name, "--quiet",
                         "--set", *self.period, "encoder.pulses_per_revolution=4096")
        f = bw.Qvff(*bw.damped_inertia(1.0), delta=QUANTUM, period_s=1e-3)
        np.testing.assert_array_equal(f.filter(*self.record[1:]).d[:, 0],
                                      bw.load(self.folder / "qvff")["d_hat_Nm"])

    def test_other_units_and_the_row_that_u_belongs_to(self):
        time_s, u, y = self.record
        write(self.folder / "counts.csv", time_s + 17, -u / 0.5, np.round(y / QUANTUM))
        estimate(self.folder, "--csv", "counts.csv", "--out", "counts", "--quiet", "--set", *self.period,
                 "csv.input_scale=-0.5", f"csv.position_scale={QUANTUM!r}")
        np.testing.assert_allclose(bw.load(self.folder / "counts")["d_hat_Nm"],
                                   self.run_of_stf["d_hat_Nm"], atol=1e-6)
        write(self.folder / "before.csv", time_s[1:], u[:-1], y[1:])
        estimate(self.folder, "--csv", "before.csv", "--out", "before", "--quiet", "--set", *self.period,
                 "csv.input_acts=before")
        f = bw.Stf(*bw.damped_inertia(1.0), delta=QUANTUM, rounding="truncate", period_s=1e-3)
        np.testing.assert_array_equal(bw.load(self.folder / "before")["d_hat_Nm"],
                                      f.filter(u[1:], y[1:]).d[:, 0])

    def irregular(self):
        time_s, u, y = self.record
        kept = (time_s < 0.4) | (time_s > 0.45)
        jitter = np.random.default_rng(2).uniform(-1e-4, 1e-4, time_s.size)
        record = (time_s + jitter)[kept], u[kept], y[kept]
        write(self.folder / "rig.csv", *record)
        return record

    def test_gaps_are_said_and_predicted_over_in_python_too(self):
        time_s, u, y = self.irregular()
        done = estimate(self.folder, "--csv", "rig.csv", "--out", "rig", "--set", *self.period)
        self.assertRegex(done.stderr, r"warning: \S*rig.csv: 1 gap after 0\.39\d+ s for 0\.05\d* s: "
                                      r"the estimator predicts over a gap, .*\n")
        run = bw.load(self.folder / "rig")
        np.testing.assert_array_equal(run.time_s, time_s)
        self.assertEqual(run["stretch"].max(), 1.0)
        for name in ("normalised_innovation_squared", "unexplained_share", "innovation_correlation_1"):
            self.assertIn(name, run.metrics)
        f = bw.Stf(*bw.damped_inertia(1.0), delta=QUANTUM, rounding="truncate", period_s=1e-3)
        np.testing.assert_array_equal(run["d_hat_Nm"], f.filter(u, y, time_s).d[:, 0])
        self.assertFalse(np.array_equal(run["d_hat_Nm"], f.filter(u, y).d[:, 0]))

    def test_behind_a_longer_gap_the_estimator_starts_again(self):
        _, _, y = self.irregular()
        estimate(self.folder, "--csv", "rig.csv", "--out", "rig", "--set", *self.period,
                 "csv.longest_gap_s=0.04")
        run = bw.load(self.folder / "rig")
        behind = np.flatnonzero(np.diff(run["stretch"]))[0] + 1
        self.assertGreater(np.diff(run.time_s)[behind - 1], 0.05)
        self.assertEqual(run["d_hat_Nm"][behind], 0.0)
        self.assertEqual(run["position_hat_rad"][behind], y[behind])
        self.assertEqual(run["velocity_raw_rad_s"][behind], 0.0)

    def test_regular_times_in_python_change_nothing(self):
        time_s, u, y = self.record
        f = bw.Qvff(*bw.damped_inertia(1.0), delta=QUANTUM, period_s=1e-3)
        for one, other in zip(f.filter(u, y), f.filter(u, y, time_s)):
            np.testing.assert_array_equal(one, other)

    def test_a_table_of_another_program(self):
        time_s, u, y = self.record
        rows = (f"{1e3 * t!r};{a!r};{b!r}".replace(".", ",") for t, a, b in
                zip(time_s.tolist(), u.tolist(), y.tolist()))
        (self.folder / "scope.csv").write_text("t [ms];torque;angle\n" + "\n".join(rows) + "\n")
        estimate(self.folder, "--csv", "scope.csv", "--out", "scope", "--quiet", "--set", *self.period,
                 "csv.time_scale=1e-3", "csv.time_column=t [ms]", "csv.input_column=torque",
                 "csv.position_column=angle")
        np.testing.assert_array_equal(bw.load(self.folder / "scope")["d_hat_Nm"], self.run_of_stf["d_hat_Nm"])

    def test_a_printed_configuration_can_be_filled_in(self):
        text = estimate(self.folder, "--observer", "qbank", "--print-config").stdout
        self.assertEqual([line.split()[1] for line in text.splitlines() if line.endswith("# required")],
                         ["file", "inertia", "quantum"])
        for name, value in (("file", '"motor.csv"'), ("inertia", "1.0"), ("quantum", repr(QUANTUM))):
            text = text.replace(f"# {name} =   # required", f"{name} = {value}")
        (self.folder / "mine.toml").write_text(text)
        estimate(self.folder, "--config", "mine.toml", "--out", "mine", "--quiet")
        self.assertEqual(bw.load(self.folder / "mine").metrics["sample_count"], len(self.record[0]))
        done = estimate(self.folder, "--print-config", "--set", "plant.inertai=1", status=2)
        self.assertRegex(done.stderr, "did you mean plant.inertia")


class Log(unittest.TestCase):
    def test_datasets_have_units_and_scales(self):
        with temporary_folder() as folder:
            bw.run("arm_push", case="drac-link1", duration=0.05, out=folder / "run",
                   set={"record.compression": 1})
            with h5py.File(folder / "run" / "log.h5") as file:
                group = file["control"]
                self.assertTrue(h5py.h5ds.is_scale(group["time_s"].id))
                for name, dataset in group.items():
                    self.assertEqual(dataset.attrs["unit"], dataset.attrs["units"], name)
                    if h5py.h5ds.is_scale(dataset.id):
                        continue
                    self.assertEqual(dataset.dims[0][0].name, "/control/time_s")
                    if dataset.ndim == 2:
                        index = dataset.dims[1][0]
                        self.assertEqual(index[:].tolist(), [1.0, 2.0, 3.0])


if __name__ == "__main__":
    unittest.main()
