// What the built binaries ask of the dynamic loader.

#include "shell.h"
#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

// An empty entry of such a path is the user's working folder: whoever can write there runs code.
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

}  // namespace
}  // namespace breakwater
