// The code in the documentation is built code.

#include <regex>

#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

// A fenced block behind <!-- FILE --> is an exact part of this file. The file is a test or a
// template, which the install tests build and run.
TEST(Docs, CodeEqualsTheTemplates) {
  int blocks = 0;
  const std::regex pattern("<!-- ((?:templates|tests)/\\S+) -->\n```[a-z]*\n([^`]*)```");
  for (const auto& entry : fs::recursive_directory_iterator(testing::source_file("docs"))) {
    if (entry.path().extension() != ".md") continue;
    const std::string page = testing::text_of(entry.path());
    for (std::sregex_iterator block(page.begin(), page.end(), pattern), end; block != end;
         ++block) {
      ++blocks;
      const std::string code = testing::text_of(testing::source_file((*block)[1]));
      EXPECT_TRUE(has(code, (*block)[2])) << entry.path() << ": not in " << (*block)[1] << ":\n"
                                          << (*block)[2];
    }
    const std::regex mark("<!-- (templates|tests)/");
    EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), mark), {}),
              std::distance(std::sregex_iterator(page.begin(), page.end(), pattern), {}))
        << entry.path() << ": a mark without a block behind it";
  }
  EXPECT_GT(blocks, 15);
}

// Users of the libraries need no files of src/: the included headers are installed.
TEST(Docs, NamedHeadersExist) {
  const std::regex pattern("<breakwater/([a-z_]+/[a-z_]+\\.h)>");
  for (const auto& entry : fs::recursive_directory_iterator(testing::source_file("docs"))) {
    if (entry.path().extension() != ".md") continue;
    const std::string page = testing::text_of(entry.path());
    for (std::sregex_iterator name(page.begin(), page.end(), pattern), end; name != end; ++name) {
      EXPECT_TRUE(fs::exists(testing::source_file("src/" + (*name)[1].str())))
          << entry.path() << " names " << (*name)[0];
    }
  }
}

}  // namespace
}  // namespace breakwater
