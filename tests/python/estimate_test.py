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


class Irregular(unittest.TestCase):
    """Records with jitter and lost rows of a motor that a servo moves along 2 sin 2t. A load of
    0.05 N m steps on it at 1 s. Its controller samples and holds at the record's times."""

    T, J, C, LOAD, COUNT = 5e-4, 1e-3, 2e-4, 0.05, 2 * np.pi / 65536
    OBSERVERS = {"stf": {}, "qvff": {}, "qbank": {"largest_disturbance": 0.5},
                 "idob": {"poles": [-10, -20, -30]},
                 "mdob": {"cutoff_rad_s": 20, "derivative_cutoff_rad_s": 50}}

    def setUp(self):
        self.folder = self.enterContext(temporary_folder())

    def record(self, jitter=0.0, seed=1):
        """Times, torques and positions; each time is shifted by at most `jitter` periods."""
        t = np.arange(8001.0)
        t[1:] += np.random.default_rng(seed).uniform(-jitter, jitter, 8000)
        t *= self.T
        q, v, rows = 0.0, 0.0, []
        for now, after in zip(t, [*t[1:], t[-1]]):
            u = 0.4 * (2 * np.sin(2 * now) - q) + 0.02 * (4 * np.cos(2 * now) - v)
            rows.append((u, self.COUNT * round(q / self.COUNT)))
            change = min(max(now, 1.0), after)
            for h, force in ((change - now, u), (after - change, u - self.LOAD)):
                end, decay = force / self.C, np.exp(-self.C / self.J * h)
                q += end * h + (v - end) * (1 - decay) * self.J / self.C
                v = end + (v - end) * decay
        return (t, *np.array(rows).T)

    def lose(self, record, share, random):
        """Loses bursts of 1 to 60 rows up to this share, at least half a second apart."""
        left = round(share * len(record[0]))
        bursts, kept = left // 60 + 1, np.ones(len(record[0]), bool)
        for i in reversed(range(bursts)):
            length = left if i == 0 else min(left, random.integers(1, 61))
            first = round((i + 0.5) * len(kept) / bursts)
            kept[first:first + length] = False
            left -= length
        return [column[kept] for column in record]

    def error(self, d_hat, t):
        """From half a second after the load's step and from 0.2 s after each gap."""
        gap_s = np.maximum.accumulate(np.where(np.diff(t, prepend=0) > 1.5 * self.T, t, 0))
        late = (t >= 1.5) & (t >= gap_s + 0.2)
        return np.sqrt(np.mean((d_hat - self.LOAD)[late] ** 2))

    def filtered(self, name, t, u, y):
        f = bw.Observer(name, *bw.damped_inertia(self.J, self.C), period_s=self.T, delta=self.COUNT,
                        **self.OBSERVERS[name])
        return f.filter(u, y, t).d[:, 0]

    def estimated(self, record, *sets, observer="stf"):
        """A run of `breakwater estimate`, and what it says."""
        write(self.folder / "motor.csv", *record)
        done = estimate(self.folder, "--csv", "motor.csv", "--observer", observer, "--out", "est",
                        "--set", f"plant.inertia={self.J}", f"plant.viscous_friction={self.C}",
                        f"encoder.quantum={self.COUNT!r}", *sets)
        return bw.load(self.folder / "est"), done.stderr

    def test_jitter_and_lost_rows_cost_little_beside_the_clean_record(self):
        clean = self.record()
        of_clean = {name: self.error(self.filtered(name, *clean), clean[0])
                    for name in self.OBSERVERS}
        for i in range(20):
            random = np.random.default_rng(100 + i)
            rows = self.lose(self.record(0.1 * i / 19, 100 + i), 0.05 * (7 * i % 20) / 19, random)
            for name, alone in of_clean.items():
                d_hat, t = self.filtered(name, *rows), rows[0]
                if i % 9 == 1 and name in ("stf", "qvff"):  # from a file too
                    run, _ = self.estimated(rows, observer=name)
                    d_hat, t = run["d_hat_Nm"], run.time_s
                self.assertLessEqual(self.error(d_hat, t), max(1.5 * alone, 0.01 * self.LOAD), (name, i))

    def test_the_default_filter_does_not_estimate_a_load_from_jitter(self):
        run, said = self.estimated(self.record(0.04, 3))
        self.assertLessEqual(np.abs(run["d_hat_Nm"][run.time_s >= 0.1]).max(), 1.5 * self.LOAD)
        self.assertLessEqual(self.error(run["d_hat_Nm"], run.time_s), 0.01 * self.LOAD)
        self.assertNotIn("does not explain", said)

    def test_one_lost_row_does_not_start_the_filter_again(self):
        run, _ = self.estimated([np.delete(column, 5000) for column in self.record()])
        self.assertEqual(run.metrics["gap_count"], 1)
        self.assertLessEqual(np.abs(run["d_hat_Nm"][run.time_s >= 1.2]).max(), 1.1 * self.LOAD)
        self.assertEqual(run["stretch"][-1], 1)

    def test_uncertain_times_act_as_a_sensors_error_that_grows_with_the_speed(self):
        """The record has a constant period, but the samples were not taken so."""
        _, u, y = self.record(0.2, 5)
        rows = self.T * np.arange(len(u)), u, y
        believed, said = self.estimated(rows)
        self.assertRegex(said, "the model does not explain the data: .*csv.time_std_s")
        known, said = self.estimated(rows, f"csv.time_std_s={0.2 * self.T / np.sqrt(3)}")
        self.assertNotIn("does not explain", said)
        largest = [np.abs(run["d_hat_Nm"][run.time_s >= 0.1]).max() for run in (known, believed)]
        self.assertLess(largest[0], 0.3 * largest[1])
        self.assertLessEqual(self.error(known["d_hat_Nm"], known.time_s), 0.02 * self.LOAD)

    def test_a_model_that_does_not_explain_the_data_is_warned_of(self):
        clean = self.record()
        for observer in ("stf", "qvff", "qbank", "idob"):
            self.assertNotIn("does not explain", self.estimated(clean, observer=observer)[1])
        for wrong in ("csv.input_scale=-1", "csv.position_scale=57.3"):
            self.assertIn("does not explain", self.estimated(clean, wrong, observer="idob")[1])

    def test_qbank_needs_no_tuning(self):
        t, u, y = self.record(0.05, 7)
        self.assertLessEqual(self.error(self.filtered("qbank", t, u, y), t), 0.01 * self.LOAD)


class Log(unittest.TestCase):
    def test_datasets_have_units(self):
        with temporary_folder() as folder:
            bw.run("arm_push", case="drac-link1", duration=0.05, out=folder / "run",
                   set={"record.compression": 1})
            with h5py.File(folder / "run" / "log.h5") as file:
                for name, dataset in file["control"].items():
                    self.assertEqual(dataset.attrs["unit"], dataset.attrs["units"], name)


if __name__ == "__main__":
    unittest.main()
