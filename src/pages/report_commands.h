// breakwater report | compare | replay: pages about runs.
#pragma once

#include <vector>

#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Exit statuses: 0 success, 1 an internal error, 2 usage or input, 4 a picture could not be made,
/// 130 interrupted.
std::vector<CommandKind> report_commands();

}  // namespace breakwater
