// The contents of the compiled part, by their sources.
#pragma once

#include <pybind11/pybind11.h>

namespace breakwater::python {
namespace py = pybind11;

/// The ranking of candidates from arrays.
void bind_comparisons(py::module_& module);
/// Design of controllers and observers, and quadratic programs.
void bind_linear(py::module_& module);
/// The library's estimators on arrays.
void bind_observers(py::module_& module);
/// Studies and tunings whose runs have parts in Python.
void bind_program(py::module_& module);
/// Runs: made here or read from their folders.
void bind_runs(py::module_& module);

}  // namespace breakwater::python
