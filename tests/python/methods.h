// Helpers that show structs and enumerations to Python, and the contents of the module by source.
#pragma once

#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <sstream>

namespace breakwater::python_methods {
namespace py = pybind11;

void bind_identification(py::module_& module);
void bind_predictive_control(py::module_& module);
void bind_quadrotor(py::module_& module);
void bind_waves(py::module_& module);

// A struct and its fields. `names` begin with its own. Python makes one from fields by name.
template <typename Record, typename... Fields>
void record(py::module_& module, const char* names, Fields Record::*... fields) {
  std::istringstream words(names);
  std::string name;
  words >> name;
  py::class_<Record> made(module, name.c_str());
  ((words >> name, made.def_readwrite(name.c_str(), fields)), ...);
  made.def(py::init([](const py::kwargs& values) {
    const py::object filled = py::cast(Record{});
    for (const auto& [field, value] : values) py::setattr(filled, field, value);
    return filled.cast<Record>();
  }));
}

// An enumeration, whose name is the first of `names`.
template <typename Choice>
void choice(py::module_& module, const char* names) {
  std::istringstream words(names);
  std::string name;
  words >> name;
  py::enum_<Choice> made(module, name.c_str());
  for (int i = 0; words >> name; ++i) made.value(name.c_str(), Choice(i));
}

}  // namespace breakwater::python_methods
