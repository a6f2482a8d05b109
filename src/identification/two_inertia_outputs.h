// identified.toml of a motor and a load.
#pragma once

#include <string>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/recorded/identified_two_inertia.h>

namespace breakwater {

/// The file of a scenario with the identified plant, encoder and period.
std::string two_inertia_toml(const Catalogue& catalogue, const Identification& identification,
                             const IdentifiedTwoInertiaKind& scenario, Side measured);

}  // namespace breakwater
