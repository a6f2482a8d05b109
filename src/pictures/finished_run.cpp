#include <breakwater/pictures/finished_run.h>

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <breakwater/record/run_folder.h>
#include <breakwater/scenario/run_manifest.h>

namespace breakwater {
namespace {

std::vector<Series> columns(const std::vector<double>& times_s, const LoggedSignal& signal) {
  std::vector<Series> all(signal.width, Series{times_s, std::vector<double>(signal.rows)});
  for (std::size_t i = 0; i < signal.rows; ++i) {
    for (std::size_t k = 0; k < signal.width; ++k) all[k].values[i] = signal.row(i)[k];
  }
  return all;
}

}  // namespace

FinishedRun::FinishedRun(const Catalogue& catalogue, const std::filesystem::path& folder)
    : folder_(folder) {
  restore_run(folder_);
  for (const char* file : {"manifest.json", "config.toml", "log.h5"}) {
    if (!std::filesystem::is_regular_file(folder_ / file)) {
      throw std::invalid_argument(folder_.string() + ": is not a finished run: it has no " + file);
    }
  }
  const RunManifest manifest = read_manifest(folder_);
  check_log(folder_);
  case_name_ = manifest.case_name;
  const ScenarioKind& kind = catalogue.get<ScenarioKind>(manifest.scenario);
  scenario_ = kind.make(catalogue);
  shots_file_ = kind.shots();

  const ScenarioFile file((folder_ / "config.toml").string(), scenario_->name());
  config_ = std::make_unique<Config>(file.config(case_name_));
  Fields fields = scenario_->fields();
  fields.read(file, *config_);
  scenario_->check(*config_);

  times_s_ = read_hdf5_signal(log_file(), "control/time_s").values;
  qpos_ = read_hdf5_signal(log_file(), "control/qpos");
  if (times_s_.size() < 2 || qpos_.rows != times_s_.size()) {
    throw std::invalid_argument(log_file() + ": is too short to show anything");
  }
}

Model FinishedRun::load_scene() const {
  const ConfigEntry* entry = config_->find("model.mjcf");
  const auto* name = entry != nullptr ? std::get_if<std::string>(&entry->value.data) : nullptr;
  if (name == nullptr) config_->fail("model.mjcf", "is missing: there is nothing to draw");
  Model model = Model::load(config_->find_file_of("model.mjcf", *name));
  if (static_cast<std::size_t>(model->nq) != qpos_.width) {
    throw std::invalid_argument(log_file() + ": its qpos has " + std::to_string(qpos_.width) +
                                " values, but " + model.file() + " has " +
                                std::to_string(model->nq));
  }
  scenario_->prepare_scene(model);
  return model;
}

std::vector<Series> FinishedRun::vector_signal(const std::string& name) const {
  const LoggedSignal logged = read_hdf5_signal(log_file(), "control/" + name);
  if (logged.rows != times_s_.size()) {
    throw std::invalid_argument(log_file() + ": control/" + name + " is incomplete");
  }
  return columns(times_s_, logged);
}

Series FinishedRun::signal(const std::string& name) const {
  const SignalName wanted = signal_name(name);
  std::vector<Series> all = vector_signal(wanted.name);
  const std::size_t index = std::max<std::size_t>(1, wanted.index);
  if (index > all.size() || (wanted.index == 0 && all.size() > 1)) {
    throw std::invalid_argument(log_file() + ": " + name + ": the signal has " +
                                std::to_string(all.size()) + " values; say which: NAME[1]");
  }
  return std::move(all[index - 1]);
}

Series FinishedRun::value(const std::string& key_or_signal) const {
  if (const auto number = config_->number(key_or_signal)) {
    return {{times_s_.front(), end_s()}, {*number, *number}};
  }
  return signal(key_or_signal);
}

std::string FinishedRun::fill_in(const std::string& text) const {
  std::string filled = text;
  std::size_t open = filled.find('{');
  while (open != std::string::npos) {
    const std::size_t end = filled.find('}', open);
    if (end == std::string::npos) {
      throw std::invalid_argument("\"" + text + "\": a { without its }");
    }
    const std::string key = filled.substr(open + 1, end - open - 1);
    const ConfigEntry* entry = config_->find(key);
    std::string value;
    if (const auto number = config_->number(key)) {
      value = fmt::format("{:g}", *number);
    } else if (entry != nullptr && std::holds_alternative<std::string>(entry->value.data)) {
      value = std::get<std::string>(entry->value.data);
    } else {
      config_->fail(key, "is no number or text that \"" + text + "\" could name");
    }
    filled.replace(open, end - open + 1, value);
    open = filled.find('{', open + value.size());
  }
  return filled;
}

}  // namespace breakwater
