// What the built binaries ask of the dynamic loader.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

std::string dynamic_section(const fs::path& binary) {
  const std::string command = "readelf --dynamic --wide '" + binary.string() + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> buffer{};
  while (fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) text += buffer.data();
  return text;
}

// An empty entry of such a path is the user's working folder: whoever can write there runs code.
TEST(Binaries, LookForLibrariesInNoFolderOfTheirOwn) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(testing::bin_folder())) {
    const std::string section = dynamic_section(entry.path());
    ASSERT_NE(section.find("(NEEDED)"), std::string::npos) << entry.path();
    EXPECT_EQ(section.find("RUNPATH"), std::string::npos) << entry.path();
    EXPECT_EQ(section.find("RPATH"), std::string::npos) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 9);
}

}  // namespace
}  // namespace breakwater
