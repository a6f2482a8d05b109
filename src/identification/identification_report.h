// The page of an identification.
#pragma once

#include <string>

#include <breakwater/identification/identified_axis.h>
#include <breakwater/pages/html_page.h>

namespace breakwater {

/// The data of report.html: the parameters, the fit over the data, its residuals with their test,
/// and the profiles of the likelihood. The errors stand beside those of a plain model.
PageData identification_result(const Identification& identification, const std::string& command);

}  // namespace breakwater
