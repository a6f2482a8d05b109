#include "interpreter.h"

#include <chrono>
#include <thread>

#include <breakwater/record/interrupted.h>

namespace breakwater::python {
namespace {

// A run stops within moments, at its next report or at the next sample of a Python part. Only a
// user's method may take longer.
constexpr std::chrono::seconds kLongestWait(5);
constexpr std::chrono::milliseconds kPoll(2);

std::atomic<int> calls = 0;

void end_threads() {
  is_ending = true;
  const auto begin = std::chrono::steady_clock::now();
  const Unlocked others;
  while (calls > 0 && std::chrono::steady_clock::now() - begin < kLongestWait) {
    std::this_thread::sleep_for(kPoll);
  }
}

}  // namespace

void check_not_ending() {
  if (!is_ending) return;
  PyErr_SetString(PyExc_SystemExit, "Python ends");
  throw py::error_already_set();
}

Call::Call() {
  check_not_ending();
  ++calls;
}

Call::~Call() {
  --calls;
}

void obey_signals() {
  if (is_ending) throw Interrupted();
  const Locked lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void bind_exit() {
  py::module_::import("atexit").attr("register")(py::cpp_function(end_threads));
  // A child process lacks the other threads of its parent.
  py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") =
                                                         py::cpp_function([] { calls = 0; }));
}

}  // namespace breakwater::python
