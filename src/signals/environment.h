// The variables of the process' environment.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace breakwater {

/// A variable's value; an empty one counts as none.
inline std::optional<std::string> environment(const char* name) {
  const char* const value = std::getenv(name);
  if (value == nullptr || *value == '\0') return std::nullopt;
  return value;
}

}  // namespace breakwater
