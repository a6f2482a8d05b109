// The files of an identification.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/recorded/identified_scenario.h>

namespace breakwater {

/// identified.json: each parameter's value, interval and identifiability, and "fit" with the
/// errors, the whiteness and the notes.
std::string identified_json(const Identification& identification);

/// identified.toml, a file of a scenario with the identified plant, encoder and period. Its
/// comments have the distributions of the parameters for [vary] of a sweep.
std::string identified_toml(const Catalogue& catalogue, const Identification& identification,
                            const IdentifiedScenarioKind& scenario);

/// A table of the parameters, for the terminal.
std::string parameter_table(const Identification& identification, std::size_t width);

}  // namespace breakwater
