// The files of an identification.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/recorded/identified_scenario.h>
#include <breakwater/recorded/record_keys.h>

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

}  // namespace breakwater
