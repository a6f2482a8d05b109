#include <breakwater/program/study_command.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include <breakwater/config/toml_text.h>
#include <breakwater/study/study.h>

namespace breakwater {
namespace {

constexpr const char* kWhat = "The study (in a study file: the keys of these names)";
constexpr const char* kHow = "How";
constexpr const char* kBegun = "With a study that was begun";

// The value of a key in a study file from an option's text, as the table {"value": …}.
using ValueOf = toml::table (*)(const std::string& option, const std::string& text);

toml::table word(const std::string&, const std::string& text) {
  return toml::table{{"value", text}};
}

// The value that the text is, or the text: a word without quotes.
toml::table value_or_word(const std::string& option, const std::string& text) {
  return parse_toml_value(text, option).value_or(word(option, text));
}

toml::table names(const std::string& option, const std::string& text) {
  toml::array names;
  for (const std::string& part : option_parts(text)) {
    if (part.empty()) {
      throw std::invalid_argument(fmt::format("{}: {}: a name is missing", option, text));
    }
    names.push_back(part);
  }
  return toml::table{{"value", std::move(names)}};
}

toml::table seeds(const std::string& option, const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return option_value(option, text);
  const auto range = parse_toml_value(
      fmt::format("{{ first = {}, last = {} }}", text.substr(0, dots), text.substr(dots + 2)),
      option);
  if (!range) throw std::invalid_argument(option + ": " + text + ": must be 1..20 or 1,4,7");
  return *range;
}

toml::table bounds(const std::string& option, const std::string& text) {
  const std::size_t dots = std::min(text.find(".."), text.size());
  const std::string ends[] = {text.substr(0, dots), text.substr(std::min(dots + 2, text.size()))};
  toml::table bounds;
  for (const std::size_t end : {0, 1}) {
    const auto number = number_in(ends[end]);
    if (dots == text.size() || (!number && !ends[end].empty())) {
      throw std::invalid_argument(
          fmt::format("{}: {}: must be MIN..MAX, MIN.. or ..MAX", option, text));
    }
    if (number) bounds.insert_or_assign(end == 0 ? "min" : "max", *number);
  }
  return toml::table{{"value", std::move(bounds)}};
}

// An option that defines the study, with its place in a study file.
struct WhatOption {
  const char* option;
  const char* type;
  const char* help;
  ValueOf value;
  const char* table;        // empty: top level of the file
  const char* key;          // empty: the option has KEY=VALUE for each of some keys
  bool is_ordered = false;  // whether the order of such keys counts
};

constexpr WhatOption kCase = {"--case", "NAME[,NAME...]", "the case; several, or all, are compared",
                              names,    "compare",        "case"};
constexpr WhatOption kOthers[] = {
    {"--vary", "KEY=VALUES",
     "vary a key over values: 1,2,5 or lin(A,B,N) or log(A,B,N). Random methods also\n"
     "take uniform(A,B), log_uniform(A,B), normal(MEAN,DEVIATION). Repeat the option\n"
     "for another key",
     option_value, "vary", ""},
    {"--seeds", "SEEDS", "the same for each sample and case: 1..20 or 1,4,7", seeds, "", "seeds"},
    {"--method", "NAME",
     "how values are put together: grid (the default), list, random, lhs, sobol,\n"
     "saltelli (for sensitivity indices)",
     word, "", "method"},
    {"--samples", "N", "how many are drawn", value_or_word, "", "samples"},
    {"--sampling-seed", "N", "of what is drawn (default: 1)", value_or_word, "", "sampling_seed"},
    {"--baseline", "NAME", "the case that others are compared with", word, "compare", "baseline"},
    {"--metrics", "NAME[,NAME...]", "what is compared (default: all metrics)", names, "compare",
     "metrics"},
    {"--goal", "METRIC=GOAL",
     "what is better in a metric: METRIC=min or METRIC=max; may be given again", word,
     "compare.goal", "", true},
    {"--require", "METRIC=MIN..MAX",
     "rank only candidates within these bounds; one of them may be left out: ..0.6", bounds,
     "require", ""},
    {"--worlds", "WHAT",
     "what a comparison counts: samples (the default; seeds repeat them, or are the\n"
     "worlds where no key is varied), or seeds: each of every sample",
     word, "compare", "worlds"},
    {"--keep", "WHAT", "whose folders, with logs: metrics (none, the default), failed, all", word,
     "", "keep"},
    {"--on-failure", "WHAT",
     "a failed run is a result (count, the default), or ends the study (stop)", word, "",
     "on_failure"}};

bool has_pairs(const WhatOption& what) {
  return *what.key == 0;
}

void add_what(CLI::App& app, SweepOptions& options, const WhatOption& what) {
  CLI::Option* const added = app.add_option(what.option, options.what[what.option], what.help)
                                 ->type_name(what.type)
                                 ->group(kWhat)
                                 ->expected(1);
  if (what.value == names || has_pairs(what)) added->take_all();
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

// Merges an option into the tables of a study file.
void lay(const WhatOption& what, const SweepOptions& options, toml::table& tables) {
  const std::vector<std::string>& given = options.what.at(what.option);
  if (given.empty()) return;
  toml::table* into = &tables;
  std::istringstream path(what.table);
  for (std::string name; std::getline(path, name, '.');) {
    into = &table_in(*into, name, options.study.target);
  }
  if (!has_pairs(what)) {
    const std::string text = fmt::format("{}", fmt::join(given, ","));
    into->insert_or_assign(what.key, *what.value(what.option, text).get("value"));
    return;
  }
  std::set<std::string> keys;
  for (const std::string& text : given) {
    const auto [key, value] = key_and_value(what.option, text);
    const std::string place = fmt::format("{}: {}", what.option, key);
    if (!keys.insert(key).second) throw std::invalid_argument(place + ": is given twice");
    if (!what.is_ordered) take_out(*into, key);
    toml::source_region source{};
    if (what.is_ordered) source.begin.column = static_cast<toml::source_index>(keys.size());
    into->insert_or_assign(toml::key(key, source), *what.value(place, value).get("value"));
  }
}

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
    into.insert_or_assign(key, *value_or_word("--set: " + key, text).get("value"));
  }
}

void lay_on(const SweepOptions& options, toml::table& tables) {
  if (!options.what.at(kCase.option).empty()) tables.erase("case");
  lay(kCase, options, tables);
  if (!options.run.config.empty()) {
    const auto config = std::filesystem::absolute(options.run.config).lexically_normal();
    tables.insert_or_assign("config", config.string());
  }
  lay_sets(all_sets(options.run), options.study.target, tables);
  for (const WhatOption& what : kOthers) lay(what, options, tables);
}

}  // namespace breakwater
