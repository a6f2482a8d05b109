#include <breakwater/program/study_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <breakwater/cluster/slurm.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/study/study.h>

namespace breakwater {
namespace {

constexpr const char* kWhat = "The study (in a study file: the keys of these names)";
constexpr const char* kHow = "How";
constexpr const char* kBegun = "With a study that was begun";

enum class As { names, text, number, other };

// An option that defines the study, with its place in a study file. Options of kind `other` have
// code of their own.
struct WhatOption {
  const char* option;
  const char* type;
  const char* help;
  As as = As::other;
  const char* table = "";  // empty: top level of the file
  const char* key = "";
};

constexpr WhatOption kCase = {
    "--case",  "NAME[,NAME...]", "the case; several, or all, are compared",
    As::names, "compare",        "case"};
constexpr WhatOption kOthers[] = {
    {"--vary", "KEY=VALUES",
     "vary a key over values: 1,2,5 or lin(A,B,N) or log(A,B,N). Random methods also\n"
     "take uniform(A,B), log_uniform(A,B), normal(MEAN,DEVIATION). Repeat the option\n"
     "for another key"},
    {"--seeds", "SEEDS", "the same for each sample and case: 1..20 or 1,4,7"},
    {"--method", "NAME",
     "how values are put together: grid (the default), list, random, lhs, sobol,\n"
     "saltelli (for sensitivity indices)",
     As::text, "", "method"},
    {"--samples", "N", "how many are drawn", As::number, "", "samples"},
    {"--sampling-seed", "N", "of what is drawn (default: 1)", As::number, "", "sampling_seed"},
    {"--baseline", "NAME", "the case that others are compared with", As::text, "compare",
     "baseline"},
    {"--metrics", "NAME[,NAME...]", "what is compared (default: all metrics)", As::names, "compare",
     "metrics"},
    {"--goal", "METRIC=GOAL",
     "what is better in a metric: METRIC=min or METRIC=max; may be given again"},
    {"--require", "METRIC=MIN..MAX",
     "rank only candidates within these bounds; one of them may be left out: ..0.6"},
    {"--worlds", "WHAT",
     "what a comparison counts: samples (the default; seeds repeat them, or are the\n"
     "worlds where no key is varied), or seeds: each of every sample",
     As::text, "compare", "worlds"},
    {"--keep", "WHAT", "whose folders, with logs: metrics (none, the default), failed, all",
     As::text, "", "keep"},
    {"--on-failure", "WHAT",
     "a failed run is a result (count, the default), or ends the study (stop)", As::text, "",
     "on_failure"}};

void add_what(CLI::App& app, SweepOptions& options, const WhatOption& what) {
  CLI::Option* const added = app.add_option(what.option, options.what[what.option], what.help)
                                 ->type_name(what.type)
                                 ->group(kWhat)
                                 ->expected(1);
  const bool may_repeat = std::string_view(what.type).find('=') != std::string_view::npos;
  if (what.as == As::names || may_repeat) added->take_all();
}

// Removes a key from a table, whether it is written as "a.b" = 1 or a.b = 1.
void take_out(toml::table& table, const std::string& key) {
  table.erase(key);
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return;
  const std::string first = key.substr(0, dot);
  toml::node* inner = table.get(first);
  if (inner == nullptr || !inner->is_table()) return;
  take_out(*inner->as_table(), key.substr(dot + 1));
  if (inner->as_table()->empty()) table.erase(first);
}

std::pair<std::string, std::string> key_and_value(const std::string& option,
                                                  const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw std::invalid_argument(option + ": " + text + ": must be of the form KEY=VALUE");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

toml::table& table_in(toml::table& tables, const std::string& name, const std::string& file) {
  if (!tables.contains(name)) tables.insert(name, toml::table{});
  if (tables.get(name)->is_table()) return *tables.get(name)->as_table();
  throw std::invalid_argument(file + ": " + name + ": must be a table");
}

// The value that the text is, or the text: a word without quotes.
void put_text(toml::table& into, const std::string& key, const std::string& text,
              const std::string& option) {
  if (const auto parsed = parse_toml_value(text, option)) {
    into.insert_or_assign(key, *parsed->get("value"));
  } else {
    into.insert_or_assign(key, text);
  }
}

// The tables of a study file, with the options merged in.
class OptionTables {
 public:
  OptionTables(toml::table& tables, const SweepOptions& options)
      : tables_(tables), options_(options) {}

  void lay_what(const WhatOption& what) {
    const std::vector<std::string>& given = options_.what.at(what.option);
    if (given.empty()) return;
    toml::table& into = table(what.table);
    if (what.as == As::text) into.insert_or_assign(what.key, given.back());
    if (what.as == As::number) put_text(into, what.key, given.back(), what.option);
    if (what.as == As::names) {
      toml::array names;
      for (const std::string& name : given) {
        for (const std::string& part : option_parts(name)) {
          if (part.empty()) {
            throw std::invalid_argument(
                fmt::format("{}: {}: a name is missing", what.option, name));
          }
          names.push_back(part);
        }
      }
      into.insert_or_assign(what.key, std::move(names));
    }
  }

  void lay_run() {
    const RunChanges& run = options_.run;
    if (!run.config.empty()) {
      tables_.insert_or_assign("config",
                               std::filesystem::absolute(run.config).lexically_normal().string());
    }
    lay_sets(all_sets(run), options_.study.target, tables_);
  }

  void lay_varied() {
    for (const auto& [key, text] : pairs("--vary")) {
      const toml::table value = option_value("--vary: " + key, text);
      take_out(table("vary"), key);
      put(table("vary"), key, *value.get("value"));
    }
  }

  void lay_seeds() {
    const std::vector<std::string>& given = options_.what.at("--seeds");
    if (given.empty()) return;
    const std::string& text = given.back();
    const std::size_t dots = text.find("..");
    if (dots == std::string::npos) {
      return put(tables_, "seeds", *option_value("--seeds", text).get("value"));
    }
    const auto range = parse_toml_value(
        fmt::format("{{ first = {}, last = {} }}", text.substr(0, dots), text.substr(dots + 2)),
        "--seeds");
    if (!range) throw std::invalid_argument("--seeds: " + text + ": must be 1..20 or 1,4,7");
    put(tables_, "seeds", *range->get("value"));
  }

  void lay_goals() {
    std::string goals;  // one table, in the order of the options
    for (const auto& [metric, goal] : pairs("--goal")) {
      goals +=
          fmt::format("{}{} = {}", goals.empty() ? "" : ", ", toml_key(metric), toml_string(goal));
    }
    if (goals.empty()) return;
    const auto parsed = parse_toml_value(fmt::format("{{ {} }}", goals), "--goal").value();
    toml::table& compare = table("compare");
    if (!compare["goal"].is_table()) compare.insert_or_assign("goal", toml::table{});
    for (const auto& [metric, goal] : *parsed["value"].as_table()) {
      compare["goal"].as_table()->insert_or_assign(metric, goal);
    }
  }

  void lay_requirements() {
    for (const auto& [metric, text] : pairs("--require")) {
      const std::size_t dots = std::min(text.find(".."), text.size());
      const std::string ends[] = {text.substr(0, dots),
                                  text.substr(std::min(dots + 2, text.size()))};
      toml::table bounds;
      for (const std::size_t end : {0, 1}) {
        const auto number = number_in(ends[end]);
        if (dots == text.size() || (!number && !ends[end].empty())) {
          throw std::invalid_argument(
              fmt::format("--require: {}: {}: must be MIN..MAX, MIN.. or ..MAX", metric, text));
        }
        if (number) bounds.insert_or_assign(end == 0 ? "min" : "max", *number);
      }
      table("require").insert_or_assign(metric, std::move(bounds));
    }
  }

 private:
  toml::table& table(const std::string& name) {
    return name.empty() ? tables_ : table_in(tables_, name, options_.study.target);
  }

  // KEY=VALUE of an option that may be repeated for other keys.
  std::vector<std::pair<std::string, std::string>> pairs(const std::string& option) const {
    std::vector<std::pair<std::string, std::string>> all;
    std::set<std::string> keys;
    for (const std::string& text : options_.what.at(option)) {
      all.push_back(key_and_value(option, text));
      if (keys.insert(all.back().first).second) continue;
      throw std::invalid_argument(option + ": " + all.back().first + ": is given twice");
    }
    return all;
  }

  static void put(toml::table& into, const std::string& key, const toml::node& value) {
    into.insert_or_assign(key, value);
  }

  toml::table& tables_;
  const SweepOptions& options_;
};

}  // namespace

bool SweepOptions::says_what() const {
  return !study.out.empty() || !run.config.empty() || !run.sets.empty() || !run.duration.empty() ||
         std::any_of(what.begin(), what.end(), [](const auto& one) { return !one.second.empty(); });
}

void add_sweep_options(CLI::App& app, SweepOptions& options) {
  add_what(app, options, kCase);
  add_run_changes(app, options.run, "another scenario file", "a key of every run", kWhat);
  for (const WhatOption& what : kOthers) add_what(app, options, what);
  add_study_options(
      app, options.study,
      {.target =
           "a scenario, a scenario file, a study file, or the folder of a study, to go on with it",
       .out = "the study's folder (default: studies/NAME)",
       .dry_run = "count the runs, say how long they will take, from one of each case, and exit",
       .slurm = "submit what is left to do as one array job",
       .how = kHow,
       .begun = kBegun});
  app.add_flag("--sqlite", options.sqlite, "write results.sqlite as well")->group(kHow);
  app.add_flag("--all", options.all, "print the comparison of every metric and all notes")
      ->group(kHow);
  app.add_flag("--collect", options.study.collect, "write results.csv of what is done, and exit")
      ->group(kBegun);
  app.add_option("--replay", options.study.replay,
                 "repeat this point (its first digits suffice) with its log in DIR/runs/POINT.\n"
                 "Exit status 3 if the result differs")
      ->type_name("POINT")
      ->group(kBegun);
  app.add_option("--points", options.study.points,
                 "run these points alone (0-99,120, or @FILE:LINE), as a task of a scheduler does")
      ->type_name("LIST")
      ->group(kBegun);
  for (const char* option : {"--replay", "--points", "--collect"}) {
    app.get_option("--rerun")->excludes(app.get_option(option));
  }
  app.add_flag("--wait", options.study.wait, "until all tasks have ended; then collect")
      ->group(kOnCluster);
  app.add_flag("--print-tasks", options.study.print_tasks,
               "print what is left to do as commands, one a line, for any other scheduler")
      ->group(kOnCluster);
}

void lay_sets(const std::vector<std::string>& sets, const std::string& file, toml::table& tables) {
  for (const std::string& set : sets) {
    const auto [key, text] = key_and_value("--set", set);
    toml::table& into = table_in(tables, "set", file);
    take_out(into, key);
    put_text(into, key, text, "--set: " + key);
  }
}

void lay_on(const SweepOptions& options, toml::table& tables) {
  const std::vector<std::string>& cases = options.what.at(kCase.option);
  if (!cases.empty()) tables.erase("case");
  OptionTables laid(tables, options);
  laid.lay_what(kCase);
  laid.lay_run();
  laid.lay_varied();
  laid.lay_seeds();
  for (const WhatOption& what : kOthers) laid.lay_what(what);
  laid.lay_goals();
  laid.lay_requirements();
}

}  // namespace breakwater
