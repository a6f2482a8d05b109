// What Breakwater brings with it.
#pragma once

#include "scenario/catalogue.h"

namespace breakwater {

/// All scenarios of this folder.
Catalogue standard_catalogue();

}  // namespace breakwater
