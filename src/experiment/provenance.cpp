#include <breakwater/experiment/provenance.h>

#include <breakwater/plants/mjcf_files.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/shell/paths.h>

namespace breakwater {

std::vector<std::filesystem::path> model_paths(const std::vector<std::string>& files) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& file : files) {
    for (auto& path : mjcf_files(file)) paths.push_back(std::move(path));
  }
  return paths;
}

ModelHashes model_hashes(const std::vector<std::string>& files) {
  ModelHashes hashes;
  for (const auto& path : model_paths(files)) hashes[portable_path(path)] = file_hash(path);
  return hashes;
}

std::string point_key(const std::string& config_text, const ModelHashes& models) {
  std::vector<std::string> parts = {config_text};
  for (const auto& [file, hash] : models) parts.insert(parts.end(), {file, hash});
  return fingerprint(parts);
}

const std::string& program_hash() {
  static const std::string hash = file_hash(program_file());
  return hash;
}

}  // namespace breakwater
