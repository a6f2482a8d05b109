// Where the project's own files are.
#pragma once

#include <filesystem>
#include <string>

namespace breakwater {

/// The folder that holds models/, scenarios/ and data/: the first such of the environment variable
/// BREAKWATER_PATH (folders, with ':' between them); else found from the running binary's place:
/// its source tree, or PREFIX/share/breakwater of an installation. Throws std::invalid_argument,
/// naming where it was looked for, if there is none.
std::filesystem::path data_root();

/// A file that a key names: as given if absolute; else in `folder` if it is there; else in
/// data_root().
std::filesystem::path find_file(const std::string& name, const std::filesystem::path& folder);

/// How to write a path into a config: relative to data_root() if inside it, else absolute.
std::string portable_path(const std::filesystem::path& file);

}  // namespace breakwater
