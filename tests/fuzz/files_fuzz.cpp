// Files and options of scenarios and studies. They are a scenario file with values of --set, a
// study, a tuning and its candidates, experiments, shots and printed results. There are lists of
// values, seeds and points, shards. A text that is read and printed or
// written is read again as the same.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <breakwater/config/fields.h>
#include <breakwater/pictures/shot_list.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/record/process_name.h>
#include <breakwater/search/tuning.h>
#include <breakwater/study/shards.h>
#include <breakwater/study/study_reader.h>
#include <breakwater/thesis/experiments.h>
#include <breakwater/thesis/printed_results.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

enum class Kind { one, two };

struct Settings {
  double number = 0.0;
  double optional = 0.5;
  int count = 0;
  std::uint64_t seed = 0;
  bool flag = false;
  std::string text;
  std::vector<double> numbers;
  std::vector<std::vector<double>> groups;
  Kind kind = Kind::one;

  // A field of each type.
  Fields fields() {
    Fields all;
    all.number("a.number", number, any(), "a number");
    all.optional_number("a.optional", optional, positive(), "a positive number");
    all.count("a.count", count, between(0, 100), "a count");
    all.count("run.seed", seed, not_negative(), "a seed");
    all.flag("a.flag", flag, "a flag");
    all.text("a.text", text, "a text");
    all.numbers("b.numbers", numbers, any(), "numbers");
    all.number_groups("b.groups", groups, any(), "groups of numbers");
    all.choice("b.kind", kind, {{"one", Kind::one}, {"two", Kind::two}}, "a choice");
    all.only_for({"a.optional"}, "b.kind", {"two"});
    return all;
  }
};

// The configuration as the run folder has it; empty if it is refused.
std::string printed_config(const std::string& file, const std::vector<std::string>& sets) {
  const ScenarioFile scenario(file, "fuzzed");
  std::string text;
  for (const std::string& name : scenario.cases()) {
    Settings settings;
    Fields fields = settings.fields();
    const Config config = scenario.config(name, sets);
    fields.read_finished(config);  // as pictures of an old run do
    fields.check(scenario);
    fields.read(config);
    fields.unused();
    if (text.empty()) text = fields.print("fuzzed", name);
  }
  return text;
}

// The file and values of --set, separated by zero bytes.
void read_scenario(const std::string& text) {
  const std::vector<std::string> parts = fuzz::parts_of(text);
  const std::string first =
      printed_config(fuzz::file_with(parts[0]), {parts.begin() + 1, parts.end()});
  if (first.empty()) return;
  try {
    fuzz::require(printed_config(fuzz::file_with(first), {}) == first,
                  "a printed configuration reads as it is");
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n%s\n", first.c_str(), error.what());
    fuzz::require(false, "a printed configuration is accepted");
  }
}

constexpr std::size_t kPoints = 10;

bool are_same(const PointResult& a, const PointResult& b) {
  const auto is_same_metric = [](const auto& one, const auto& other) {
    const bool are_nan = std::isnan(one.second) && std::isnan(other.second);
    return one.first == other.first && (one.second == other.second || are_nan);
  };
  return a.key == b.key && a.status == b.status && a.reason == b.reason &&
         a.state_hash == b.state_hash &&
         std::equal(a.metrics.begin(), a.metrics.end(), b.metrics.begin(), b.metrics.end(),
                    is_same_metric);
}

PointResult written(const PointResult& result) {
  static const fuzz::Folder folder;
  {
    Shard shard(folder.path());
    shard.begin(result.number, result.key);
    shard.add(result);
    shard.finish();
  }
  PointResult read = ShardIndex(folder.path(), kPoints).read(result.number);
  std::filesystem::remove(folder.path() / (process_name() + "-0.shard"));
  return read;
}

// Each line with a right checksum, and the bytes as they are.
void read_shard(const std::string& all) {
  static const fuzz::Folder folder;
  std::string bytes = all + "\n";
  for (std::string_view text = all; !text.empty();) {
    const std::string_view line = text.substr(0, text.find('\n'));
    bytes += text_hash(line) + "\t" + std::string(line) + "\n";
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  folder.write(process_name() + "-0.shard", bytes);
  const ShardIndex index(folder.path(), kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (!index.has(i)) continue;
    // The first time, control characters become blanks.
    const PointResult result = written(index.read(i));
    fuzz::require(are_same(written(result), result), "a result is read as it was written");
  }
  index.check_models();
  index.find("0");
  results_by_key(folder.path());
  results_of_process(folder.path(), getpid(), {});
}

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
        "scenario = \"s\"\nbudget = 40\npopulation = 8\n[search]\na = { uniform = [0, 1] }\nb = "
        "[1, 2]\n"
        "[objective]\nm = { goal = \"min\" }\nn = { goal = \"max\" }\n");
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
  constexpr std::size_t kAllPoints = 100;
  const std::vector<std::size_t> points = parse_points(text, kAllPoints);
  fuzz::require(std::is_sorted(points.begin(), points.end()) && points.back() < kAllPoints,
                "points are of the study");
  fuzz::require(parse_points(print_points(points), kAllPoints) == points,
                "points are printed as read");
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
    {'f', "scenario", read_scenario},
    {'h', "shard", read_shard},
    {'s', "study", [](const std::string& text) { read_twice(read_study, text); }},
    {'t', "tuning", [](const std::string& text) { read_twice(read_tuning, text); }},
    {'c', "candidate", read_candidate_line},
    {'e', "experiments",
     [](const std::string& text) { read_experiments(fuzz::file_with(text), Effort::full); }},
    {'r', "printed_results", read_printed_results},
    {'p', "shots", [](const std::string& text) { shot_list(fuzz::file_with(text)); }},
    {'v', "value_list",
     [](const std::string& text) {
       if (is_value_list(text)) value_list(text);
     }},
    {'o', "option", read_option},
    {'d', "points", read_points},
};
}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
