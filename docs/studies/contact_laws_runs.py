#!/usr/bin/python3
"""Makes the runs of docs/explanation/studies/contact-laws.md.

    docs/studies/contact_laws_runs.py [FOLDER] [--jobs N]       # studies/contact-laws

FOLDER/tuned/CONTACT is a tuning. FOLDER/tested/CONTACT/CASE has the softest point of its front in the test
conditions, FOLDER/shipped/CONTACT the shipped cases in the same conditions. Finished parts are not repeated. The
other walls and the sensor chain have the controllers that were tuned for the fixed wall.
"""
import argparse
import csv
import subprocess
import sys
from pathlib import Path

from match_contact_laws import contact_keys

STUDIES = Path(__file__).resolve().parents[2] / "studies"
CASES = ["proposed-2N", "hpfc-2N", "drac-2N", "tlsc-2N"]
# The laws that the controllers are tuned for, by stiffness.
TUNED = {1000: ["kelvin_voigt", "hunt_crossley", "hertz", "layered", "standard_linear_solid"],
         5000: ["kelvin_voigt", "hunt_crossley"]}
OTHER_LAWS = ["kelvin_voigt", "hunt_crossley"]  # these meet OTHERS too
OTHERS = {
    "moving": ['wall.motion="sine"', "wall.motion_from_s=6.5", "wall.amplitude_m=0.002", "wall.frequency_rad_s=12.6"],
    "giving": ['wall.motion="free"', "wall.mass_kg=2", "wall.stiffness_N_m=4000", "wall.damping_Ns_m=20"],
    "sensor": ["sensor.force_tool_mass_kg=0.1", "sensor.force_resonance_Hz=200", "sensor.force_damping_ratio=0.05",
               "sensor.force_range_N=50", "sensor.force_quantum_N=0.05", "sensor.force_period_s=0.002",
               "sensor.force_delay_s=0.002"],
}


NO_FRONT = 3  # a tuning's exit status if no candidate of a case meets the constraints


def call(*arguments):
    print(" ".join(map(str, arguments)), flush=True)
    status = subprocess.run(list(map(str, arguments)), check=False).returncode
    if status not in (0, NO_FRONT):
        sys.exit(status)


def write(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    return file


def tune(folder, text, jobs, reference_N=0.0):
    """{case: its found keys} of the softest point of each front, and of those below the reference the fastest.

    A case without a front is absent.
    """
    file = write(folder.parent / (folder.name + ".toml"), text)
    if not (folder / "front.csv").exists():
        call("breakwater", "tune", file, "--out", folder, "--jobs", jobs, "--quiet")
    softest = {}
    with open(folder / "front.csv", newline="", encoding="utf-8") as table:
        for row in csv.DictReader(table):
            rank = max(float(row["peak_force_filtered_N"]), reference_N), float(row["free_motion_time_s"])
            softest[row["case"]] = min(softest.get(row["case"], (rank, row)), (rank, row), key=lambda one: one[0])
    return {case: [f"{key}={value}" for key, value in row.items()
                   if key.startswith(("controller.", "force.")) and value] for case, (_, row) in softest.items()}


def sweep(folder, cases, keys, jobs, study=STUDIES / "contact-laws.toml"):
    if not (folder / "results.csv").exists():
        call("breakwater", "sweep", study, "--case", ",".join(cases), "--set", *keys,
             "--out", folder, "--jobs", jobs, "--quiet")


def contacts_of(law, stiffness_N_m, keys):
    """{contact: its keys} of a law: a fixed wall, and for some laws the others."""
    contacts = {f"{law}-{stiffness_N_m}": keys}
    if law in OTHER_LAWS and stiffness_N_m == 1000:
        contacts |= {f"{law}-{other}": keys + more for other, more in OTHERS.items()}
    return contacts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("studies/contact-laws"))
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    tuning = (STUDIES / "contact-laws-tuning.toml").read_text(encoding="utf-8")
    for stiffness_N_m, tuned in TUNED.items():
        laws = contact_keys(stiffness_N_m)
        for law in tuned:
            name = f"{law}-{stiffness_N_m}"
            text = tuning.replace("[set]\n", "[set]\n" + "\n".join(laws[law]) + "\n")
            found = tune(arguments.folder / "tuned" / name, text, arguments.jobs)
            for contact, keys in contacts_of(law, stiffness_N_m, laws[law]).items():
                for case, own in found.items():
                    sweep(arguments.folder / "tested" / contact / case, [case], keys + own, arguments.jobs)
    for stiffness_N_m in TUNED:
        for law, law_keys in contact_keys(stiffness_N_m).items():
            for contact, keys in contacts_of(law, stiffness_N_m, law_keys).items():
                sweep(arguments.folder / "shipped" / contact, CASES, keys, arguments.jobs)


if __name__ == "__main__":
    main()
