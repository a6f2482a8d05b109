#include <breakwater/study/slurm_settings.h>

#include <fmt/format.h>

#include <breakwater/config/toml_text.h>
#include <breakwater/shell/process.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {

SlurmSettings read_slurm(const StudyReader& reader, const toml::table& tables) {
  SlurmSettings slurm;
  const toml::table* const found = reader.table(tables, "slurm");
  if (found == nullptr) return slurm;
  const toml::table& table = *found;
  reader.allow(table, "slurm.",
               {"account", "partition", "constraint", "modules", "environment", "options"});
  // A newline would begin a line of the script.
  const auto checked = [&](const char* key, const std::string& text) {
    if (one_line(text) != text) {
      reader.fail(*table.get(key), std::string("slurm.") + key,
                  "must have no newline and no other control character, is " + text);
    }
    return text;
  };
  const auto text = [&](const char* key) {
    return checked(key, reader.text_or_nothing(table, key, "slurm."));
  };
  const auto list = [&](const char* key) {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::vector<std::string>();
    std::vector<std::string> texts = reader.texts(*node, std::string("slurm.") + key);
    for (const std::string& one : texts) checked(key, one);
    return texts;
  };
  slurm.account = text("account");
  slurm.partition = text("partition");
  slurm.constraint = text("constraint");
  slurm.modules = list("modules");
  slurm.environment = list("environment");
  slurm.options = list("options");
  for (const std::string& line : slurm.environment) {
    if (line.find('=') == std::string::npos || line.front() == '=') {
      reader.fail(*table.get("environment"), "slurm.environment", line + ": must be NAME=VALUE");
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
    if (!values.empty()) text += fmt::format("{} = {}\n", key, toml_text(values));
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
