#include <breakwater/experiment/differing_keys.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <breakwater/config/config.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostKeysInLabel = 3;
const std::string kAbsent = "–";

Config config_of(const SavedRun& run) {
  const std::string file = (run.folder() / "config.toml").string();
  return ScenarioFile(file, run.scenario()).config(run.case_name());
}

std::vector<DifferingKey> differing_keys(const std::vector<Config>& configs) {
  std::set<std::string> keys;
  for (const Config& config : configs) {
    for (const auto& [key, entry] : config.entries()) keys.insert(key);
  }
  std::vector<DifferingKey> differing;
  for (const std::string& key : keys) {
    DifferingKey row{key, {}};
    std::set<std::pair<std::string, bool>> distinct;  // a text may read as a number does
    for (const Config& config : configs) {
      const ConfigEntry* entry = config.find(key);
      row.values.push_back(entry == nullptr ? kAbsent : short_value(entry->value));
      distinct.emplace(row.values.back(), config.text(key).has_value());
    }
    if (distinct.size() > 1) differing.push_back(row);
  }
  return differing;
}

// " with mine": the label must show that a run does not have its case's own part.
std::string parts_in_words(const std::vector<DifferingKey>& changed) {
  std::string words;
  for (const DifferingKey& key : changed) {
    if (key.key.ends_with(".name")) words += (words.empty() ? " with " : " and ") + key.values[0];
  }
  return words;
}

// Whether a configuration has an axis that the other, a file with axes, lacks.
bool has_own_axis(const Config& config, const Config& other) {
  const std::vector<std::string> own = config.names_in("axis"), axes = other.names_in("axis");
  return !axes.empty() && std::any_of(own.begin(), own.end(), [&](const std::string& name) {
    return std::find(axes.begin(), axes.end(), name) == axes.end();
  });
}

}  // namespace

std::vector<DifferingKey> changed_keys(const Catalogue& catalogue, const fs::path& folder,
                                       const std::string& scenario, const std::string& case_name) {
  std::vector<DifferingKey> changed;
  if (!catalogue.has<ScenarioKind>(scenario)) return changed;
  try {
    const auto& kind = catalogue.get<ScenarioKind>(scenario);
    const auto file = kind.scenario_file();
    if (!file->has_case(case_name)) return changed;
    const Config shipped = file->config(case_name);
    const Config own = ScenarioFile((folder / "config.toml").string(), scenario).config(case_name);
    if (has_own_axis(own, shipped)) return changed;
    changed = differing_keys({own, shipped});
    std::erase_if(changed, [](const DifferingKey& key) {
      return key.values[0] == kAbsent || key.values[1] == kAbsent;
    });
  } catch (const std::invalid_argument&) {
    changed.clear();  // the run may be of another version
  }
  return changed;
}

std::string label_of(const Catalogue& catalogue, const fs::path& folder,
                     const std::string& scenario, const std::string& case_name) {
  return case_name + parts_in_words(changed_keys(catalogue, folder, scenario, case_name));
}

std::vector<DifferingKey> differing_keys(const std::vector<SavedRun>& runs) {
  std::vector<Config> configs;
  for (const SavedRun& run : runs) configs.push_back(config_of(run));
  return differing_keys(configs);
}

std::vector<std::string> labels_of(const Catalogue& catalogue, const std::vector<SavedRun>& runs) {
  std::vector<std::string> with_keys, folders, paths;
  std::map<std::string, std::vector<std::size_t>> of_case;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const SavedRun& run = runs[i];
    const fs::path folder = fs::absolute(run.folder()).lexically_normal();
    with_keys.push_back(run.case_name());
    folders.push_back((folder.has_filename() ? folder : folder.parent_path()).filename().string());
    paths.push_back(run.folder().string());
    of_case[run.scenario() + "/" + run.case_name()].push_back(i);
  }
  const auto are_distinct = [](const std::vector<std::string>& names) {
    return std::set<std::string>(names.begin(), names.end()).size() == names.size();
  };
  for (const auto& [name, numbers] : of_case) {
    if (numbers.size() < 2) {
      const SavedRun& run = runs[numbers.front()];
      with_keys[numbers.front()] =
          label_of(catalogue, run.folder(), run.scenario(), run.case_name());
      continue;
    }
    std::vector<Config> configs;
    try {
      for (const std::size_t i : numbers) configs.push_back(config_of(runs[i]));
    } catch (const std::invalid_argument&) {
      continue;  // The configuration cannot be read: use the folder as the label.
    }
    const std::vector<DifferingKey> keys = differing_keys(configs);
    if (keys.size() > kMostKeysInLabel) continue;
    for (const DifferingKey& key : keys) {
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        with_keys[numbers[k]] += fmt::format(", {}={}", key.key, key.values[k]);
      }
    }
  }
  for (const auto& names : {with_keys, folders}) {
    if (are_distinct(names)) return names;
  }
  return paths;
}

}  // namespace breakwater
