// breakwater report | compare | replay: pages about runs.
#pragma once

#include <string>
#include <vector>

#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Exit statuses: 0 success, 1 an internal error, 2 usage or input, 4 a picture could not be made,
/// 130 interrupted.
std::vector<CommandKind> report_commands();

/// The Python that draws figures: BREAKWATER_PYTHON, or Debian's own Python, which finds Debian's
/// packages.
std::string figure_python();

}  // namespace breakwater
