// Hashes of files and texts.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace breakwater {

/// 16 hexadecimal digits: XXH3 (64 bits) of the file's bytes. Throws std::invalid_argument
/// `FILE: cannot be read`.
std::string file_hash(const std::filesystem::path& file);

/// The same for a text.
std::string text_hash(std::string_view text);

/// 16 hexadecimal digits that change with any of `parts`.
std::string fingerprint(const std::vector<std::string>& parts);

}  // namespace breakwater
