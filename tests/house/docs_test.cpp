// The code in the documentation is code that is built.

#include <regex>

#include "support.h"

namespace breakwater {
namespace {
namespace fs = std::filesystem;

// A fenced block behind <!-- FILE --> is a piece of that file, word for word: of a template, which
// the install tests build and run, or of a test.
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

// The libraries' users need no look into src/: what the pages include is installed.
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
