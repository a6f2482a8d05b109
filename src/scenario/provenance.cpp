#include <breakwater/scenario/provenance.h>

#include <breakwater/plants/mjcf_files.h>
#include <breakwater/record/file_hash.h>
#include <breakwater/scenario/paths.h>

namespace breakwater {

ModelHashes model_hashes(const std::vector<std::string>& files) {
  ModelHashes hashes;
  for (const std::string& file : files) {
    for (const auto& one : mjcf_files(file)) hashes[portable_path(one)] = file_hash(one);
  }
  return hashes;
}

const std::string& program_hash() {
  static const std::string hash = file_hash("/proc/self/exe");
  return hash;
}

}  // namespace breakwater
