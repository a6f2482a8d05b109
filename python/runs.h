// Runs for Python: made here or read from their folders.
#pragma once

#include <pybind11/pybind11.h>

namespace breakwater::python {

void bind_runs(pybind11::module_& module);

}  // namespace breakwater::python
