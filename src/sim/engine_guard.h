// Keeps MuJoCo's errors and warnings from stopping the process or printing.
#pragma once

#include <stdexcept>
#include <string>

namespace breakwater {

/// A failed run: it diverged, is not finite, or the engine reported an error.
class RunFailure : public std::runtime_error {
 public:
  RunFailure(double time_s, const std::string& reason)
      : std::runtime_error(reason), time_s_(time_s) {}

  double time_s() const { return time_s_; }

 private:
  double time_s_;
};

/// The machine has too little memory for the engine; the input may be right. `FILE: reason`.
class OutOfMemory : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Calls `body(argument)`, which calls the engine. Returns the text of a fatal error or of a lack
/// of memory; empty: no error. By default the engine would wait for a key and exit. The first call
/// gives the engine the functions of math/, and throws as engine_functions() does.
///
/// A fatal error leaves `body` by longjmp. When it calls the engine, `body` must therefore own no
/// object with a needed destructor, and neither must the functions that it calls.
std::string call_engine(void (*body)(void*), void* argument);

/// The same for a lambda.
template <typename Body>
std::string call_engine(Body body) {
  return call_engine([](void* argument) { (*static_cast<Body*>(argument))(); }, &body);
}

/// The version of the engine, such as "2.2.2".
std::string engine_version();

/// The engine's last warning on this thread since the last call; empty if there is none.
std::string take_engine_warning();

}  // namespace breakwater
