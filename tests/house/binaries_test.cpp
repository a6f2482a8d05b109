// Dynamic-loader entries of the built binaries.

#include "shell.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

// An empty entry in such a path is the working folder: whoever can write there could run code.
TEST(Binaries, HaveNoRunPath) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(testing::bin_folder())) {
    const std::string section =
        testing::output_of("readelf --dynamic --wide '" + entry.path().string() + "'");
    ASSERT_TRUE(has(section, "(NEEDED)")) << entry.path();
    EXPECT_TRUE(lacks(section, "RUNPATH")) << entry.path();
    EXPECT_TRUE(lacks(section, "RPATH")) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 9);
}

// They would be loaded at every start, before a program prints anything.
TEST(Binaries, LinkNoLibraryThatFewCommandsUse) {
  for (const auto& entry : fs::directory_iterator(testing::bin_folder())) {
    const std::string section =
        testing::output_of("readelf --dynamic --wide '" + entry.path().string() + "'");
    for (const char* library : {"libav", "libcairo", "libhdf5", "libnlopt", "libpagmo", "libtbb"}) {
      EXPECT_TRUE(lacks(section, library)) << entry.path();
    }
  }
}

}  // namespace
}  // namespace breakwater
