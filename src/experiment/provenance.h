// The origin of a run besides its configuration: the models' files and the program.
#pragma once

#include <map>
#include <string>

namespace breakwater {

/// Hashes (file_hash) of files by their portable_path, "models/arm.xml".
using ModelHashes = std::map<std::string, std::string>;

/// The key of a study's point, also in a run's manifest: 16 hexadecimal digits that depend on the
/// effective configuration and the models.
std::string point_key(const std::string& config_text, const ModelHashes& models);

/// The hash of the linker's build id (without one, of program_file()). It tells builds apart.
const std::string& program_hash();

}  // namespace breakwater
