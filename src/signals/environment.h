// Environment variables of the process.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace breakwater {

/// A variable's value; none if it is unset or empty.
inline std::optional<std::string> environment(const char* name) {
  const char* const value = std::getenv(name);
  if (value == nullptr || *value == '\0') return std::nullopt;
  return value;
}

}  // namespace breakwater
