// The printed numbers of the thesis as reference values of the shipped cases.
#pragma once

#include <breakwater/experiment/references.h>

namespace breakwater {

/// The reference values for the catalogue: tables and pages show them beside those of a run.
ReferenceKind printed_references();

}  // namespace breakwater
