#include <breakwater/identification/identification_outputs.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <breakwater/experiment/runner.h>
#include <breakwater/identification/axis_intervals.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

double largest_input(const AxisData& data) {
  double largest = 0.0;
  for (const AxisStretch& stretch : data.stretches) {
    for (const double u : stretch.inputs) largest = std::max(largest, std::abs(u));
  }
  return largest;
}

// Jitter leaves the mean interval a little beside a round period.
double rounded(double period_s) {
  const double few_digits = std::stod(fmt::format("{:.3g}", period_s));
  return std::abs(few_digits - period_s) < 1e-4 * period_s ? few_digits : period_s;
}

nlohmann::ordered_json errors_json(const FitErrors& errors) {
  return {{"rms_rad", errors.rms},
          {"plain_rms_rad", errors.plain_rms},
          {"normalised", errors.normalised}};
}

}  // namespace

std::string identified_json(const Identification& identification) {
  nlohmann::ordered_json json;
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
  }
  nlohmann::ordered_json& fit = json["fit"];
  fit["converged"] = identification.is_converged;
  fit["interval"] = identification.is_bootstrapped ? "parametric bootstrap" : "profile likelihood";
  fit["rows"] = identification.data.rows();
  fit["stretches"] = identification.data.stretches.size();
  fit["period_s"] = identification.data.period_s;
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
  const AxisData& data = identification.data;
  const AxisValues& values = identification.fit.values;
  const IdentifiedPlant plant{.inertia = values[kInertia],
                              .viscous_friction = values[kViscous],
                              .coulomb_friction = values[kCoulomb],
                              .breakaway_friction = values[kBreakaway],
                              .stribeck_speed = values[kStribeckSpeed],
                              .delay_s = values[kDelay],
                              .period_s = rounded(data.period_s),
                              .quantum = data.quantum,
                              .rounding = data.rounding,
                              .noise_std = identification.fit.noise_std,
                              .largest_torque = values[kTorqueConstant] * largest_input(data)};
  const std::string file = catalogue.get<ScenarioKind>(scenario.name).file().string();
  std::string text = prepare_run(catalogue, scenario.name, ScenarioFile(file, scenario.name),
                                 scenario.case_name, scenario.sets(plant))
                         .config_text +
                     "\n# For a study: draws from the parameters' distribution.\n# [vary]\n";
  for (const ParameterEstimate& estimate : identification.parameters) {
    const std::string key = estimate.parameter == kInertia   ? scenario.inertia_key
                            : estimate.parameter == kViscous ? scenario.viscous_key
                            : estimate.parameter == kCoulomb ? scenario.coulomb_key
                                                             : "";
    if (key.empty() || !(estimate.high > estimate.low)) continue;
    text += fmt::format("# \"{}\" = {{ normal = [{:.9g}, {:.9g}] }}{}\n", key, estimate.value,
                        0.5 * (estimate.high - estimate.low) / kRoot95,
                        estimate.is_identifiable ? "" : "  # not identifiable");
  }
  return text;
}

std::string parameter_table(const Identification& identification, std::size_t width) {
  Table table({"parameter", "value", "low", "high", "unit", "identifiable"});
  for (const ParameterEstimate& estimate : identification.parameters) {
    table.add({parameter_key(estimate.parameter), fmt::format("{:.7g}", estimate.value),
               fmt::format("{:.7g}", estimate.low), fmt::format("{:.5g}", estimate.high),
               parameter_unit(estimate.parameter), estimate.is_identifiable ? "yes" : "no"});
  }
  return table.print(width);
}

}  // namespace breakwater
