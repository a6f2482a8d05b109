// The thesis' printed numbers as reference values of the shipped cases.
#pragma once

#include <breakwater/experiment/references.h>

namespace breakwater {

/// For the catalogue: tables and pages show the printed numbers beside a run's own.
ReferenceKind printed_references();

}  // namespace breakwater
