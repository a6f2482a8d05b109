#include "arrays.h"
#include "interpreter.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace breakwater::python {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& wish,
                         const py::handle& object) {
  throw std::invalid_argument(name + ": must be " + wish + ", is " + description(object));
}

std::string shape_of(const py::array& array) {
  return py::str(py::tuple(array.attr("shape"))).cast<std::string>();
}

void check_finite(const py::array_t<double>& values, const std::string& name) {
  const double* const data = values.data();
  for (py::ssize_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(data[i])) continue;
    throw std::invalid_argument(name + ": must be finite, entry " + std::to_string(i) + " is " +
                                (std::isnan(data[i]) ? "nan" : "infinite"));
  }
}

bool is_real(const py::array& array) {
  return std::strchr("fiu", array.dtype().kind()) != nullptr;
}

// NumPy would take the numbers under a mask, also of the arrays in a list.
py::array array_of(const py::handle& object) {
  bool has_mask = is_masked(object);
  if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
    for (const py::handle& entry : object) has_mask = has_mask || is_masked(entry);
  }
  if (!has_mask) return py::array::ensure(py::reinterpret_borrow<py::object>(object));
  py::object masked = py::module_::import("numpy.ma").attr("array")(object);
  if (!is_real(py::array(masked))) return masked;
  return masked.attr("astype")(py::dtype::of<double>())
      .attr("filled")(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

bool is_plain_array(const py::handle& object) {
  return Py_IS_TYPE(object.ptr(), py::detail::npy_api::get().PyArray_Type_) != 0;
}

bool is_masked(const py::handle& object) {
  return py::isinstance<py::array>(object) && !is_plain_array(object) &&
         py::isinstance(object, py::module_::import("numpy.ma").attr("MaskedArray"));
}

SharedObject share(py::object object) {
  return {object.release().ptr(), [](PyObject* pointer) {
            const Locked lock;
            Py_XDECREF(pointer);
          }};
}

std::string description(const py::handle& object) {
  if (object.is_none()) return "None";
  if (py::isinstance<py::array>(object)) {
    const auto array = py::reinterpret_borrow<py::array>(object);
    return "an array of shape " + shape_of(array) + " and dtype " +
           py::str(array.dtype()).cast<std::string>();
  }
  if (py::isinstance<py::int_>(object)) {
    const auto bits = object.attr("bit_length")().cast<int>();
    if (bits > 64) return "an integer of " + std::to_string(bits) + " bits";
  }
  if (py::isinstance<py::float_>(object) || py::isinstance<py::int_>(object)) {
    return py::repr(object).cast<std::string>();
  }
  const auto type = py::type::of(object).attr("__name__").cast<std::string>();
  if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
    return "a " + type + " of length " + std::to_string(py::len(object));
  }
  return "of type " + type;
}

py::array_t<double> numbers(const py::handle& object, const std::string& name) {
  const auto any = object.is_none() ? py::array() : array_of(object);
  if (object.is_none() || !any || !is_real(any)) refuse(name, "an array of real numbers", object);
  return py::array_t<double, py::array::c_style | py::array::forcecast>(any);
}

std::string utf8(const py::handle& object, const std::string& name) {
  Py_ssize_t size = 0;
  const char* const utf8 =
      PyUnicode_Check(object.ptr()) ? PyUnicode_AsUTF8AndSize(object.ptr(), &size) : nullptr;
  if (utf8 != nullptr) return {utf8, static_cast<std::size_t>(size)};
  PyErr_Clear();
  refuse(name, "text in UTF-8", object);
}

int whole_number(const py::handle& object, const std::string& name) {
  if (PyLong_Check(object.ptr())) {
    int overflow = 0;
    const long value = PyLong_AsLongAndOverflow(object.ptr(), &overflow);
    if (overflow == 0 && std::in_range<int>(value)) return static_cast<int>(value);
  }
  refuse(name, "a whole number of 32 bits", object);
}

double number(const py::handle& object, const std::string& name) {
  if (PyFloat_CheckExact(object.ptr()) && std::isfinite(PyFloat_AS_DOUBLE(object.ptr()))) {
    return PyFloat_AS_DOUBLE(object.ptr());
  }
  const py::array_t<double> value = numbers(object, name);
  if (value.ndim() != 0) refuse(name, "one number", object);
  check_finite(value, name);
  return *value.data();
}

Eigen::VectorXd vector(const py::handle& object, const std::string& name) {
  const py::array_t<double> values = numbers(object, name);
  if (values.ndim() != 1) refuse(name, "a vector, of one dimension", object);
  check_finite(values, name);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), values.size());
}

Eigen::MatrixXd matrix(const py::handle& object, const std::string& name) {
  const py::array_t<double> values = numbers(object, name);
  if (values.ndim() != 0 && values.ndim() != 2) refuse(name, "a matrix, of two dimensions", object);
  check_finite(values, name);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const bool is_number = values.ndim() == 0;
  return Eigen::Map<const RowMajor>(values.data(), is_number ? 1 : values.shape(0),
                                    is_number ? 1 : values.shape(1));
}

Eigen::VectorXd vector_of(const py::handle& object, Eigen::Index size, const std::string& name) {
  if (numbers(object, name).ndim() == 0)
    return Eigen::VectorXd::Constant(size, number(object, name));
  Eigen::VectorXd values = vector(object, name);
  if (values.size() != size) refuse(name, "of " + std::to_string(size) + " numbers", object);
  return values;
}

py::array_t<double> array(std::span<const double> values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array_t<double> array(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return py::array_t<double>(values.size(), values.data());
}

py::array_t<double> matrix_array(const Eigen::MatrixXd& values) {
  py::array_t<double> copy({values.rows(), values.cols()});
  auto entries = copy.mutable_unchecked<2>();
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) entries(i, j) = values(i, j);
  }
  return copy;
}

py::array view_of(const double* data, std::vector<py::ssize_t> shape,
                  std::vector<py::ssize_t> strides, const py::object& owner) {
  py::array view(py::dtype::of<double>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

}  // namespace breakwater::python
