// The library's estimators on arrays, from Python.
#pragma once

#include <pybind11/pybind11.h>

namespace breakwater::python {

void bind_observers(pybind11::module_& module);

}  // namespace breakwater::python
