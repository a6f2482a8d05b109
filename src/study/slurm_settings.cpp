#include <breakwater/study/slurm_settings.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_text.h>
#include <breakwater/shell/process.h>

namespace breakwater {

std::string overriding(const std::string& options) {
  // As getopt does, sbatch takes the begin of a name too.
  static constexpr std::array kLong = {"--array",  "--chdir",  "--open-mode",
                                       "--output", "--signal", "--wrap"};
  static constexpr std::array kShort = {"-a", "-D", "-o"};
  constexpr std::size_t kShortestBegin = 4;  // "--ar": all options with one letter are ambiguous
  std::istringstream words(options);
  for (std::string word; words >> word;) {
    const std::string name = word.substr(0, word.find('='));
    const bool is_long =
        name.size() >= kShortestBegin && std::any_of(kLong.begin(), kLong.end(), [&](auto option) {
          return std::string_view(option).starts_with(name);
        });
    const bool is_short = std::any_of(kShort.begin(), kShort.end(),
                                      [&](auto option) { return word.starts_with(option); });
    if (is_long || is_short) return word + ": is an option that the job script sets: leave it out";
  }
  return "";
}

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
    const std::string name = line.substr(0, line.find('='));
    const bool is_name =
        !name.empty() && std::isdigit(static_cast<unsigned char>(name.front())) == 0 &&
        std::all_of(name.begin(), name.end(),
                    [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '_'); });
    if (!is_name || name.size() == line.size()) {
      table["environment"].fail(line + ": must be NAME=VALUE; a name has letters, digits and _");
    }
    if (name.starts_with("SLURM_")) {
      table["environment"].fail(line + ": is a variable that Slurm sets for each task");
    }
  }
  for (const std::string& line : slurm.options) {
    if (const std::string why = overriding(line); !why.empty()) table["options"].fail(why);
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
