#include <breakwater/program/run_changes.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>

namespace breakwater {
namespace {

// A number as TOML: "0.1" for ".1".
std::string as_toml_number(const std::string& text) {
  double value = 0.0;
  if (!CLI::detail::lexical_cast(text, value)) return text;
  const std::string digits = fmt::format("{}", value);
  return digits.find_first_of(".en") == std::string::npos ? digits + ".0" : digits;
}

}  // namespace

void add_run_changes(CLI::App& app, RunChanges& options, const std::string& config_help,
                     const std::string& set_help, const std::string& group) {
  app.add_option("--config", options.config, config_help)->type_name("FILE")->group(group);
  app.add_option("--set", options.sets, set_help)->type_name("KEY=VALUE")->group(group);
  app.add_option("--duration", options.duration, "the same as --set run.duration_s=S")
      ->type_name("S")
      ->check(is_number)
      ->group(group);
}

std::string is_number(const std::string& text) {
  double value = 0.0;
  return CLI::detail::lexical_cast(text, value) ? "" : "must be a number, is \"" + text + "\"";
}

void add_set(std::vector<std::string>& sets, const std::string& option, const std::string& key,
             const std::string& value) {
  if (value.empty()) return;
  for (const std::string& set : sets) {
    if (!set.starts_with(key + "=")) continue;
    throw std::invalid_argument(option + ": --set gives " + key + " too: leave one out");
  }
  sets.push_back(key + "=" + value);
}

std::vector<std::string> all_sets(const RunChanges& options) {
  std::vector<std::string> sets = options.sets;
  if (options.duration.empty()) return sets;
  add_set(sets, "--duration", "run.duration_s", as_toml_number(options.duration));
  return sets;
}

}  // namespace breakwater
