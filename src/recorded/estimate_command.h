// The command `estimate`.
#pragma once

#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Runs an estimator of the catalogue on recorded data, and leaves a folder as a run does.
CommandKind estimate_command();

}  // namespace breakwater
