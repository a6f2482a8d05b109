#include "support.h"

namespace breakwater::testing {

std::string source_file(const std::string& relative) {
  return std::string(BREAKWATER_SOURCE_DIR) + "/" + relative;
}

std::filesystem::path bin_folder() {
  return BREAKWATER_BIN_DIR;
}

}  // namespace breakwater::testing
