// Calls of the library by Python and of Python by the library, in threads that Python may end. At
// exit Python unwinds threads that wait for its lock, which C++ does not survive.
#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

#include <atomic>

#include <breakwater/math/float_environment.h>

namespace breakwater::python {
namespace py = pybind11;

/// Set when the interpreter is about to end: work without the lock must stop.
inline std::atomic<bool> is_ending = false;

/// Throws Python's SystemExit, which ends a thread silently, if the interpreter is about to end.
/// The caller has the lock.
void check_not_ending();

using Locked = py::gil_scoped_acquire;
using Unlocked = py::gil_scoped_release;

/// A call of the library by Python, with a floating-point environment of its own. The interpreter's
/// exit waits some time for its end: Python would unwind its thread, and then its destructors use
/// an interpreter without the lock. The caller has the lock. Throws as check_not_ending().
class Call {
 public:
  Call();
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  const math::FloatEnvironment floats_;
};
using OwnCall = py::call_guard<Call>;

/// A call that neither takes nor makes objects of Python.
using Apart = py::call_guard<Call, Unlocked>;

/// Runs Python's signal handlers, which only the main thread has. Throws what they throw, and
/// Interrupted if the interpreter is about to end. The caller lacks the lock.
void obey_signals();

/// Calls a user's method. If Python's exit does not wait for its end any longer, the thread waits
/// for the end of the process. The caller has the lock. Throws as check_not_ending().
template <typename... Arguments>
py::object call_python(const py::object& method, const Arguments&... arguments) {
  check_not_ending();
  const py::tuple all = py::make_tuple(arguments...);
  PyObject* result = nullptr;
  try {
    result = PyObject_CallObject(method.ptr(), all.ptr());
  } catch (abi::__forced_unwind&) {
    for (;;) pause();
  }
  if (result == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(result);
}

/// Makes Python's exit wait.
void bind_exit();

}  // namespace breakwater::python
