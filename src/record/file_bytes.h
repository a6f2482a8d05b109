// The bytes of a file.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace breakwater {

/// Throws std::runtime_error if it cannot be read.
inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream bytes;
  bytes << stream.rdbuf();
  if (!stream || bytes.bad()) throw std::runtime_error(file.string() + ": cannot be read");
  return bytes.str();
}

}  // namespace breakwater
