#include <breakwater/study/slurm_settings.h>

#include <fmt/format.h>

#include <breakwater/scenario/toml_text.h>
#include <breakwater/study/study_reader.h>

namespace breakwater {

SlurmSettings read_slurm(const StudyReader& reader, const toml::table& tables) {
  SlurmSettings slurm;
  const toml::table* const found = reader.table(tables, "slurm");
  if (found == nullptr) return slurm;
  const toml::table& table = *found;
  reader.allow(table, "slurm.",
               {"account", "partition", "constraint", "modules", "environment", "options"});
  const auto list = [&](const char* key) {
    const toml::node* node = table.get(key);
    return node == nullptr ? std::vector<std::string>()
                           : reader.texts(*node, std::string("slurm.") + key);
  };
  slurm.account = reader.text_or_nothing(table, "account", "slurm.");
  slurm.partition = reader.text_or_nothing(table, "partition", "slurm.");
  slurm.constraint = reader.text_or_nothing(table, "constraint", "slurm.");
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
