// The places of files: of scenarios, of the project and of an installation.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// The folders that a program searches for its files.
struct DataPlaces {
  /// The folders of its own scenarios.
  std::vector<std::filesystem::path> scenarios = {};
  /// PREFIX/share/breakwater of the installation that it was built with; empty: none.
  std::filesystem::path installation = {};
  /// The file with its code; empty: the file of the running process. A Python module sets its own.
  std::filesystem::path program = {};
};

/// Sets the places. program() calls it at the beginning of main(), before any file is searched.
void set_data_places(const DataPlaces& places);

/// The file with the running code, for reading.
std::filesystem::path program_file();

/// The places of a file in their search order.
struct SearchPath {
  std::vector<std::filesystem::path> candidates;  ///< all places, for messages
  std::vector<std::filesystem::path> folders;     ///< the existing ones
  std::vector<std::string> warnings;              ///< one line each
};

/// The search path begins with the program's own scenarios and the folders in `variable`, separated
/// by ':'. A missing one gives a warning. From the program's place upwards, each F/share/breakwater
/// and each F with models/ and scenarios/ follow. The last one is the program's installation.
SearchPath search_path(const std::string& variable, const std::filesystem::path& program,
                       const DataPlaces& places);

/// Finds `name` ("models/arm.xml") in the search path of the running program and the environment
/// variable BREAKWATER_PATH. Returns nothing if there is none. The first call prints warnings.
std::optional<std::filesystem::path> look_for(const std::string& name);

/// The same, but throws std::invalid_argument with all searched places if there is none.
std::filesystem::path data_file(const std::string& name);

/// The shared library F/lib/breakwater/`name` of Breakwater itself, which is not linked but loaded.
/// F is a folder above the program, or else the prefix of its installation. Returns a path of the
/// latter if it is in none.
std::filesystem::path own_library(const std::string& name);

/// "A, B, C": the places, for messages: those that exist, or all if none does.
std::string searched_places();

/// Finds a file that a key names: by an absolute path, in `folder`, or with look_for().
std::optional<std::filesystem::path> find_file(const std::string& name,
                                               const std::filesystem::path& folder);

/// The path for a config: a name that look_for() finds, or otherwise the absolute path.
std::string portable_path(const std::filesystem::path& file);

}  // namespace breakwater
