// Second implementations in Python (Debian's, with NumPy, SciPy and CVXOPT).
#pragma once

#include <sys/wait.h>

#include <cstdio>

#include "support.h"

namespace breakwater::testing {

/// Runs tests/`script` with `input` as its standard input, and returns the numbers that it prints.
inline std::vector<double> run_python(const std::string& script, const std::string& input) {
  const TemporaryPath path("python_input", input);
  const std::string command =
      "/usr/bin/python3 " + source_file("tests/" + script) + " < " + path.string();
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run python3");
  std::vector<double> numbers;
  for (double number = 0.0; std::fscanf(pipe, "%lf", &number) == 1;) numbers.push_back(number);
  if (const int status = pclose(pipe); status != 0) {
    throw std::runtime_error(script + " ended with status " + std::to_string(WEXITSTATUS(status)));
  }
  return numbers;
}

}  // namespace breakwater::testing
