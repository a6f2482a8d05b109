#include "module.h"

#include <pybind11/stl.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <breakwater/config/config.h>
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
  return command(parts_of_program->catalogue(), static_cast<int>(argv.size()), argv.data());
}

// See start_copy. Called by any thread, without the lock.
pid_t copy(const std::vector<std::string>& words, int output) {
  const Locked lock;
  PyOS_BeforeFork();
  const pid_t process = fork();
  if (process != 0) {
    PyOS_AfterFork_Parent();
    return process;
  }
  PyOS_AfterFork_Child();
  dup2(output, STDERR_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, 0);  // the outputs of other copies
  const int status = call({words.begin() + 1, words.end()});
  py::module_::import("sys").attr("stdout").attr("flush")();
  std::fflush(nullptr);
  _exit(status);
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
  module.def("choices", [](const std::string& target, const py::tuple& parts) {
    return PythonParts(parts).choices(
        is_scenario_file(target) ? scenario_name_in(shipped_parts(), target) : target);
  });
}

}  // namespace breakwater::python
