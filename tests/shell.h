// Output of other programs.
#pragma once

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace breakwater::testing {

/// The output of a shell command. Throws std::runtime_error if it fails (append "; true" to allow
/// this).
inline std::string output_of(const std::string& command) {
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error(command + ": cannot be run");
  std::string text;
  std::array<char, 4096> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe)) {
    text.append(part.data(), size);
  }
  if (pclose(pipe) != 0) throw std::runtime_error(command + ": failed: " + text);
  return text;
}

}  // namespace breakwater::testing
