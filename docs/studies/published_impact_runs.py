#!/usr/bin/python3
"""Makes the runs of docs/explanation/against-published-methods.md, "Impact".

    docs/studies/published_impact_runs.py [FOLDER] [--jobs N] [--forces 2 5]       # studies/published-impact, 2 N

FOLDER/tuned/NAME is a tuning. FOLDER/tested/ROW-FORCE/CASE has the softest point of its front in the test
conditions of a row. Finished parts are not repeated.
"""
import argparse
import re
from pathlib import Path

from contact_laws_runs import STUDIES, sweep, tune, write

NOMINAL = {"wall.speed_m_s": 0.0, "controller.wall_error_m": 0.0,
           "contact.stiffness_N_m": 1000.0, "contact.damping_Ns_m": 10.0}
SPEED, PLACE, *STIFFNESS = NOMINAL
LONGEST_s = {2: 0.7, 5: 0.5}  # median free-motion time, by reference force [N]
TOLD = "contact-mpc"          # the controller that is told the wall's place

# A tuning, and the rows that test its results, differ in these keys from the nominal conditions.
TUNINGS = {"known": [SPEED, PLACE], "any-stiffness": [PLACE, *STIFFNESS], "exact": []}
ROWS = {"known": {"fixed": [], "moving": [SPEED], "place": [PLACE]},
        "any-stiffness": {"stiffness": STIFFNESS},
        "exact": {"exact": []}}


def read(name, force_N, varied, told_alone):
    """A study's text at a force, with nominal values of what is not varied."""
    text = (STUDIES / name).read_text(encoding="utf-8").replace("-2N", f"-{force_N}N")
    text = text.replace("max = 0.7", f"max = {LONGEST_s[force_N]}")
    for key in NOMINAL.keys() - set(varied):
        text = re.sub(rf"^({re.escape(key)} = )\[.*\]", lambda line: line[1] + str(
            [NOMINAL[key]] * (line[0].count(",") + 1)), text, flags=re.MULTILINE)
    if told_alone:
        text = re.sub(rf"\[for_each\.(?!{TOLD}).*?\n\n", "", text, flags=re.DOTALL)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("studies/published-impact"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--forces", type=int, nargs="+", choices=LONGEST_s, default=[2])
    arguments = parser.parse_args()
    for force_N in arguments.forces:
        for name, varied in TUNINGS.items():
            text = read("published-impact-tuning.toml", force_N, varied, name == "exact")
            found = tune(arguments.folder / "tuned" / f"{name}-{force_N}N", text, arguments.jobs, force_N)
            for row, row_varied in ROWS[name].items():
                tested = arguments.folder / "tested" / f"{row}-{force_N}N"
                study = write(tested.with_suffix(".toml"), read("published-impact.toml", force_N, row_varied, False))
                for case, own in found.items():
                    # Without an error of the told place, the others have the runs of the fixed wall.
                    if row != "place" or case.startswith(TOLD):
                        sweep(tested / case, [case], own, arguments.jobs, study)


if __name__ == "__main__":
    main()
