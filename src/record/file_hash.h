// A file's bytes as one number.
#pragma once

#include <filesystem>
#include <string>

namespace breakwater {

/// 16 hexadecimal digits: XXH3 (64 bits) of the file's bytes. Throws
/// std::invalid_argument `FILE: cannot be read`.
std::string file_hash(const std::filesystem::path& file);

}  // namespace breakwater
