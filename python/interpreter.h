// The interpreter's lock, in threads that Python may end. At exit Python unwinds threads that wait
// for the lock, which C++ does not survive.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

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

/// The longest time between two looks for Ctrl-C.
inline constexpr std::chrono::milliseconds kLook(50);

/// Runs Python's signal handlers, which only the main thread has. Throws what they throw, and
/// Interrupted if the interpreter is about to end. The caller lacks the lock.
void obey_signals();

/// The mutex of an object that one thread uses at a time. No thread waits for it with the
/// interpreter's lock, so its owner can always get that lock. Waiting obeys signals.
class Turn {
 public:
  /// The caller has the interpreter's lock. Throws std::invalid_argument if this thread has the
  /// mutex already: then a signal handler uses the object in whose work it was called.
  void lock();
  void unlock();

 private:
  std::timed_mutex mutex_;
  std::atomic<std::thread::id> owner_;
};

/// Calls `work` without the interpreter's lock, in a thread of its own, and obeys signals
/// meanwhile. After Ctrl-C the thread finishes alone: `work` owns all that it uses.
template <typename Work>
auto apart(Work work) {
  std::packaged_task<decltype(work())()> task(std::move(work));
  auto result = task.get_future();
  const Unlocked unlocked;
  std::thread(std::move(task)).detach();
  while (result.wait_for(kLook) != std::future_status::ready) obey_signals();
  return result.get();
}

/// Calls a Python object like PyObject_Vectorcall(). The caller has the lock.
PyObject* call_python(PyObject* callable, PyObject* const* arguments, std::size_t flags);

/// Makes Python's exit wait.
void bind_exit();

}  // namespace breakwater::python
