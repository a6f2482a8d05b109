#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <breakwater/experiment/differing_keys.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/program/commands.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>

namespace breakwater {
namespace {

constexpr int kDifferent = 1;  // as diff(1) has it

// Runs are equal if their bits are: 0 and -0 differ, and a NaN equals itself.
bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

struct Difference {
  double time_s;
  std::string text;
};

// The first value of a dataset that differs, in the rows and columns that both runs have.
std::optional<Difference> first_difference(const std::vector<SavedRun>& runs,
                                           const std::string& path) {
  const LoggedSignal& a = runs[0].dataset(path);
  const LoggedSignal& b = runs[1].dataset(path);
  if (a.width != b.width) return std::nullopt;
  const std::size_t count = std::min(a.rows, b.rows) * a.width;
  const auto end = a.values.begin() + static_cast<std::ptrdiff_t>(count);
  const auto found = std::mismatch(a.values.begin(), end, b.values.begin(), same_bits);
  if (found.first == end) return std::nullopt;
  const auto place = static_cast<std::size_t>(found.first - a.values.begin());
  const std::string base = path.substr(0, path.find('/')) + "/time_s";
  const std::string index = a.width > 1 ? fmt::format("[{}]", place % a.width + 1) : "";
  const std::string unit = path == base ? "s" : runs[0].entry(path).unit_of(place % a.width + 1);
  const double time_s = runs[0].dataset(base).values[place / a.width];
  return Difference{
      time_s,
      fmt::format("{}{} at {} s: {} and {}, by {:.3g}{}{}", path, index, time_s, *found.first,
                  *found.second, *found.second - *found.first, unit.empty() ? "" : " ", unit)};
}

using Words = std::vector<std::string>;

// The names of a list that are in another one too, or that are not.
Words part_of(Words names, const Words& others, bool are_in_both) {
  std::erase_if(names, [&](const std::string& name) {
    return (std::find(others.begin(), others.end(), name) != others.end()) != are_in_both;
  });
  return names;
}

Words datasets(const SavedRun& run) {
  Words paths;
  std::set<std::string> groups;
  for (const LogEntry& entry : run.signals()) {
    if (groups.insert(entry.group).second) paths.push_back(entry.group + "/time_s");
    paths.push_back(entry.group + "/" + entry.name);
  }
  return paths;
}

std::string result_of(const SavedRun& run) {
  const std::optional<Failure>& failure = run.failure();
  return failure ? fmt::format("{} at {} s ({})", failure->verb(), failure->time_s, failure->reason)
                 : "complete";
}

void add_pair(Words& lines, const std::string& what, const std::string& a, const std::string& b) {
  if (a != b) lines.push_back(what + ": " + a + " and " + b);
}

void add_only(Words& lines, const std::vector<SavedRun>& runs, const std::string& what,
              const Words (&names)[2]) {
  for (std::size_t i = 0; i < 2; ++i) {
    const Words only = part_of(names[i], names[1 - i], false);
    if (only.empty()) continue;
    lines.push_back(fmt::format("only {} has the {}: {}", runs[i].folder().string(), what,
                                fmt::join(only, " ")));
  }
}

void add_samples(Words& lines, const std::vector<SavedRun>& runs) {
  const Words all[] = {datasets(runs[0]), datasets(runs[1])};
  const Words paths = part_of(all[0], all[1], true);
  std::optional<Difference> first;
  std::size_t count = 0;
  Words sizes;
  for (const std::string& path : paths) {
    const LoggedSignal& a = runs[0].dataset(path);
    const LoggedSignal& b = runs[1].dataset(path);
    if (a.width != b.width) {
      sizes.push_back(fmt::format("{}: {} and {} columns", path, a.width, b.width));
    }
    // All signals of a track have the rows of its time base.
    if (a.rows != b.rows && path.ends_with("/time_s")) {
      sizes.push_back(
          fmt::format("{}: {} and {} rows", path.substr(0, path.find('/')), a.rows, b.rows));
    }
    const auto difference = first_difference(runs, path);
    if (!difference) continue;
    ++count;
    if (!first || difference->time_s < first->time_s) first = difference;
  }
  if (first) {
    lines.push_back(first->text);
    lines.push_back(fmt::format("{} of {} common signals differ", count, paths.size()));
  }
  lines.insert(lines.end(), sizes.begin(), sizes.end());
  add_only(lines, runs, "signals", all);
}

void add_metrics(Words& lines, const std::vector<SavedRun>& runs) {
  Words names[2];
  for (std::size_t i = 0; i < 2; ++i) {
    for (const Metric& metric : runs[i].metrics()) names[i].push_back(metric.name);
  }
  for (const std::string& name : part_of(names[0], names[1], true)) {
    const double a = *runs[0].metric(name);
    const double b = *runs[1].metric(name);
    if (!same_bits(a, b)) add_pair(lines, name, fmt::format("{}", a), fmt::format("{}", b));
  }
  // A failed run has none, and its result says so.
  if (!runs[0].failure() && !runs[1].failure()) add_only(lines, runs, "metrics", names);
}

// One line for each kind of difference, the first different sample first.
Words differences(const std::vector<SavedRun>& runs) {
  const SavedRun& a = runs[0];
  const SavedRun& b = runs[1];
  Words lines;
  add_pair(lines, "scenario", a.scenario(), b.scenario());
  if (!lines.empty()) return lines;
  add_samples(lines, runs);
  add_pair(lines, "result", result_of(a), result_of(b));
  const bool have_hashes = !a.state_hash().empty() && !b.state_hash().empty();
  if (have_hashes) add_pair(lines, "state hash", a.state_hash(), b.state_hash());
  add_pair(lines, "case", a.case_name(), b.case_name());
  for (const DifferingKey& key : differing_keys(runs)) {
    add_pair(lines, key.key, key.values[0], key.values[1]);
  }
  if (a.models() != b.models()) lines.push_back("model files differ");
  add_metrics(lines, runs);
  return lines;
}

}  // namespace

int diff_main(const Catalogue&, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " diff";
  return guarded(program, [&] {
    CLI::App app("find the first sample in which two runs differ", program);
    std::vector<std::string> folders;
    bool quiet = false;
    app.add_option("RUN", folders, "the folders of two finished runs")->required()->expected(2);
    app.add_flag("--quiet", quiet, "print errors only");
    app.footer(
        "It compares the bits of all signals, the results, configurations, models and metrics.\n"
        "Equal runs print nothing. Exit status: 0 equal, 1 different, 2 usage or input.");
    if (const auto status = parse(app, argc, argv)) return *status;

    std::vector<SavedRun> runs;
    for (const std::string& folder : folders) runs.emplace_back(folder);
    for (const SavedRun& run : runs) warn("diff", run.notes());
    const Words lines = differences(runs);
    if (!quiet) {
      for (const std::string& line : lines) fmt::print("{}\n", one_line(line));
    }
    return lines.empty() ? static_cast<int>(kSuccess) : kDifferent;
  });
}

}  // namespace breakwater
