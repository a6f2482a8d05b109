// What a run is made of besides its configuration: the models' files and the program.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace breakwater {

/// The model files that are given, and all that an MJCF file among them has read in.
std::vector<std::filesystem::path> model_paths(const std::vector<std::string>& files);

/// Hashes (file_hash) of these by their portable_path, "models/arm.xml". Throws
/// std::invalid_argument `FILE: cannot be read`.
using ModelHashes = std::map<std::string, std::string>;
ModelHashes model_hashes(const std::vector<std::string>& files);

/// What a point of a study is known by, and a run's manifest tells: 16 hexadecimal digits of the
/// effective configuration and the models.
std::string point_key(const std::string& config_text, const ModelHashes& models);

/// The hash of program_file(), read once. A version's name does not tell two builds of
/// changed sources apart.
const std::string& program_hash();

}  // namespace breakwater
