// The origin of a run besides its configuration: the models' files and the program.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace breakwater {

/// These model files, and all files that an MJCF file among them includes.
std::vector<std::filesystem::path> model_paths(const std::vector<std::string>& files);

/// Hashes (file_hash) of files by their portable_path, "models/arm.xml". Throws
/// std::invalid_argument `FILE: cannot be read`.
using ModelHashes = std::map<std::string, std::string>;
ModelHashes model_hashes(const std::vector<std::string>& files);

/// The key of a study's point, also in a run's manifest: 16 hexadecimal digits that depend on the
/// effective configuration and the models.
std::string point_key(const std::string& config_text, const ModelHashes& models);

/// The hash of the linker's build id (without one, of program_file()). It tells builds apart.
const std::string& program_hash();

}  // namespace breakwater
