#include <breakwater/record/loaded_library.h>

#include <cstdlib>
#include <stdexcept>

#include "support.h"

namespace breakwater {
namespace {

const LoadedLibrary& libc() {
  static const LoadedLibrary library("libc.so.6", "libc6");
  return library;
}

BREAKWATER_LOADED(libc, std::invalid_argument, labs)

TEST(LoadedLibrary, GivesItsFunctions) {
  ASSERT_TRUE(libc().is_there());
  EXPECT_EQ(labs(-5L), 5L);
  const auto find = [] { libc().symbol<std::invalid_argument, void()>("glue"); };
  EXPECT_EQ(complaint_of(find), "libc.so.6 has no glue");
}

TEST(LoadedLibrary, NamesThePackageThatIsMissing) {
  const LoadedLibrary none("libnone.so.1", "libnone1");
  EXPECT_FALSE(none.is_there());
  const auto find = [&] { none.symbol<std::invalid_argument, void()>("glue"); };
  EXPECT_EQ(complaint_of(find),
            "libnone.so.1: cannot open shared object file: No such file or directory (Debian "
            "package libnone1)");
}

}  // namespace
}  // namespace breakwater
