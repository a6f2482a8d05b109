// Keeps MuJoCo's errors and warnings from stopping the process or printing, and gives it the
// elementary functions of math/. OpenGlAsked: the device of EGL that the user selects by the
// environment variables of MuJoCo's programs.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

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

/// Throws OutOfMemory or std::invalid_argument `FILE: TEXT` for a text that call_engine() returned;
/// empty: no error.
void check_engine(const std::string& file, const std::string& fatal);

/// Returns what a function of the engine makes. Throws as check_engine(), also if it is nothing.
template <typename Make>
auto made_by_engine(const std::string& file, Make make) {
  decltype(make()) made = nullptr;
  check_engine(file, call_engine([&] { made = make(); }));
  if (made != nullptr) return made;
  throw std::invalid_argument(file + ": the engine has no memory for a simulation");
}

/// The version of the engine, such as "2.2.2".
std::string engine_version();

/// The engine's last warning on this thread since the last call; empty if there is none.
std::string take_engine_warning();

/// Redirects the calls of one shared library to the functions of math/functions.h, which have the
/// same bits on every processor. The calls of all other libraries stay. `inside` is an address in
/// the library. Returns the names of the redirected functions, sorted. Throws std::runtime_error
/// `LIBRARY: reason` if the library calls none of them through the loader, or the system does not
/// allow the change.
std::vector<std::string> redirect_elementary_functions(const void* inside);

/// The functions of MuJoCo that are redirected. The first call redirects them; call_engine() makes
/// it. Throws as redirect_elementary_functions() does. Thread-safe.
const std::vector<std::string>& engine_functions();

struct OpenGlAsked {
  std::optional<int> device;  ///< number in EGL's list
  bool software_only = true;  ///< false: the first device that works, a GPU if there is one
};

/// Reads MUJOCO_GL, in upper or lower case: `egl` is any device; `osmesa`, unset or empty is Mesa's
/// software renderer. Reads MUJOCO_EGL_DEVICE_ID, a whole number without effect with `osmesa`.
/// Throws std::invalid_argument, one line, for other values.
OpenGlAsked opengl_asked();

}  // namespace breakwater
