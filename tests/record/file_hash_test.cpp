#include <breakwater/record/file_hash.h>

#include "support.h"

namespace breakwater {
namespace {

// XXH3_64bits of no bytes, and of "abc".
TEST(FileHash, DependsOnTheBytesOfTheFile) {
  const testing::TemporaryPath file{"hashed"};
  std::ofstream(file).close();
  EXPECT_EQ(file_hash(file), "2d06800538d394c2");
  std::ofstream(file) << "abc";
  EXPECT_EQ(file_hash(file), "78af5f94892f3950");
}

TEST(FileHash, ChangesWithOneByteOfALargeFile) {
  const testing::TemporaryPath file{"hashed"};
  std::string bytes(3'500'000, 'x');
  std::ofstream(file) << bytes;
  const std::string before = file_hash(file);
  EXPECT_EQ(file_hash(file), before);
  bytes[3'200'000] = 'y';
  std::ofstream(file) << bytes;
  EXPECT_NE(file_hash(file), before);
}

TEST(Fingerprint, SeparatesItsParts) {
  EXPECT_NE(fingerprint({"a", "b"}), fingerprint({"ab", ""}));
  EXPECT_NE(fingerprint({"a", "b"}), fingerprint({"a", "c"}));
  EXPECT_EQ(fingerprint({"a", "b"}), fingerprint({"a", "b"}));
}

TEST(FileHash, NamesAnUnreadableFile) {
  for (const auto& [file, reason] :
       {std::pair("/no/such/file", "No such file or directory"),
        std::pair("/tmp", "it is a folder"), std::pair("/dev/zero", "it is not a regular file")}) {
    EXPECT_EQ(complaint_of([&] { file_hash(file); }),
              std::string(file) + ": cannot be read (" + reason + ")");
  }
}

}  // namespace
}  // namespace breakwater
