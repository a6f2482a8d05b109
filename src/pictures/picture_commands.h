// breakwater video | still | strip: pictures of finished runs.
#pragma once

#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Exit statuses: 0 success, 1 a defect of Breakwater, 2 usage or input, 4 the picture could not be
/// made or written, 130 interrupted.
std::vector<CommandKind> picture_commands();

}  // namespace breakwater
