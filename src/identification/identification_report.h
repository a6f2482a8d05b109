// The page of an identification.
#pragma once

#include <string>

#include <breakwater/identification/identified_axis.h>

namespace breakwater {

/// report.html: the parameters, the fit over the data, its residuals with their test, and the
/// profiles of the likelihood. The errors stand beside those of a plain model.
std::string identification_report(const Identification& identification, const std::string& command);

}  // namespace breakwater
