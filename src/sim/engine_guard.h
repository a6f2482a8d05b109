// Keeps MuJoCo's errors and warnings from ending, halting or littering the process.
#pragma once

#include <stdexcept>
#include <string>

namespace breakwater {

/// A run that cannot go on: diverged, not finite, or refused by the engine.
class RunFailure : public std::runtime_error {
 public:
  RunFailure(double time_s, const std::string& reason)
      : std::runtime_error(reason), time_s_(time_s) {}

  double time_s() const { return time_s_; }

 private:
  double time_s_;
};

/// The machine has no memory for what the engine needs; the input may be right. `FILE: reason`.
class OutOfMemory : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Calls `body(argument)`, which calls the engine. If the engine reports a fatal error meanwhile,
/// returns its text (by default it would wait for a key and exit), or finds no memory, says so;
/// otherwise returns an empty string.
///
/// A fatal error leaves `body` by longjmp, so neither it nor what it calls may hold anything whose
/// destructor matters when it calls the engine.
std::string call_engine(void (*body)(void*), void* argument);

/// The same of a lambda.
template <typename Body>
std::string call_engine(Body body) {
  return call_engine([](void* argument) { (*static_cast<Body*>(argument))(); }, &body);
}

/// "2.2.2".
std::string engine_version();

/// The engine's last warning on this thread since the last call; empty if there was none.
std::string take_engine_warning();

}  // namespace breakwater
