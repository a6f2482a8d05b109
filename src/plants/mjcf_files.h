// Which files the engine reads for a model.
#pragma once

#include <filesystem>
#include <vector>

namespace breakwater {

/// An MJCF file, what it includes, and the meshes, height fields, skins and textures of all of
/// them, as far as they are there; each once, the file itself first. A file that is no XML has
/// nothing but itself: Model::load says what is wrong with it. Throws as check_ends() of each.
std::vector<std::filesystem::path> mjcf_files(const std::filesystem::path& mjcf);

}  // namespace breakwater
