#include <breakwater/record/text_outputs.h>
#include <breakwater/shell/paths.h>
#include "support.h"

namespace breakwater::paths_test {

namespace fs = std::filesystem;

class SearchPathOf : public ::testing::Test {
 protected:
  SearchPathOf() {
    for (const char* folder : {"own", "mine", "prefix/bin", "prefix/share/breakwater", "tree/bin",
                               "tree/models", "tree/scenarios", "built/share/breakwater"}) {
      fs::create_directories(root_ / folder);
    }
  }

  std::vector<fs::path> folders(const std::string& variable, const std::string& program,
                                const DataPlaces& places = {}) const {
    return search_path(variable, root_ / program, places).folders;
  }

  void write(const std::string& file, const std::string& text) const {
    write_text_file((root_ / file).string(), text);
  }

  const testing::TemporaryPath root_{"paths"};
};

TEST_F(SearchPathOf, ScenariosComeFirstAndTheInstallationLast) {
  const DataPlaces places{.scenarios = {root_ / "own"},
                          .installation = root_ / "built/share/breakwater"};
  const auto found = folders((root_ / "mine").string(), "prefix/bin/lab", places);
  const std::vector<fs::path> expected = {root_ / "own", root_ / "mine",
                                          root_ / "prefix/share/breakwater",
                                          root_ / "built/share/breakwater"};
  EXPECT_EQ(found, expected);
}

TEST_F(SearchPathOf, AProgramInASourceTreeFindsTheTree) {
  EXPECT_EQ(folders("", "tree/bin/lab"), std::vector{root_ / "tree"});
}

TEST_F(SearchPathOf, OtherParentFoldersAreNotSearched) {
  fs::remove(root_ / "tree/models");
  EXPECT_TRUE(folders("", "tree/bin/lab").empty());
}

TEST_F(SearchPathOf, WarnsOfAnEntryThatIsNotAFolder) {
  const std::string variable = "/nowhere::" + (root_ / "mine").string();
  const SearchPath path = search_path(variable, root_ / "prefix/bin/lab", {});
  ASSERT_EQ(path.warnings.size(), 1U);
  EXPECT_EQ(path.warnings[0], "warning: BREAKWATER_PATH: /nowhere is no folder");
  EXPECT_EQ(path.folders.front(), root_ / "mine");
}

TEST_F(SearchPathOf, MessagesNameMissingFolders) {
  const SearchPath path = search_path("", root_ / "own/bin/lab", {.installation = "/gone"});
  EXPECT_TRUE(path.folders.empty());
  EXPECT_EQ(path.candidates.front(), root_ / "own/bin/share/breakwater");
  EXPECT_EQ(path.candidates.back(), "/gone");
}

// The own process, whose test folder is searched in the tree.
class OwnPlaces : public SearchPathOf {
 protected:
  ~OwnPlaces() override { set_data_places({}); }
};

TEST_F(OwnPlaces, LibrariesAreAboveTheProgramOrInItsInstallation) {
  set_data_places(
      {.installation = root_ / "built/share/breakwater", .program = root_ / "prefix/bin/lab"});
  EXPECT_EQ(own_library("x.so"), root_ / "built/lib/breakwater/x.so");
  fs::create_directories(root_ / "prefix/lib/breakwater");
  write("prefix/lib/breakwater/x.so", "");
  EXPECT_EQ(own_library("x.so"), root_ / "prefix/lib/breakwater/x.so");
}

TEST_F(OwnPlaces, AModelBesideItsScenarioHasAPortableName) {
  const fs::path model = root_ / "own/plant.xml";
  write_text_file(model.string(), "<mujoco/>");
  EXPECT_EQ(portable_path(model), model.string());
  set_data_places({.scenarios = {root_ / "own"}});
  EXPECT_EQ(portable_path(model), "plant.xml");
  EXPECT_EQ(find_file("plant.xml", "/"), model);
  EXPECT_EQ(data_file("plant.xml"), model);
}

TEST_F(OwnPlaces, ANameInAnEarlierFolderIsNotPortable) {
  write("own/plant.xml", "<mujoco/>");
  write("mine/plant.xml", "<mujoco/>");
  set_data_places({.scenarios = {root_ / "own", root_ / "mine"}});
  EXPECT_EQ(portable_path(root_ / "mine/plant.xml"), (root_ / "mine/plant.xml").string());
}

TEST_F(OwnPlaces, TheFolderOfTheNamingFileComesFirst) {
  write("own/plant.xml", "<mujoco/>");
  write("mine/plant.xml", "<mujoco/>");
  set_data_places({.scenarios = {root_ / "own"}});
  EXPECT_EQ(find_file("plant.xml", root_ / "mine"), root_ / "mine/plant.xml");
  EXPECT_FALSE(find_file("nothing.xml", root_ / "mine"));
}

TEST_F(OwnPlaces, AMissingFileIsAnErrorThatListsAllPlaces) {
  set_data_places({.scenarios = {root_ / "own"}, .installation = "/gone"});
  const std::string text = complaint_of([] { data_file("nothing.xml"); });
  EXPECT_TRUE(text.starts_with("nothing.xml is in none of " + (root_ / "own").string() + ", "))
      << text;
  EXPECT_TRUE(lacks(text, "/gone"));  // there is no such folder
}

}  // namespace breakwater::paths_test
