// Gives MuJoCo the elementary functions of math/.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// Redirects the calls of one shared library to the functions of math/functions.h, which have the
/// same bits on every processor. The calls of all other libraries stay. `inside` is an address in
/// the library. Returns the names of the redirected functions, sorted. Throws std::runtime_error
/// `LIBRARY: reason` if the library calls none of them through the loader, or the system does not
/// allow the change.
std::vector<std::string> redirect_elementary_functions(const void* inside);

/// The functions of MuJoCo that are redirected. The first call redirects them; call_engine() makes
/// it. Throws as redirect_elementary_functions() does. Thread-safe.
const std::vector<std::string>& engine_functions();

}  // namespace breakwater
