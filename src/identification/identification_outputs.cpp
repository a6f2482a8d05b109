#include <breakwater/identification/identification_outputs.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <breakwater/config/toml_text.h>
#include <breakwater/experiment/runner.h>
#include <breakwater/identification/axis_parameters.h>
#include <breakwater/identification/identified_study.h>
#include <breakwater/recorded/record_keys.h>
#include <breakwater/recorded/recorded_estimation.h>

namespace breakwater {
namespace {

nlohmann::ordered_json errors_json(const FitErrors& errors) {
  return {{"rms_rad", errors.rms},
          {"plain_rms_rad", errors.plain_rms},
          {"normalised", errors.normalised}};
}

double time_step_of(const AxisData& data) {
  double step_s = 0.0;
  for (const AxisStretch& stretch : data.stretches) step_s = std::max(step_s, stretch.time_step_s);
  return step_s;
}

}  // namespace

std::string estimate_toml(const Catalogue& catalogue, const Identification& identification,
                          const RecordSource& source) {
  const IdentifiedPlant plant = identified_plant(identification);
  const ScenarioFile file(
      source.config.empty() ? recorded_estimation().file().string() : source.config, "estimate");
  std::vector<std::string> sets = {
      "csv.file=" + toml_string(source.file),
      "csv.time_column=" + toml_string(source.format.time_column),
      "csv.input_column=" + toml_string(source.format.input_column),
      "csv.position_column=" + toml_string(source.format.position_column),
      fmt::format("csv.input_acts={}", source.input_acts == InputActs::after ? "after" : "before"),
      rounding_set(plant.rounding)};
  const auto set = [&](const char* key, double value) { sets.push_back(number_set(key, value)); };
  set("csv.time_scale", source.format.time_scale);
  set("csv.time_std_s", time_step_of(identification.data) / std::sqrt(12.0));
  set("csv.input_scale", source.format.input_scale * identification.fit.values[kTorqueConstant]);
  set("csv.position_scale", source.format.position_scale);
  set("plant.inertia", plant.inertia);
  set("plant.viscous_friction", plant.viscous_friction);
  set("encoder.quantum", plant.quantum);
  set("noise.std", plant.noise_std);
  RecordedEstimation estimation(catalogue);
  Fields fields = estimation.fields();
  fields.read(file.config(file.default_case(), sets));
  return fields.print("estimate", file.default_case());
}

std::string identified_json(const Identification& identification) {
  nlohmann::ordered_json json;
  const AxisParameter known = identification.data.model->known_inertia;
  if (!identification.free[known]) {
    const double inertia = identification.fit.values[known];
    json[parameter_key(known)] = {{"value", inertia},
                                  {"low", inertia},
                                  {"high", inertia},
                                  {"identifiable", true},
                                  {"given", true}};
  }
  for (const ParameterEstimate& estimate : identification.parameters) {
    nlohmann::ordered_json& entry = json[parameter_key(estimate.parameter)];
    entry = {{"value", estimate.value},
             {"low", estimate.low},
             {"high", estimate.high},
             {"identifiable", estimate.is_identifiable}};
    if (!estimate.is_identifiable) {
      entry["reason"] = estimate.reason;
      entry["excitation"] = estimate.excitation;
    }
    if (!identification.whiteness.is_white()) entry["too_narrow"] = true;
  }
  nlohmann::ordered_json& fit = json["fit"];
  fit["converged"] = identification.is_converged;
  fit["interval"] = identification.is_bootstrapped ? "parametric bootstrap" : "profile likelihood";
  fit["rows"] = identification.data.rows();
  fit["stretches"] = identification.data.stretches.size();
  fit["period_s"] = identification.data.period_s;
  fit["time_step_s"] = time_step_of(identification.data);
  fit["quantum_rad"] = identification.data.quantum;
  fit["quantum_found"] = identification.is_quantum_found;
  fit["noise_std_rad"] = identification.fit.noise_std;
  fit["errors"] = errors_json(identification.errors);
  fit["white"] = identification.whiteness.is_white();
  fit["ljung_box"] = identification.whiteness.statistic;
  fit["ljung_box_limit"] = identification.whiteness.limit;
  if (identification.held_out) {
    fit["held_out"] = errors_json(*identification.held_out);
    fit["holds"] = identification.holds();
  }
  fit["notes"] = identification.notes;
  return json.dump(2) + "\n";
}

std::string identified_toml(const Catalogue& catalogue, const Identification& identification,
                            const IdentifiedScenarioKind& scenario) {
  const IdentifiedPlant plant = identified_plant(identification);
  std::vector<std::string> sets = scenario.plant_sets(plant);
  const std::vector<std::string> others = scenario.other_sets(plant);
  sets.insert(sets.end(), others.begin(), others.end());
  const auto file = catalogue.get<ScenarioKind>(scenario.name).scenario_file();
  return prepare_run(catalogue, scenario.name, *file, scenario.case_name, sets).config_text;
}

std::string identifiable_text(const Identification& identification,
                              const ParameterEstimate& estimate) {
  if (!estimate.is_identifiable) return "no";
  return identification.whiteness.is_white() ? "yes" : "yes, interval too narrow";
}

}  // namespace breakwater
