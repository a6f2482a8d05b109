// A further command of a program.
#pragma once

#include <string>

namespace breakwater {

class Catalogue;

/// `PROGRAM NAME [OPTION...]`.
struct CommandKind {
  static constexpr const char* kWhat = "command";

  std::string name;
  std::string summary;  ///< one line, for PROGRAM --help
  /// Returns the exit status. argv[0] is the command's name.
  int (*run)(const Catalogue&, int argc, const char* const* argv);
  const char* group = "Your own work";  ///< in which PROGRAM --help has it
};

}  // namespace breakwater
