#!/usr/bin/python3
"""Draws the pictures of docs/explanation/choosing-an-observer.md and docs/explanation/methods/disturbance-kalman-filters.md
from runs of motor_estimation and cart_estimation, which it makes (about a minute).

Usage: ./dev build && /usr/bin/python3 docs/pictures/estimators.py
Needs python3-h5py and python3-matplotlib.
"""

import json
import math
import pathlib
import statistics
import subprocess
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PICTURES = pathlib.Path(__file__).resolve().parent
BIN = PICTURES.parents[1] / "build" / "bin"
PHASES = 5
NAMES = {"idob": "IDOB", "dkf": "DKF", "kfd": "KFD", "fakfd-095": "FAKFD, λ = 0.95",
         "vfakfd": "VFAKFD", "qvff": "QVFF", "stf": "STF"}
COLOURS = dict(zip(NAMES, plt.rcParams["axes.prop_cycle"].by_key()["color"]))


def run(scenario, case, sets, folder):
    out = pathlib.Path(tempfile.mkdtemp(dir=folder)) / "run"
    subprocess.run([BIN / scenario, "--quiet", "--case", case, "--out", out, "--set", *sets],
                   check=True)
    return out


def metrics(folder):
    return json.loads((folder / "metrics.json").read_text())


def signals(folder, *names):
    with h5py.File(folder / "log.h5") as log:
        control = log["control"]
        return [control["time_s"][...]] + [control[name][...] for name in names]


def save(figure, name):
    figure.tight_layout()
    figure.savefig(PICTURES / name, dpi=80)
    plt.close(figure)


def cell(period_s, bits):
    return [f"control.period_s={period_s}", f"physics.timestep_s={period_s}",
            f"encoder.bits={bits}"]


def rmse_over_resolution(folder):
    """Median velocity error over encoder phases, for each resolution and both periods."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True)
    for axis, period_s in zip(axes, ("1e-2", "1e-3")):
        for case, name in NAMES.items():
            medians = []
            for bits in (4, 6, 8, 10, 12):
                quantum = 2 * math.pi / 2**bits
                phases = [quantum * ((i + 0.5) / PHASES - 0.5) for i in range(PHASES)]
                medians.append(statistics.median(
                    metrics(run("motor_estimation", case,
                                cell(period_s, bits) + [f"encoder.phase_rad={phase!r}"],
                                folder))["rmse_velocity_rad_s"] for phase in phases))
            axis.semilogy((4, 6, 8, 10, 12), medians, "o-", label=name, color=COLOURS[case])
        axis.set(title=f"T_s = {float(period_s) * 1e3:g} ms", xlabel="encoder bits",
                 xticks=(4, 6, 8, 10, 12))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("RMSE of the velocity, 5–10 s [rad/s]")
    axes[1].legend(fontsize=8)
    save(figure, "estimators-resolution.png")


def transients(folder):
    """How the estimates answer a step of 10 N m, and a sine."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
    for axis, kind, title in zip(axes, ("step", "sine"), ("step of 10 N m", "10 sin t N m")):
        for case in ("idob", "vfakfd", "qvff", "stf"):
            t, estimate, truth = signals(
                run("motor_estimation", case, cell("1e-3", 8) + [f"disturbance.kind={kind}"],
                    folder), "d_hat_Nm", "d_true_Nm")
            axis.plot(t, estimate, label=NAMES[case], color=COLOURS[case], linewidth=1)
        axis.plot(t, truth, "k--", linewidth=1, label="true")
        axis.set(title=f"{title}, 8 bits, 1 ms", xlabel="t [s]", ylabel="estimate [N m]",
                 xlim=(0.9, 5 if kind == "step" else 10), ylim=(-15, 20))
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8)
    save(figure, "estimators-transients.png")


def poles(folder):
    """λ(k) and the pole paths of VFAKFD beside a fixed factor (Figs 4.36–4.43)."""
    noise = ["encoder.bits=48", "noise.std_rad=0.1", "observer.alpha=100"]
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
    for case, sets, name in (("vfakfd", [], "VFAKFD"),
                             ("fakfd-095", ["observer.lambda=0.98"], "λ = 0.98")):
        t, factor, re, im = signals(run("motor_estimation", case, noise + sets, folder), "lambda",
                                    "poles_discrete_re", "poles_discrete_im")
        axes[0].plot(t, factor.ravel(), linewidth=1, label=name)
        axes[1].plot(re.ravel(), im.ravel(), ".", markersize=3, label=name)
    axes[0].set(xlabel="t [s]", ylabel="λ(k)")
    angle = [2 * math.pi * i / 400 for i in range(401)]
    axes[1].plot([math.cos(a) for a in angle], [math.sin(a) for a in angle], "k", linewidth=0.5)
    axes[1].set(xlabel="Re", ylabel="Im", xlim=(0.97, 1.002), ylim=(-0.015, 0.015),
                title="discrete poles, every sample")
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8)
    save(figure, "estimators-poles.png")


def cart(folder):
    """Forgetting factors and disturbance models on the cart (Figs 4.4, 4.12, 4.14, 4.16)."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6))
    for axis, cases in zip(axes, (("order0", "gamma-1.02", "gamma-1.05", "gamma-1.20"),
                                  ("order2", "gamma-diag", "gamma-scalar", "order2-gamma-diag"))):
        for case in cases:
            t, estimate, truth = signals(run("cart_estimation", case, ["run.seed=1"], folder),
                                         "d_hat_N", "d_true_N")
            axis.plot(t, estimate, linewidth=1, label=case)
        axis.plot(t, truth, "k--", linewidth=1, label="true")
        axis.set(xlabel="t [s]", ylabel="estimate [N]", xlim=(20, 50))
        axis.grid(alpha=0.3)
        axis.legend(fontsize=8)
    save(figure, "estimators-cart.png")


def main():
    with tempfile.TemporaryDirectory() as folder:
        transients(folder)
        poles(folder)
        cart(folder)
        rmse_over_resolution(folder)


if __name__ == "__main__":
    main()
