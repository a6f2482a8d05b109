#include "scenario/provenance.h"

#include "plants/mjcf_files.h"
#include "record/file_hash.h"
#include "scenario/paths.h"

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
