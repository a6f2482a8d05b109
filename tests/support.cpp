#include "support.h"

#include <fstream>
#include <sstream>

namespace breakwater::testing {

std::string source_file(const std::string& relative) {
  return std::string(BREAKWATER_SOURCE_DIR) + "/" + relative;
}

std::string text_of(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::filesystem::path bin_folder() {
  return BREAKWATER_BIN_DIR;
}

}  // namespace breakwater::testing
