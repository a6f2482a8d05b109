// The bytes of a file.
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace breakwater {

/// Throws std::invalid_argument `FILE: cannot be read (REASON)`.
inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream bytes;
  if (stream) bytes << stream.rdbuf();
  if (!stream || bytes.bad()) {
    throw std::invalid_argument(file.string() + ": cannot be read (" +
                                std::generic_category().message(errno) + ")");
  }
  return bytes.str();
}

}  // namespace breakwater
