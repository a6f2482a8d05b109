#include "module.h"

#include <pybind11/stl.h>
#include <sys/types.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <vector>

#include <breakwater/program/commands.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/study/study_folder.h>
#include "interpreter.h"
#include "parts.h"

namespace breakwater::python {
namespace {

// Calls `sweep` or `tune`. The caller has the interpreter's lock.
int call(const std::vector<std::string>& words) {
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  const Unlocked unlocked;
  const auto command = words.front() == kTune.command ? tune_main : sweep_main;
  const int status =
      command(parts_of_program->catalogue(), static_cast<int>(argv.size()), argv.data());
  std::fflush(nullptr);
  return status;
}

// See start_copy. Called by any thread, without the lock.
pid_t copy(const std::vector<std::string>& words, int output) {
  const Locked lock;
  const auto start = py::module_::import("breakwater.commands").attr("start_copy");
  const auto process = start(words, output).cast<pid_t>();
  if (process < 0) errno = -process;
  return process;
}

}  // namespace

void bind_program(py::module_& module) {
  module.def(
      "program",
      [](const std::vector<std::string>& words, const std::string& hash, const py::tuple& given) {
        const PythonParts parts(given);
        parts_of_program = &parts;
        own_parts = hash;
        start_copy = copy;
        return call(words);
      },
      OwnCall());
  module.def("call", call);
  module.def("choices", [](const std::string& target, const py::tuple& parts) {
    return PythonParts(parts).choices(scenario_of(target));
  });
}

}  // namespace breakwater::python
