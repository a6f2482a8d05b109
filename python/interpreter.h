// The interpreter's lock, in threads that Python may end. At exit Python unwinds threads that wait
// for the lock, which C++ does not survive.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>

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

/// Releases the lock. The interpreter's exit waits some time for such threads. Throws as
/// check_not_ending().
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Calls a Python object like PyObject_Vectorcall(). The caller has the lock.
PyObject* call_python(PyObject* callable, PyObject* const* arguments, std::size_t flags);

/// Makes Python's exit wait.
void bind_exit();

}  // namespace breakwater::python
