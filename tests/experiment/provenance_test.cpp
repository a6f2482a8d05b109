#include <breakwater/experiment/provenance.h>

#include <breakwater/record/file_hash.h>

#include "shell.h"
#include "support.h"

namespace breakwater {
namespace {

TEST(ProgramHash, IsThatOfTheBuildId) {
  const std::string file = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string digits = testing::output_of("readelf --notes '" + file +
                                                "' | sed -n 's/ *Build ID: //p' | tr -d '\\n'");
  ASSERT_EQ(digits.size(), 40U);
  std::string id;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    id += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  EXPECT_EQ(program_hash(), text_hash(id));
}

}  // namespace
}  // namespace breakwater
