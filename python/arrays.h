// Conversion of Python's arguments to checked arrays with names, and of results to NumPy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "interpreter.h"

namespace breakwater::python {
namespace py = pybind11;

/// A reference that may be released with or without the interpreter's lock.
using SharedObject = std::shared_ptr<PyObject>;
SharedObject share(py::object object);

/// A description of `object` for messages: "an array of shape (2, 3)", "None", "a str".
std::string description(const py::handle& object);

/// Whether it is an array of NumPy's own class.
bool is_plain_array(const py::handle& object);
/// Whether it is an array with a mask.
bool is_masked(const py::handle& object);

/// An array of doubles in C order, NaN where a mask is. Throws std::invalid_argument
/// (`NAME: must be …`) unless it has real numbers.
py::array_t<double> numbers(const py::handle& object, const std::string& name);

/// Text, and a whole number that fits an int. Throws std::invalid_argument (`NAME: must be …`).
std::string utf8(const py::handle& object, const std::string& name);
int whole_number(const py::handle& object, const std::string& name);

/// The value of one of these texts. Throws std::invalid_argument (`NAME: must be …`).
template <typename Value>
Value one_of(const py::handle& object, const std::string& name,
             const std::vector<std::pair<const char*, Value>>& options) {
  const std::string chosen = utf8(object, name);
  std::string names;
  for (const auto& [option, value] : options) {
    if (chosen == option) return value;
    names += (names.empty() ? "" : ", ") + std::string(option);
  }
  throw std::invalid_argument(name + ": must be one of " + names + ", is \"" + chosen + "\"");
}

/// Finite numbers. A matrix comes from a number or from two dimensions. Throws
/// std::invalid_argument (`NAME: must be …`).
double number(const py::handle& object, const std::string& name);
Eigen::VectorXd vector(const py::handle& object, const std::string& name);
Eigen::MatrixXd matrix(const py::handle& object, const std::string& name);
/// A vector with `size` entries. A single number fills all entries.
Eigen::VectorXd vector_of(const py::handle& object, Eigen::Index size, const std::string& name);

/// Copies to NumPy.
py::array_t<double> array(std::span<const double> values);
py::array_t<double> array(const Eigen::Ref<const Eigen::VectorXd>& values);
py::array_t<double> matrix_array(const Eigen::MatrixXd& values);

/// A read-only view of doubles without a copy. It keeps `owner`, which has the data, alive.
py::array view_of(const double* data, std::vector<py::ssize_t> shape,
                  std::vector<py::ssize_t> strides, const py::object& owner);

/// A class whose objects cannot be used before their __init__.
template <typename T>
py::class_<T> bind_class(py::module_& module, const char* name, const char* doc = "") {
  py::class_<T> bound(module, name, doc);
  // pybind11 would make an object without a constructor.
  py::detail::get_type_info(typeid(T))->operator_new = [](std::size_t) -> void* {
    throw std::invalid_argument("the object has no contents: __init__ was not called");
  };
  return bound;
}

/// Binds a method for users. Calls without its arguments, such as "u, y", get one line.
template <typename T, typename Method, typename... Extra>
void bind_method(py::class_<T>& bound, const std::string& name, const std::string& takes,
                 const Method& method, const std::string& doc, const Extra&... extra) {
  bound.def(name.c_str(), method, (name + "($self, " + takes + ")\n--\n\n" + doc).c_str(),
            OwnCall(), extra...);
  bound.def(name.c_str(),
            [line = name + "() takes " + takes](const py::object& /*self*/, const py::args&,
                                                const py::kwargs&) -> py::object {
              throw py::type_error(line);
            });
}

}  // namespace breakwater::python
