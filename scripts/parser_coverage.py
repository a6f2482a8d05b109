#!/usr/bin/env python3
"""Prints the share of the parsers' lines that the corpora of tests/fuzz and the files of the tree reach.

    scripts/parser_coverage.py BUILD_FOLDER TARGET...

BUILD_FOLDER has the programs of the preset `coverage`. Exit status 1: less than 95 % in all.
"""
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
    "scenario": ["config/config.cpp", "config/fields.cpp", "config/toml_entry.cpp", "config/toml_file.cpp",
                 "config/toml_text.cpp"],
    "files": ["cluster/slurm_answers.cpp", "pictures/shot_list.cpp", "search/tuning.cpp", "study/point_list.cpp",
              "study/slurm_settings.cpp", "study/study.cpp", "study/study_reader.cpp", "study/value_list.cpp",
              "thesis/experiments.cpp", "thesis/printed_results.cpp"],
    "shard": ["study/shards.cpp"],
    "table": ["config/column_table.cpp", "pages/impact_pulse.cpp", "recorded/encoder_quantum.cpp", "recorded/record_repair.cpp",
              "recorded/recorded_axis.cpp"],
    "run": ["experiment/run_list.cpp", "experiment/run_manifest.cpp", "experiment/saved_run.cpp",
            "identification/axis_parameters.cpp"],
    "log": ["record/hdf5_log.cpp"],
    "xml": ["plants/mjcf_files.cpp", "plants/mjcf_numbers.cpp", "plants/urdf.cpp", "plants/xml_file.cpp"]}


def main():
    build, targets = pathlib.Path(sys.argv[1]), sys.argv[2:]
    programs = [build / "bin" / f"{target}_fuzz" for target in targets]
    with tempfile.TemporaryDirectory() as folder:
        seeds = pathlib.Path(folder) / "seeds"
        subprocess.run([sys.executable, ROOT / "scripts/fuzz_seeds.py", seeds], check=True)
        for target, program in zip(targets, programs):
            environment = os.environ | {"LLVM_PROFILE_FILE": f"{folder}/{target}-%p.profraw"}
            inputs = [place / target for place in (ROOT / "tests/fuzz/corpus", seeds) if (place / target).exists()]
            subprocess.run([program, *inputs], env=environment, check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        profile = f"{folder}/all.profdata"
        subprocess.run(["llvm-profdata-14", "merge", "-o", profile, *pathlib.Path(folder).glob("*.profraw")], check=True)
        objects = [word for program in programs[1:] for word in ("-object", program)]
        files = [ROOT / "src" / name for target in targets for name in PARSERS.get(target, [])]
        told = subprocess.run(["llvm-cov-14", "export", "-summary-only", f"-instr-profile={profile}", programs[0],
                               *objects, *files], check=True, capture_output=True, text=True).stdout
    covered = lines = 0
    for file in json.loads(told)["data"][0]["files"]:
        found = file["summary"]["lines"]
        covered, lines = covered + found["covered"], lines + found["count"]
        print(f"{found['percent']:5.1f} % of {found['count']:4} lines  {pathlib.Path(file['filename']).relative_to(ROOT)}")
    share = 100.0 * covered / lines
    print(f"{share:5.1f} % of {lines:4} lines in all")
    return 0 if share >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
