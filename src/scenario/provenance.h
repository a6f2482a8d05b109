// What a run is made of besides its configuration: the models' files and the program.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace breakwater {

/// Hashes (file_hash) of model files by their portable_path, "models/arm.xml": those that are
/// given, and all that an MJCF file among them has read in. Throws std::invalid_argument
/// `FILE: cannot be read`.
using ModelHashes = std::map<std::string, std::string>;
ModelHashes model_hashes(const std::vector<std::string>& files);

/// The hash of the running program's file, read once. A version's name does not tell two builds of
/// changed sources apart.
const std::string& program_hash();

}  // namespace breakwater
