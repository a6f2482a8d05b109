#include <breakwater/identification/two_inertia_outputs.h>

#include <fmt/format.h>

#include <algorithm>

#include <breakwater/experiment/runner.h>
#include <breakwater/identification/identified_study.h>

namespace breakwater {

std::string two_inertia_toml(const Catalogue& catalogue, const Identification& identification,
                             const IdentifiedTwoInertiaKind& scenario, Side measured) {
  const AxisData& data = identification.data;
  const AxisValues& values = identification.fit.values;
  const IdentifiedTwoInertia plant{.linear = {.motor_inertia = values[kMotorInertia],
                                              .load_inertia = values[kLoadInertia],
                                              .stiffness = values[kStiffness],
                                              .damping = values[kDamping],
                                              .motor_friction = values[kMotorViscous],
                                              .load_friction = values[kLoadViscous]},
                                   .backlash = values[kBacklash],
                                   .motor_coulomb = values[kMotorCoulomb],
                                   .load_coulomb = values[kLoadCoulomb],
                                   .delay_s = std::max(0.0, values[kDelay]),
                                   .period_s = rounded_period(data.period_s),
                                   .quantum = data.quantum,
                                   .rounding = data.rounding,
                                   .noise_std = identification.fit.noise_std,
                                   .measured = measured};
  const auto file = catalogue.get<ScenarioKind>(scenario.name).scenario_file();
  const std::string left_out =
      values[kOffset] == 0.0
          ? ""
          : fmt::format(
                "# Left out, since this scenario has no constant torque: offset {:.6g} N m\n",
                values[kOffset]);
  return left_out +
         prepare_run(catalogue, scenario.name, *file, scenario.case_name, scenario.sets(plant))
             .config_text;
}

}  // namespace breakwater
