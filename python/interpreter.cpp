#include "interpreter.h"

#include <cxxabi.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include <breakwater/record/interrupted.h>

namespace breakwater::python {
namespace {

// A run stops within moments, at its next report or at the next sample of a Python part. Only a
// user's method may take longer.
constexpr std::chrono::seconds kLongestWait(5);
constexpr std::chrono::milliseconds kPoll(2);

std::atomic<bool> ending = false;
std::atomic<int> calls = 0;

// Calls a body that Python may unwind. The thread then waits for the end of the process.
template <typename Body>
auto never_unwound(Body&& body) {
  try {
    return body();
  } catch (abi::__forced_unwind&) {
    for (;;) pause();
  }
}

void end_threads() {
  ending = true;
  const auto begin = std::chrono::steady_clock::now();
  const py::gil_scoped_release others;
  while (calls > 0 && std::chrono::steady_clock::now() - begin < kLongestWait) {
    std::this_thread::sleep_for(kPoll);
  }
}

}  // namespace

const std::atomic<bool>& is_ending() {
  return ending;
}

void check_not_ending() {
  if (!ending) return;
  PyErr_SetString(PyExc_SystemExit, "Python ends");
  throw py::error_already_set();
}

Locked::Locked() : state_(never_unwound(PyGILState_Ensure)) {}

Call::Call() {
  check_not_ending();
  ++calls;
}

Call::~Call() {
  --calls;
}

Unlocked::Unlocked() : state_(nullptr) {
  check_not_ending();
  state_ = PyEval_SaveThread();
}

Unlocked::~Unlocked() {
  never_unwound([this] { PyEval_RestoreThread(state_); });
}

void obey_signals() {
  if (ending) throw Interrupted();
  const Locked lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

PyObject* call_python(PyObject* callable, PyObject* const* arguments, std::size_t flags) {
  check_not_ending();
  return never_unwound([&] { return PyObject_Vectorcall(callable, arguments, flags, nullptr); });
}

void bind_exit() {
  py::module_::import("atexit").attr("register")(py::cpp_function(end_threads));
  // A child process lacks the other threads of its parent.
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") =
                                                         py::cpp_function([] { calls = 0; }));
}

}  // namespace breakwater::python
