// The files that the engine reads for a model.
#pragma once

#include <filesystem>
#include <vector>

namespace breakwater {

/// An MJCF file, its includes, and the meshes, height fields, skins and textures of all of them.
/// Each existing file occurs once, the main file first. A file that is not XML gives only itself,
/// and Model::load() reports its error. Throws as check_ends() does for each file.
std::vector<std::filesystem::path> mjcf_files(const std::filesystem::path& mjcf);

}  // namespace breakwater
