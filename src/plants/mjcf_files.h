// MJCF files before the engine reads them: which ones there are, and their numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace breakwater {

/// An MJCF file, its includes, the models that it attaches, and the meshes, height fields, skins
/// and textures of all of them. Each existing file occurs once, the main file first. A file that is
/// not XML gives only itself, and Model::load() reports its error. Throws as check_ends() does for
/// each file.
std::vector<std::filesystem::path> mjcf_files(const std::filesystem::path& mjcf);

/// Throws std::invalid_argument `FILE[:LINE]: reason` if an MJCF file or one of its includes cannot
/// be read, is not XML or has a wrong number. More than `most_elements` elements are refused too,
/// with those of a <composite>. A number must be finite and within ±1e30. Masses, colours and sizes
/// in pixels must not be negative, and a size of <size> must fit into memory. The engine accepts
/// NaN, 1e300 and a negative mass without a warning.
void check_mjcf(const std::string& file, std::uint64_t most_elements);

}  // namespace breakwater
