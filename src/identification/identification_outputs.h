// The command that identifies an axis, and its files.
#pragma once

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Fits the model of an axis to recorded data. Exit status 3 if the fit did not converge, or if the
/// held-out records disagree with it.
CommandKind identify_command();

}  // namespace breakwater
