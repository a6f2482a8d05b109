// The ranking of candidates from arrays.
#pragma once

#include <pybind11/pybind11.h>

namespace breakwater::python {

void bind_comparisons(pybind11::module_& module);

}  // namespace breakwater::python
