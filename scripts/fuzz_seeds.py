#!/usr/bin/env python3
"""Writes files of the tree as first inputs of the fuzzers.

    scripts/fuzz_seeds.py FOLDER

FOLDER gets a folder for each target that reads such files. The first letter of an input names its parser.
"""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FILES = {
    "files": [("s", "studies/*.toml"), ("t", "studies/*tuning.toml"), ("e", "data/experiments.toml"),
              ("p", "scenarios/*/shots.toml")],
    "xml": [("u", "models/*.urdf"), ("m", "models/*.xml"), ("m", "templates/*/*.xml")]}
TOGETHER = {"files": [("r", ["data/printed-results.toml", "data/reproduced.toml"])]}


def main():
    for target, kinds in FILES.items():
        folder = pathlib.Path(sys.argv[1]) / target
        folder.mkdir(parents=True, exist_ok=True)
        for letter, pattern in kinds:
            for file in sorted(ROOT.glob(pattern)):
                name = "-".join([letter, *file.relative_to(ROOT).parts])
                (folder / name).write_bytes(letter.encode() + file.read_bytes())
        for letter, files in TOGETHER.get(target, []):
            (folder / letter).write_bytes(letter.encode() + b"\0".join((ROOT / file).read_bytes() for file in files))


if __name__ == "__main__":
    main()
