#include <breakwater/experiment/catalogue.h>

#include <map>
#include <mutex>
#include <utility>

#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>
#include <breakwater/shell/paths.h>

namespace breakwater {

std::filesystem::path ScenarioKind::file() const {
  const std::string file = name + ".toml";
  std::error_code error;
  if (!folder.empty() && std::filesystem::is_directory(folder, error)) return folder / file;
  return data_file("scenarios/" + name + "/" + file);
}

std::shared_ptr<const ScenarioFile> ScenarioKind::scenario_file(const std::string& config) const {
  if (!config.empty()) return std::make_shared<const ScenarioFile>(config, name);
  static std::mutex reading;
  static std::map<std::pair<std::string, std::string>, std::shared_ptr<const ScenarioFile>> known;
  const std::string path = file().string(), text = toml_file_text(path);
  const std::lock_guard lock(reading);
  auto& read = known[{name, path}];
  if (!read || read->text() != text) read = std::make_shared<const ScenarioFile>(path, name);
  return read;
}

std::filesystem::path ScenarioKind::shots() const {
  const char* file = "shots.toml";
  std::error_code error;
  if (!folder.empty() && std::filesystem::is_directory(folder, error)) return folder / file;
  return look_for("scenarios/" + name + "/" + file).value_or(this->file().parent_path() / file);
}

std::string scenario_name_in(const Catalogue& catalogue, const std::string& file) {
  const toml::table table = parse_toml_file(file);
  const TomlEntry entry = TomlEntry(table, file)["scenario"];
  const std::string name = entry.text();
  try {
    return catalogue.get<ScenarioKind>(name).name;
  } catch (const std::invalid_argument& error) {
    entry.fail(error.what());
  }
}

std::unique_ptr<Scenario> make_scenario(const Catalogue& catalogue, const std::string& name) {
  return catalogue.get<ScenarioKind>(name).make(catalogue);
}

}  // namespace breakwater
