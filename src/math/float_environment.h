// The floating-point environment of a run.
#pragma once

#include <cfenv>

namespace breakwater::math {

/// As at the start of a program, this thread rounds to nearest and keeps subnormal numbers. Long
/// doubles have 64 bits, and no signal is raised. The destructor brings the caller's environment
/// back. Without it, a caller's rounding mode or FTZ bit would change the bits of a run. Threads
/// inherit the environment of the thread that starts them.
class FloatEnvironment {
 public:
  FloatEnvironment() {
    std::fegetenv(&callers_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatEnvironment() { std::fesetenv(&callers_); }
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
  std::fenv_t callers_ = {};
};

}  // namespace breakwater::math
