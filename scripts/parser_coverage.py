#!/usr/bin/env python3
"""Prints the share of the parsers' lines that inputs reach: the corpora of tests/fuzz, files of the tree, and what
`./dev fuzz` has found in build-fuzz/corpus.

    scripts/parser_coverage.py BUILD_FOLDER

BUILD_FOLDER has the programs of the preset `coverage`. Their sources print, write and search too, so only functions
that an input enters count. The number of the lines of the others stands behind "without". HDF5's readers are among
these, since they work in a child process. Exit status 1: less than 95 % in all.
"""
import collections
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LEAST = 95.0
# The parsers of each target.
PARSERS = {
    "files": ["cluster/slurm_answers.cpp", "config/config.cpp", "config/fields.cpp", "config/toml_entry.cpp",
              "config/toml_file.cpp", "config/toml_text.cpp", "pictures/shot_list.cpp", "search/tuning.cpp",
              "study/point_list.cpp", "study/shards.cpp", "study/slurm_settings.cpp", "study/study.cpp",
              "study/study_reader.cpp", "study/value_list.cpp", "thesis/experiments.cpp", "thesis/printed_results.cpp"],
    "records": ["config/column_table.cpp", "experiment/run_list.cpp", "experiment/run_manifest.cpp",
                "experiment/saved_run.cpp", "identification/axis_parameters.cpp", "pages/impact_pulse.cpp",
                "record/hdf5_log.cpp", "recorded/encoder_quantum.cpp", "recorded/record_repair.cpp",
                "recorded/recorded_axis.cpp"],
    "models": ["plants/mjcf_files.cpp", "plants/mjcf_numbers.cpp", "plants/urdf.cpp", "plants/xml_file.cpp"]}


def main():
    build = pathlib.Path(sys.argv[1])
    programs = [build / "bin" / f"{target}_fuzz" for target in PARSERS]
    with tempfile.TemporaryDirectory() as folder:
        seeds = pathlib.Path(folder) / "seeds"
        subprocess.run([sys.executable, ROOT / "scripts/fuzz_seeds.py", seeds], check=True)
        for target, program in zip(PARSERS, programs):
            environment = os.environ | {"LLVM_PROFILE_FILE": f"{folder}/{target}-%p.profraw"}
            inputs = [place / target for place in (ROOT / "tests/fuzz/corpus", ROOT / "build-fuzz/corpus", seeds)]
            subprocess.run([program, *filter(pathlib.Path.exists, inputs)], env=environment, check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        profile = f"{folder}/all.profdata"
        subprocess.run(["llvm-profdata-14", "merge", "-o", profile, *pathlib.Path(folder).glob("*.profraw")], check=True)
        objects = [word for program in programs[1:] for word in ("-object", program)]
        files = [ROOT / "src" / name for names in PARSERS.values() for name in names]
        told = subprocess.run(["llvm-cov-14", "export", f"-instr-profile={profile}", programs[0], *objects, *files],
                              check=True, capture_output=True, text=True).stdout
    data = json.loads(told)["data"][0]
    entered, others = set(), set()  # (file, line)
    for function in data["functions"]:
        own = [region for region in function["regions"] if region[5] == 0]  # not of a macro in another file
        lines = range(min(region[0] for region in own), max(region[2] for region in own) + 1)
        (entered if function["count"] else others).update((function["filenames"][0], line) for line in lines)
    left_out = collections.Counter(name for name, _ in others - entered)
    covered = lines = 0
    for file in data["files"]:
        name = file["filename"]
        found = file["summary"]["lines"]
        count = max(found["covered"], found["count"] - left_out[name])  # two functions may share a line
        covered, lines = covered + found["covered"], lines + count
        print(f"{100.0 * found['covered'] / count:5.1f} % of {count:4} lines, without {left_out[name]:3}  "
              f"{pathlib.Path(name).relative_to(ROOT)}")
    share = 100.0 * covered / lines
    print(f"{share:5.1f} % of {lines:4} lines in all{'' if share >= LEAST else f', less than {LEAST:g} %'}")
    return 0 if share >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
