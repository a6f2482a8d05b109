// The command `estimate`.
#pragma once

#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Runs an estimator of the catalogue on recorded data, and writes a folder like that of a run.
CommandKind estimate_command();

}  // namespace breakwater
