#include <breakwater/pictures/finished_run.h>

#include <fmt/core.h>

#include <stdexcept>

#include <breakwater/experiment/known_models.h>

namespace breakwater {

std::filesystem::path shots_file(const ScenarioKind& kind, const Config& config) {
  std::filesystem::path shots = kind.shots();
  const auto model = config.text("model.mjcf");
  if (!model) return shots;
  try {
    const std::filesystem::path file = config.find_file_of("model.mjcf", *model);
    const std::filesystem::path own = file.parent_path() / shots.filename();
    return std::filesystem::is_regular_file(own) ? own : shots;
  } catch (const std::invalid_argument&) {
    return shots;  // a page needs no model
  }
}

FinishedRun::FinishedRun(const Catalogue& catalogue, SavedRun saved)
    : catalogue_(&catalogue), saved_(std::move(saved)), notes_(saved_.notes()) {
  if (!catalogue.has<ScenarioKind>(saved_.scenario())) {
    if (!saved_.has_signal("qpos")) {
      throw std::invalid_argument(folder().string() + ": is a run of \"" + saved_.scenario() +
                                  "\", whose log has no qpos: there is no motion to draw");
    }
    throw std::invalid_argument(folder().string() + ": is a run of scenario \"" +
                                saved_.scenario() +
                                "\", which this program does not have: draw it with the program "
                                "that made it");
  }
  const auto& kind = catalogue.get<ScenarioKind>(saved_.scenario());
  scenario_ = kind.make(catalogue);
  const ScenarioFile file((folder() / "config.toml").string(), kind.name);
  config_ = std::make_unique<Config>(file.config(case_name()));
  shots_file_ = breakwater::shots_file(kind, *config_);
  read_settings(kind);
  note_changed_models();

  if (times_s().size() < 2 || qpos().rows < 2) {
    throw std::invalid_argument(log_file() + ": is too short to show anything");
  }
}

// Pictures need few keys, and none of a controller. Unknown keys and values are no error here.
void FinishedRun::read_settings(const ScenarioKind& kind) {
  scenario_->learn(*config_);
  Fields fields = scenario_->fields();
  const std::vector<std::string> missing = fields.read_finished(*config_);
  if (missing.empty() || !std::filesystem::exists(kind.file())) return;
  const auto shipped = kind.scenario_file();
  const Config values =
      shipped->config(shipped->has_case(case_name()) ? case_name() : shipped->default_case());
  for (const std::string& key : missing) {
    const ConfigEntry* entry = values.find(key);
    if (entry == nullptr) continue;
    config_->apply({{key, *entry}});
    notes_.push_back(
        fmt::format("{}: has no {}, since it is of another version: using the value of "
                    "{}",
                    (folder() / "config.toml").string(), key, entry->origin));
  }
  fields.read_finished(*config_);
}

void FinishedRun::note_changed_models() {
  const auto model = config_->text("model.mjcf");
  if (!model) return;
  try {
    for (const auto& [file, hash] : model_hashes({config_->find_file_of("model.mjcf", *model)})) {
      const auto then = saved_.models().find(file);
      if (then == saved_.models().end() || then->second == hash) continue;
      notes_.push_back(fmt::format("{}: has changed since the run {}", file, folder().string()));
    }
  } catch (const std::invalid_argument&) {
    return;  // a page needs no model
  }
}

Model FinishedRun::load_scene() const {
  const auto name = config_->text("model.mjcf");
  if (!name) config_->fail("model.mjcf", "is missing: there is nothing to draw");
  ModelFile file(config_->find_file_of("model.mjcf", *name));
  if (const auto most = config_->number("model.most_elements")) {
    file.most_elements = static_cast<std::uint64_t>(*most);
  }
  Model model = Model::load(file);
  if (static_cast<std::size_t>(model->nq) != qpos().width) {
    throw std::invalid_argument(log_file() + ": its qpos has " + std::to_string(qpos().width) +
                                " values, but " + model.file() + " has " +
                                std::to_string(model->nq));
  }
  scenario_->prepare_model(model);
  return model;
}

Series FinishedRun::value(const std::string& key_or_signal) const {
  if (const auto number = config_->number(key_or_signal)) {
    return {{times_s().front(), end_s()}, {*number, *number}};
  }
  return saved_.signal(key_or_signal);
}

std::string FinishedRun::fill_in(const std::string& text) const {
  std::string filled = text;
  std::size_t open = filled.find('{');
  while (open != std::string::npos) {
    const std::size_t end = filled.find('}', open);
    if (end == std::string::npos) {
      throw std::invalid_argument("\"" + text + "\": a { has no }");
    }
    const std::string key = filled.substr(open + 1, end - open - 1);
    const auto number = config_->number(key);
    const auto words = config_->text(key);
    if (!number && !words) {
      config_->fail(key, "must be a number or a text, since \"" + text + "\" shows it");
    }
    const std::string value = number ? fmt::format("{:g}", *number) : *words;
    filled.replace(open, end - open + 1, value);
    open = filled.find('{', open + value.size());
  }
  return filled;
}

}  // namespace breakwater
