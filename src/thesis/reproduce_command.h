// `breakwater reproduce`: the thesis' experiments, judged by its printed numbers.
#pragma once

#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Exit statuses: 0 success, 1 a defect of ours, 2 usage or input, 4 a picture or video could not
/// be made, 130 interrupted.
CommandKind reproduce_command();

}  // namespace breakwater
