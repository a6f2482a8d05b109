#include <breakwater/identification/identified_keys.h>

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <stdexcept>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>

namespace breakwater {

namespace {

double value_of(const std::string& expression, const IdentifiedNumbers& numbers) {
  const auto number = [&](const std::string& name) {
    const auto found = numbers.find(name);
    return found != numbers.end() ? std::optional(found->second) : std::nullopt;
  };
  return MetricExpression(expression, number, {}).value();
}

}  // namespace

std::string with_numbers(const std::string& text, const IdentifiedNumbers& numbers) {
  constexpr int kDigits = 12;
  std::string filled;
  std::size_t from = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', from)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) throw std::invalid_argument(text + ": lacks a \">\"");
    const double value = value_of(text.substr(at + 1, end - at - 1), numbers);
    filled += text.substr(from, at - from) + fmt::format("{:.{}g}", value, kDigits);
    from = end + 1;
  }
  return filled + text.substr(from);
}

std::vector<std::string> IdentifiedKeys::sets(bool is_drawn,
                                              const IdentifiedNumbers& numbers) const {
  std::vector<std::string> sets;
  for (const Key& key : keys) {
    if (key.is_drawn != is_drawn) continue;
    if (!key.needs.empty() && value_of(key.needs, numbers) == 0.0) continue;
    sets.push_back(with_numbers(key.set, numbers));
  }
  return sets;
}

IdentifiedKeys identified_keys(const Catalogue& catalogue, const std::string& model) {
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    const std::string file = kind.file().replace_filename("identified.toml").string();
    if (!std::filesystem::exists(file)) continue;
    const toml::table table = parse_toml_file(file);
    const TomlEntry root(table, file);
    if (root["model"].text() != model) continue;
    IdentifiedKeys found{kind.name, root["case"].text(), {}};
    for (const bool is_drawn : {true, false}) {
      for (const auto& [name, entry] : root[is_drawn ? "drawn" : "set"].entries()) {
        if (!entry.node()->is_table()) {
          found.keys.push_back({is_drawn, "", name + "=" + entry.text()});
          continue;
        }
        for (const auto& [key, value] : entry.entries()) {
          found.keys.push_back({is_drawn, name, key + "=" + value.text()});
        }
      }
    }
    return found;
  }
  return {};
}

}  // namespace breakwater
