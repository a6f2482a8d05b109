// Design of controllers and observers, and quadratic programs, from Python.
#pragma once

#include <pybind11/pybind11.h>

namespace breakwater::python {

void bind_linear(pybind11::module_& module);

}  // namespace breakwater::python
