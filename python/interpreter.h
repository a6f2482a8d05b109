// The interpreter's lock, in threads that Python may end. At exit Python unwinds threads that wait
// for the lock, which C++ does not survive.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>

#include <breakwater/math/float_environment.h>

namespace breakwater::python {
namespace py = pybind11;

/// Set when the interpreter is about to end: work without the lock must stop.
const std::atomic<bool>& is_ending();

/// Throws Python's SystemExit, which ends a thread silently, if the interpreter is about to end.
/// The caller has the lock.
void check_not_ending();

/// Acquires the lock.
class Locked {
 public:
  Locked();
  ~Locked() { PyGILState_Release(state_); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  PyGILState_STATE state_;
};

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

/// Releases the lock within a Call. Throws as check_not_ending().
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// A call that neither takes nor makes objects of Python.
using Apart = py::call_guard<Call, Unlocked>;

/// Runs Python's signal handlers, which only the main thread has. Throws what they throw, and
/// Interrupted if the interpreter is about to end. The caller lacks the lock.
void obey_signals();

/// Calls a Python object like PyObject_Vectorcall(). The caller has the lock.
PyObject* call_python(PyObject* callable, PyObject* const* arguments, std::size_t flags);

/// Makes Python's exit wait.
void bind_exit();

}  // namespace breakwater::python
