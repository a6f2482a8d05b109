// The reference, in Markdown, as the program itself knows it.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Every command with its --help, which this program is called for.
/// Throws std::invalid_argument if the program cannot be called.
std::string commands_page(const Catalogue& catalogue);

/// The purpose of a scenario; its cases, keys, metrics, and the columns of its log. Runs each of
/// its cases with the sets (key=value) `brief_run`, since that shows the columns. Throws
/// std::invalid_argument if its scenario file is wrong.
std::string scenario_page(const Catalogue& catalogue, const ScenarioKind& kind,
                          const std::vector<std::string>& brief_run);

/// The meaning of each exit status.
std::string exit_statuses_page();

}  // namespace breakwater
