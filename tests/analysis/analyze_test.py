"""`breakwater analyze`: frequency responses and margins of the motor's loop, beside matrices in NumPy.

Usage: analyze_test.py BIN_FOLDER
"""

import csv
import pathlib
import sys
import unittest

import numpy as np
import scipy.linalg

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from called_program import Folder  # noqa: E402

PERIOD_S = 1e-3


class KalmanLoop:
    """Inertia of 1 kg m², stationary disturbance Kalman filter and PD control as one system.

    x is the plant's state, z⁻ = [x̂; d̂] the predicted one.
    """

    def __init__(self, q=1.5e4, k_p=10.0, k_d=5.0):
        A, B, C = np.array([[1, PERIOD_S], [0, 1]]), np.array([[PERIOD_S**2 / 2], [PERIOD_S]]), np.array([[1.0, 0]])
        Ae = np.block([[A, -B], [np.zeros((1, 2)), np.eye(1)]])
        Be, Ce = np.vstack([B, [[0]]]), np.hstack([C, [[0]]])
        P = scipy.linalg.solve_discrete_are(Ae.T, Ce.T, np.diag([0, 0, q]), np.eye(1))
        K = P @ Ce.T / (Ce @ P @ Ce.T + 1)
        # z = (I − K C) z⁻ + K y, u = F z, z⁻(k+1) = A z + B u; y = C x + n.
        F, z = np.array([[-k_p, -k_d, 1]]), np.hstack([K @ C, np.eye(3) - K @ Ce])
        self.command, self.d_hat = F @ z, z[2:]
        self.A = np.vstack([np.hstack([A, np.zeros((2, 3))]) + B @ self.command, Ae @ z + Be @ self.command])
        self.force = np.vstack([B, np.zeros((3, 1))])
        self.noise, self.d_hat_of_noise = np.vstack([B @ F @ K, Ae @ K + Be @ F @ K]), K[2, 0]

    def response(self, row, column, omega, direct=0.0):
        z = np.exp(1j * PERIOD_S * np.asarray(omega))
        return np.array([(row @ np.linalg.solve(one * np.eye(5) - self.A, column))[0, 0] for one in z]) + direct

    def spectral_radius(self, delay):
        """The largest eigenvalue with `delay` > 0 samples between the command and the plant, which are states."""
        A = np.zeros((5 + delay, 5 + delay))
        A[:5, :5], A[5, :5], A[:5, -1:] = self.A - self.force @ self.command, self.command, self.force
        A[6:, 5:-1] = np.eye(delay - 1)
        return np.abs(np.linalg.eigvals(A)).max()


class Analyze(Folder):
    def analyse(self, case, *sets, options=("--design-only",), way="designed"):
        """The columns of analysis.csv, with gain and phase as one complex number, and the row of margins.csv."""
        self.call("breakwater", "analyze", "motor_estimation", "--case", case, "--quiet", "--out", "a",
                  "--set", "encoder.bits=0", *sets, *options)
        tables = [[row for row in csv.DictReader((self.folder / f"a/{name}.csv").read_text().splitlines()) if row["way"] == way]
                  for name in ("analysis", "margins")]
        found = {name: np.array([float(row[name]) for row in tables[0]]) for name in tables[0][0] if name not in ("case", "axis", "way")}
        found |= {name.removesuffix("_gain"): gain * np.exp(1j * np.radians(found[name.removesuffix("_gain") + "_phase_deg"]))
                  for name, gain in list(found.items()) if name.endswith("_gain")}
        return found, {name: float(value) for name, value in tables[1][0].items() if value and name not in ("case", "axis", "way")}

    def test_a_stationary_kalman_filter_has_the_response_of_its_matrices(self):
        found, margins = self.analyse("dkf")
        loop, omega = KalmanLoop(), found["omega_rad_s"]
        command = loop.response(loop.command, loop.force, omega)
        for name, expected, tolerance in (
                ("complementary", -command, 1e-6), ("sensitivity", 1 + command, 1e-5), ("loop_gain", -command / (1 + command), 1e-5),
                ("d_hat_over_d", -loop.response(loop.d_hat, loop.force, omega), 1e-6),
                ("noise_to_d_hat", loop.response(loop.d_hat, loop.noise, omega, loop.d_hat_of_noise), 1e-5)):
            np.testing.assert_allclose(found[name], expected, rtol=tolerance, atol=0, err_msg=name)
        # The margins, on a grid that is ten times as fine.
        omega = np.geomspace(1, 3000, 20_000)
        command = loop.response(loop.command, loop.force, omega)
        gain = -command / (1 + command)
        phase, size = np.unwrap(np.angle(gain)), np.abs(gain)
        crossover = np.flatnonzero((size[:-1] > 1) & (size[1:] <= 1))[0]
        turns = 20 * np.log10(1 / size[np.flatnonzero(np.diff(np.sign(np.angle(-gain))) * (gain[1:].real < 0))])
        phase_margin = np.angle(-gain[crossover])
        for name, expected in {
                "bandwidth_rad_s": omega[np.abs(loop.response(loop.d_hat, loop.force, omega)) > np.sqrt(0.5)][-1],
                "crossover_rad_s": omega[crossover], "phase_margin_deg": np.degrees(phase_margin),
                "gain_margin_dB": turns[turns > 0].min(), "gain_reduction_margin_dB": turns[turns < 0].max(),
                "delay_margin_ms": 1e3 * phase_margin / omega[crossover], "sensitivity_peak_1": np.abs(1 + command).max(),
                "complementary_peak_1": np.abs(command).max()}.items():
            self.assertAlmostEqual(margins[name] / expected, 1, delta=1e-3, msg=name)
        self.assertGreater(phase[crossover], -2 * np.pi)

    def test_measured_is_designed_without_an_encoder(self):
        for case in ("idob", "mdob", "dkf"):
            with self.subTest(case):
                options = ("--from", "3", "--to", "300", "--points", "4", "--settle", "20")
                designed, _ = self.analyse(case, options=("--from", "2.9", "--to", "310", "--design-only"))
                measured, _ = self.analyse(case, options=options, way="measured")
                omega = measured["omega_rad_s"]
                self.assertEqual((len(omega), measured["saturated_1"].max()), (4, 0.0))
                for name in ("complementary", "sensitivity", "d_hat_over_d", "noise_to_d_hat", "noise_to_velocity_hat"):
                    between = np.interp(omega, designed["omega_rad_s"], designed[name])
                    np.testing.assert_allclose(measured[name], between, rtol=5e-3, atol=0, err_msg=name)

    def test_the_design_has_delays_and_the_linear_parts_of_the_drive(self):
        options = ("--design-only", "--from", "3", "--to", "30")
        ideal, _ = self.analyse("idob", options=options)
        s = 1j * ideal["omega_rad_s"]
        for sets, drive in ((["control.delay_s=0.02"], np.exp(-0.02 * s)), (["control.delay_s=0.0204"], np.exp(-0.0204 * s)),
                            (["control.delay_s=4e-4", "sensor.delay_samples=3"], np.exp(-0.0034 * s)),
                            (["control.jitter_s=0.01"], np.exp(-0.005 * s)),
                            (["drive.current_bandwidth_rad_s=200"], 200 / (s + 200)),
                            (["drive.current_bandwidth_rad_s=200", "drive.current_damping_ratio=0.3"], 4e4 / (s * s + 120 * s + 4e4))):
            real, _ = self.analyse("idob", *sets, options=options)
            np.testing.assert_allclose(real["loop_gain"], ideal["loop_gain"] * drive, rtol=1e-4, atol=0, err_msg=sets)
        margins = [self.analyse("idob", *sets)[1]["delay_margin_ms"] for sets in ((), ("sensor.delay_samples=20",))]
        self.assertAlmostEqual(margins[0] - margins[1], 20, delta=0.02)

    def says_stable(self, case, delay, is_stable):
        _, err = self.call("breakwater", "analyze", "motor_estimation", "--case", case, "--set", delay, "--design-only",
                           "--quiet", "--out", "a", status=0 if is_stable else 3)
        self.assertEqual("the loop is not stable: its response to a pulse grows without bound" in err, not is_stable, delay)

    def test_eigenvalues_decide_whether_a_loop_is_stable(self):
        loop = KalmanLoop()
        first_unstable = next(n for n in range(1, 1000) if loop.spectral_radius(n) > 1)
        self.assertGreater(first_unstable, 2)
        for samples in (first_unstable - 1, first_unstable):
            for delay in (f"control.delay_s={samples}e-3", f"sensor.delay_samples={samples}"):
                self.says_stable("dkf", delay, samples < first_unstable)


if __name__ == "__main__":
    unittest.main()
