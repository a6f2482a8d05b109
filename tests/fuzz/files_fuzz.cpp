// Files and options of studies. They are a study, a tuning and its candidates, experiments, shots
// and printed results. There are lists of values, seeds and points, and the answers of Slurm. A
// study or a tuning that is read and printed is read again as the same.
#include <algorithm>
#include <sstream>

#include <breakwater/cluster/slurm_answers.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/search/tuning.h>
#include <breakwater/study/point_list.h>
#include <breakwater/study/study.h>
#include <breakwater/study/study_reader.h>
#include <breakwater/study/value_list.h>
#include <breakwater/thesis/experiments.h>
#include <breakwater/thesis/printed_results.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

template <typename File>
void read_twice(File (*read)(const toml::table&, const std::string&), const std::string& text) {
  const std::string file = fuzz::file_with(text);
  const std::string printed = read(study_tables(file), file).print();
  try {
    const std::string again = fuzz::file_with(printed);
    if (read(study_tables(again), again).print() == printed) return;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  std::fprintf(stderr, "%s\n", printed.c_str());
  fuzz::require(false, "what is printed is read as it is");
}

// A tuning with one case and two searched keys.
const Tuning& small_tuning() {
  static const Tuning tuning = [] {
    const std::string file = fuzz::file_with(
        "scenario = \"s\"\nbudget = 40\n[search]\na = { uniform = [0, 1] }\nb = [1, 2]\n"
        "[objective]\nm = { goal = \"min\" }\n");
    return read_tuning(study_tables(file), file);
  }();
  return tuning;
}

void read_candidate_line(const std::string& line) {
  const auto candidate = read_candidate(line, small_tuning());
  if (!candidate) return;
  fuzz::require(
      candidate->tuned == 0 && candidate->evaluation < 40 && candidate->values.size() == 2,
      "a candidate is one of the tuning");
}

void read_points(const std::string& text) {
  constexpr std::size_t kPoints = 100;
  const std::vector<std::size_t> points = parse_points(text, kPoints);
  fuzz::require(std::is_sorted(points.begin(), points.end()) && points.back() < kPoints,
                "points are of the study");
  fuzz::require(parse_points(print_points(points), kPoints) == points,
                "points are printed as read");
}

void read_answers(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  for (const QueuedTask& task : queued_tasks(lines)) {
    fuzz::require(task.index > 0, "tasks are counted from 1");
  }
  try {
    std::vector<std::string> warnings;
    accepted_job(lines, warnings);
  } catch (const std::invalid_argument&) {
    // refused
  }
  fuzz::require(slurm_limit(lines, "MaxArraySize") > 0, "a limit is positive");
}

void read_printed_results(const std::string& text) {
  const fuzz::Folder& folder = fuzz::folder();
  const std::vector<std::string> parts = fuzz::parts_of(text);
  folder.write("printed-results.toml", parts.front());
  folder.write("reproduced.toml", parts.size() > 1 ? parts[1] : "");
  const PrintedResults results(folder.path());
}

void read_option(const std::string& text) {
  option_parts(text);
  option_value("--vary", text);
}

constexpr fuzz::Parser kParsers[] = {
    {'s', "study", [](const std::string& text) { read_twice(read_study, text); }},
    {'t', "tuning", [](const std::string& text) { read_twice(read_tuning, text); }},
    {'c', "candidate", read_candidate_line},
    {'e', "experiments",
     [](const std::string& text) { read_experiments(fuzz::file_with(text), Effort::full); }},
    {'r', "printed_results", read_printed_results},
    {'p', "shots", [](const std::string& text) { read_shot_list(fuzz::file_with(text)); }},
    {'v', "value_list",
     [](const std::string& text) {
       if (is_value_list(text)) value_list(text);
     }},
    {'o', "option", read_option},
    {'n', "seeds", [](const std::string& text) { parse_seeds(text); }},
    {'d', "points", read_points},
    {'q', "slurm", read_answers},
};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
