// Studies and tunings whose runs have parts in Python.
#pragma once

#include <pybind11/pybind11.h>

namespace breakwater::python {

void bind_program(pybind11::module_& module);

}  // namespace breakwater::python
