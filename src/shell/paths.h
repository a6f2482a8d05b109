// Where files are found: scenarios' own, the project's, an installation's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// What a program knows of where its files are.
struct DataPlaces {
  /// Folders of its own scenarios.
  std::vector<std::filesystem::path> scenarios = {};
  /// PREFIX/share/breakwater of the installation that it was built against; empty: none.
  std::filesystem::path installation = {};
  /// The file that holds its code; empty: that of the running process. A module of an interpreter
  /// names itself.
  std::filesystem::path program = {};
};

/// Said once, at the beginning of main() and before any file is looked for: program() does.
void set_data_places(const DataPlaces& places);

/// The file that holds the running code, to be read.
std::filesystem::path program_file();

/// Where a file may be, in the order in which it is looked for.
struct SearchPath {
  std::vector<std::filesystem::path> candidates;  ///< all of them, for messages
  std::vector<std::filesystem::path> folders;     ///< those that are there
  std::vector<std::string> warnings;              ///< one line each
};

/// The folders of the program's own scenarios; those of `variable`, with ':' between them, of which
/// one that is no folder is warned of; then, from the program's place upwards, each
/// F/share/breakwater, and each F that holds models/ and scenarios/, as the source tree does; at
/// last the installation that the program was built against.
SearchPath search_path(const std::string& variable, const std::filesystem::path& program,
                       const DataPlaces& places);

/// `name` ("models/arm.xml") in the first folder that has it, of the search path of the environment
/// variable BREAKWATER_PATH and the running program; nothing if none has. At its first use warnings
/// go to stderr.
std::optional<std::filesystem::path> look_for(const std::string& name);

/// The same. Throws std::invalid_argument, naming all places where it was looked for, if none has.
std::filesystem::path data_file(const std::string& name);

/// "A, B, C": the places, for messages.
std::string searched_places();

/// A file that a key names: as given if absolute; else in `folder` if it is there; else where
/// look_for() finds it, if it does.
std::optional<std::filesystem::path> find_file(const std::string& name,
                                               const std::filesystem::path& folder);

/// How to write a path into a config: a name by which look_for() finds it, if there is one; else
/// absolute.
std::string portable_path(const std::filesystem::path& file);

}  // namespace breakwater
