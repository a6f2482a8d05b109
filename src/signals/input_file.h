// A file that a user names, to be read; all its bytes.
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace breakwater {

/// Why it cannot be read: "No such file or directory", "it is a folder", …; empty if it can. A pipe
/// or a device cannot: it may never end.
inline std::string why_unreadable(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (error) return error.message();
  if (std::filesystem::is_directory(status)) return "it is a folder";
  if (!std::filesystem::is_regular_file(status)) return "it is not a regular file";
  return std::ifstream(file) ? "" : std::generic_category().message(errno);
}

/// Throws std::invalid_argument `FILE: cannot be read (REASON)`.
inline std::ifstream open_input(const std::filesystem::path& file) {
  std::string reason = why_unreadable(file);
  if (reason.empty()) {
    std::ifstream stream(file, std::ios::binary);
    if (stream.is_open()) return stream;
    reason = std::generic_category().message(errno);
  }
  throw std::invalid_argument(file.string() + ": cannot be read (" + reason + ")");
}

/// Throws std::invalid_argument `FILE: cannot be read (REASON)`.
inline std::string bytes_of(const std::filesystem::path& file) {
  std::stringstream bytes;
  bytes << open_input(file).rdbuf();
  return bytes.str();
}

}  // namespace breakwater
