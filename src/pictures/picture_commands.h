// breakwater video | still | strip: pictures of finished runs.
#pragma once

#include <functional>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Exit statuses: 0 success, 1 a defect of Breakwater, 2 usage or input, 4 the picture could not be
/// made or written, 130 interrupted.
std::vector<CommandKind> picture_commands();

/// The exit status of `draw`. If something cannot be drawn or written, the run is still complete:
/// prints the reason and returns kLaterOutputFailed. Throws Interrupted if the drawing is stopped.
int drawing_status(const std::function<int()>& draw);

}  // namespace breakwater
