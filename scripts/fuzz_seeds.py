#!/usr/bin/env python3
"""Writes files of the tree as first inputs of the fuzzers.

    scripts/fuzz_seeds.py FOLDER

FOLDER gets a folder for each target that reads such files. The first letter of an input names its parser.
"""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Target, letter and files.
INPUTS = [("files", "s", "studies/*.toml"), ("files", "t", "studies/*tuning.toml"), ("files", "e", "data/experiments.toml"),
          ("files", "p", "scenarios/*/shots.toml"), ("models", "u", "models/*.urdf"), ("models", "m", "models/*.xml"),
          ("models", "m", "templates/*/*.xml")]


def write(target, name, letter, *files):
    place = pathlib.Path(sys.argv[1]) / target / name
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(letter.encode() + b"\0".join(file.read_bytes() for file in files))


def main():
    for target, letter, pattern in INPUTS:
        for file in ROOT.glob(pattern):
            write(target, "-".join([letter, *file.relative_to(ROOT).parts]), letter, file)
    write("files", "r", "r", ROOT / "data/printed-results.toml", ROOT / "data/reproduced.toml")


if __name__ == "__main__":
    main()
