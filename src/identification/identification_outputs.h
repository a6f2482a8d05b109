// The files of an identification.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/recorded/identified_scenario.h>
#include <breakwater/recorded/recorded_estimation.h>

namespace breakwater {

/// identified.json: each parameter's value, interval and identifiability, and "fit" with the
/// errors, the whiteness and the notes.
std::string identified_json(const Identification& identification);

/// identified.toml, a file of a scenario with the identified plant, encoder and period.
std::string identified_toml(const Catalogue& catalogue, const Identification& identification,
                            const IdentifiedScenarioKind& scenario);

/// The table of a record, as its user named and scaled it.
struct RecordSource {
  std::string file;
  std::string config;  ///< a file of `estimate` with further keys, or empty
  RecordFormat format;
  InputActs input_acts = InputActs::after;
};

/// estimate.toml, a file of `breakwater estimate` with this table, plant, encoder and noise.
std::string estimate_toml(const Catalogue& catalogue, const Identification& identification,
                          const RecordSource& source);

/// "yes" or "no", and whether the interval is too narrow, because the residuals are not white.
std::string identifiable_text(const Identification& identification,
                              const ParameterEstimate& estimate);

/// The file of a scenario with the identified plant, encoder and period.
std::string two_inertia_toml(const Catalogue& catalogue, const Identification& identification,
                             const IdentifiedTwoInertiaKind& scenario, Side measured);

/// The data of report.html: the parameters, the fit over the data, its residuals with their test,
/// and the profiles of the likelihood. The errors stand beside those of a plain model. `warnings`
/// are of the records.
PageData identification_result(const Identification& identification,
                               const std::vector<std::string>& warnings,
                               const std::string& command);

/// A table of the parameters, for the terminal.
std::string parameter_table(const Identification& identification, std::size_t width);

/// Fits the model of an axis to recorded data. Exit status 3 if the fit did not converge, or if the
/// held-out records disagree with it.
CommandKind identify_command();

}  // namespace breakwater
