// What Python gives as numbers, checked and named; what it gets as arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace breakwater::python {
namespace py = pybind11;

/// A reference that may be let go wherever, with or without the interpreter's lock.
using SharedObject = std::shared_ptr<PyObject>;
SharedObject share(py::object object);

/// What `object` is, for messages: "an array of shape (2, 3)", "None", "a str".
std::string description(const py::handle& object);

/// An array of doubles in C's order. Throws std::invalid_argument `NAME: must be …` unless it is
/// made of real numbers.
py::array_t<double> numbers(const py::handle& object, const std::string& name);

/// Finite ones; a matrix from one number or two dimensions. Throws std::invalid_argument
/// `NAME: must be …`.
double number(const py::handle& object, const std::string& name);
Eigen::VectorXd vector(const py::handle& object, const std::string& name);
Eigen::MatrixXd matrix(const py::handle& object, const std::string& name);
/// Of `size` entries; one number stands for all of them.
Eigen::VectorXd vector_of(const py::handle& object, Eigen::Index size, const std::string& name);
/// Of rows × columns.
Eigen::MatrixXd matrix_of(const py::handle& object, Eigen::Index rows, Eigen::Index columns,
                          const std::string& name);

/// Copies.
py::array_t<double> array(std::span<const double> values);
py::array_t<double> array(const Eigen::Ref<const Eigen::VectorXd>& values);
py::array_t<double> matrix_array(const Eigen::MatrixXd& values);

/// A view without a copy of doubles that `owner` holds, which it keeps alive; not to be written.
py::array view_of(const double* data, std::vector<py::ssize_t> shape,
                  std::vector<py::ssize_t> strides, const py::object& owner);

}  // namespace breakwater::python
