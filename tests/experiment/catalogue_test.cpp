#include <breakwater/experiment/catalogue.h>

#include <gtest/gtest.h>

#include <fstream>

#include "support.h"

namespace breakwater {
namespace {

TEST(ScenarioKindTest, ReadsItsFileOnceAndAgainWhenItsTextChanges) {
  const testing::TemporaryPath folder{"door"};
  std::filesystem::create_directory(folder);
  const ScenarioKind kind{"door", nullptr, folder};
  const auto write = [&](const std::string& last) {
    std::ofstream(kind.file()) << "scenario = \"door\"\nk = 1\n[case." << last << "]\n";
  };
  write("open");
  const auto first = kind.scenario_file();
  EXPECT_EQ(first->cases(), std::vector<std::string>{"open"});
  EXPECT_EQ(kind.scenario_file(), first);
  write("shut");  // as long, and within the resolution of the file's time
  EXPECT_EQ(kind.scenario_file()->cases(), std::vector<std::string>{"shut"});
  EXPECT_EQ(first->cases(), std::vector<std::string>{"open"});
  EXPECT_NE(kind.scenario_file(kind.file()), kind.scenario_file());
  std::filesystem::remove(kind.file());
  EXPECT_EQ(complaint_of([&] { kind.scenario_file(); }),
            kind.file().string() + ": cannot be read (No such file or directory)");
}

}  // namespace
}  // namespace breakwater
