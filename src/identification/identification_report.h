// The page of an identification.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <breakwater/identification/identified_axis.h>
#include <breakwater/pages/html_page.h>

namespace breakwater {

/// The data of report.html: the parameters, the fit over the data, its residuals with their test,
/// and the profiles of the likelihood. The errors stand beside those of a plain model. `warnings`
/// are of the records.
PageData identification_result(const Identification& identification,
                               const std::vector<std::string>& warnings,
                               const std::string& command);

/// A table of the parameters, for the terminal.
std::string parameter_table(const Identification& identification, std::size_t width);

}  // namespace breakwater
