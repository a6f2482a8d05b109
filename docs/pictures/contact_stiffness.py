#!/usr/bin/python3
"""Draws docs/pictures/contact-stiffness.png from the results of studies/contact-stiffness.toml.

    docs/pictures/contact_stiffness.py RESULTS.CSV [PICTURE]

docs/explanation/studies/contact-stiffness.md says what it shows.
"""

import csv
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from figures import COLOURS  # noqa: E402

METHODS = dict(zip(("proposed", "hpfc", "drac"), COLOURS))
SMALL_ERROR = 0.01  # share of the reference: standard deviation of a settled force error
DECAYED = 0.5       # share of the force's standard deviation, over the window: it still settles
LATE_s = 100.0      # runs that are seen to the end of the window


def number(row, key):
    return float(row[key]) if row[key] else math.nan


def settles(row, reference_N):
    """As contact-stiffness.md defines it; a run that fails does not."""
    return (number(row, "late_bounce_count") == 0 and
            (number(row, "std_force_error_N") <= SMALL_ERROR * reference_N or
             number(row, "force_decay_ratio") < DECAYED))


def closed_form_peak_N(row):
    """Largest K x + B dx/dt of a mass on spring and damper after dx/dt = v at x = 0, zeta < 1/2."""
    K, B = number(row, "contact.stiffness_N_m"), number(row, "contact.damping_Ns_m")
    m = number(row, "impact_mass_kg")
    zeta = B / (2.0 * math.sqrt(K * m))
    wd = math.sqrt(1.0 - zeta * zeta)
    return (math.sqrt(K * m) * number(row, "impact_velocity_m_s") *
            math.exp(-zeta / wd * math.atan2(wd * (1 - 4 * zeta * zeta),
                                             zeta * (3 - 4 * zeta * zeta))))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    picture = sys.argv[2] if len(sys.argv) > 2 else Path(__file__).with_name("contact-stiffness.png")
    with open(sys.argv[1], newline="") as file:
        rows = sorted(csv.DictReader(file), key=lambda row: number(row, "contact.stiffness_N_m"))

    figure, axes = plt.subplots(2, 2, figsize=(9.6, 7.2), sharex=True, sharey="row")
    for (top, bottom), force in zip(axes.T, (2, 5)):
        for method, colour in METHODS.items():
            chosen = [row for row in rows if row["case"] == f"{method}-{force}N"]
            late = [row for row in chosen if number(row, "run.duration_s") == LATE_s]
            impact = [row for row in chosen if number(row, "run.duration_s") < LATE_s]
            K = [number(row, "contact.stiffness_N_m") for row in impact]
            top.plot(K, [number(row, "peak_force_raw_N") for row in impact], "-o", color=colour,
                     ms=3.5, label=f"{method}, raw")
            top.plot(K, [number(row, "peak_force_filtered_N") for row in impact], "--s",
                     color=colour, ms=3, label=f"{method}, filtered")
            top.plot(K, [closed_form_peak_N(row) for row in impact], ":", color=colour, lw=1)
            bottom.plot([number(row, "contact.stiffness_N_m") for row in late],
                        [number(row, "std_force_error_N") / force for row in late], "-o",
                        color=colour, ms=3.5, label=method)
            first = min(number(row, "contact.stiffness_N_m") for row in late
                        if not settles(row, force))
            bottom.axvline(first, color=colour, lw=1, ls="-.")
        top.set_title(f"F_ref = {force} N")
        bottom.axhline(SMALL_ERROR, color="0.5", lw=0.8)
        bottom.text(205, SMALL_ERROR * 1.15, "criterion: 1 % of F_ref", color="0.35", fontsize=8)
        bottom.set_xlabel("contact stiffness K [N/m]")
    for axis in axes.flat:
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.grid(True, which="major", color="0.88")
    axes[0][0].set_ylabel("peak force [N]")
    axes[1][0].set_ylabel("std of force error, 50–100 s, / F_ref")
    axes[0][0].plot([], [], ":", color="0.3", lw=1, label="closed form, raw")
    axes[1][0].plot([], [], "-.", color="0.3", lw=1, label="no longer settles")
    axes[0][0].legend(fontsize=8)
    axes[1][0].legend(fontsize=8, loc="upper left")
    figure.tight_layout()
    figure.savefig(picture, dpi=85)


if __name__ == "__main__":
    main()
