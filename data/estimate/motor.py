"""Makes motor.csv, a record like that of a rig: PYTHONPATH=build/python /usr/bin/python3 data/estimate/motor.py

A small motor (1e-3 kg m^2, 2e-4 N m s/rad) follows a sine. From 1 s on a load of 0.05 N m opposes it. The
input is a current (0.068 N m/A), and the encoder has 4096 counts per turn. There are 500 samples per second.
The clock jitters by 20 us, and 40 rows are lost.
"""

import math
import pathlib

import numpy as np

import breakwater as bw

TORQUE_CONSTANT = 0.068
COUNTS = 4096


class Sine(bw.Controller):
    def reset(self, t, y):
        self.last = y.position

    def update(self, t, y):
        velocity = (y.position - self.last) / self.setup.period_s
        self.last = y.position
        reference, rate = 2.0 * math.sin(2.0 * t), 4.0 * math.cos(2.0 * t)
        return 0.4 * (reference - y.position) + 0.02 * (rate - velocity)


def main():
    run = bw.run("motor_estimation", duration=3, controller=Sine(), set={
        "encoder.rounding": "nearest", "control.period_s": 2e-3, "plant.inertia_ratio": 1e-3, "plant.viscous_friction_Nms_rad": 2e-4,
        "disturbance.amplitude_Nm": 0.05, "disturbance.start_s": 1.0, "drive.limit_Nm": 0.4})
    random = np.random.default_rng(1)
    time_s = run.time_s + random.uniform(-2e-5, 2e-5, run.time_s.size)
    current_A = run["applied_Nm"] / TORQUE_CONSTANT
    counts = np.rint(run["position_measured_rad"] * COUNTS / (2 * np.pi)).astype(int)
    lines = ["# a motor under a sine, with a load from 1 s on: docs/tutorials/own-data.md",
             "time_s,u,y,load_Nm"]
    for k in range(time_s.size):
        if not 1100 <= k < 1140:
            lines.append(f"{time_s[k]:.6f},{current_A[k]:.5f},{counts[k]},{run['d_true_Nm'][k]:g}")
    pathlib.Path(__file__).with_name("motor.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
