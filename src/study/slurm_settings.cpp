#include <breakwater/study/slurm_settings.h>

#include <fmt/format.h>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/shell/process.h>

namespace breakwater {

SlurmSettings read_slurm(const TomlEntry& root) {
  const TomlEntry table = root["slurm"];
  table.allow({"account", "partition", "constraint", "modules", "environment", "options"});
  // A newline would add a line to the script.
  const auto check = [&](const char* key, const std::string& text) {
    if (one_line(text) == text) return;
    table[key].fail("must have no newline and no other control character, is " + text);
  };
  const auto text = [&](const char* key) {
    std::string found = table[key].text_or_nothing();
    check(key, found);
    return found;
  };
  const auto list = [&](const char* key) {
    std::vector<std::string> texts = table[key].texts();
    for (const std::string& one : texts) check(key, one);
    return texts;
  };
  SlurmSettings slurm;
  slurm.account = text("account");
  slurm.partition = text("partition");
  slurm.constraint = text("constraint");
  slurm.modules = list("modules");
  slurm.environment = list("environment");
  slurm.options = list("options");
  for (const std::string& line : slurm.environment) {
    if (line.find('=') == std::string::npos || line.front() == '=') {
      table["environment"].fail(line + ": must be NAME=VALUE");
    }
  }
  return slurm;
}

std::string SlurmSettings::print() const {
  std::string text;
  const auto line = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{} = {}\n", key, toml_string(value));
  };
  const auto lines = [&](const char* key, const std::vector<std::string>& values) {
    if (!values.empty()) text += fmt::format("{} = {}\n", key, toml_strings(values));
  };
  line("account", account);
  line("partition", partition);
  line("constraint", constraint);
  lines("modules", modules);
  lines("environment", environment);
  lines("options", options);
  return text.empty() ? text : "\n[slurm]\n" + text;
}

}  // namespace breakwater
