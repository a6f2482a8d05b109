// `breakwater reproduce`: runs the thesis' experiments and judges them by the printed results.
#pragma once

#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Exit status: 0 success, 1 an internal error, 2 usage or input, 4 a picture or video could not be
/// made, 130 interrupted.
CommandKind reproduce_command();

}  // namespace breakwater
