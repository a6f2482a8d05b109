// The interpreter's lock, in threads that Python may end. At its exit it stops those that wait for
// the lock where they are, by unwinding them, which C++ cannot survive.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>

namespace breakwater::python {
namespace py = pybind11;

/// Set when the interpreter is about to end: what runs without its lock is to stop.
const std::atomic<bool>& is_ending();

/// Throws Python's SystemExit, of which a thread ends in silence, if the interpreter is about to
/// end. The lock is held.
void check_not_ending();

/// Has the lock.
class Locked {
 public:
  Locked();
  ~Locked() { PyGILState_Release(state_); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  PyGILState_STATE state_;
};

/// Is without the lock. The interpreter's exit waits for such threads, a while. Throws as
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

/// Calls a Python object with the lock held, as PyObject_Vectorcall() does.
PyObject* call_python(PyObject* callable, PyObject* const* arguments, std::size_t flags);

/// Has Python's exit wait.
void bind_exit();

}  // namespace breakwater::python
