// The place of a library that is not linked but loaded.
#pragma once

#include <filesystem>
#include <string>

namespace breakwater {

/// The shared library F/lib/breakwater/`name` of Breakwater itself. F is a folder above the
/// program, or else the prefix of its installation. Returns a path of the latter if it is in none.
std::filesystem::path own_library(const std::string& name);

}  // namespace breakwater
