#include <breakwater/program/commands.h>

#include <breakwater/record/text_outputs.h>

#include "catalogue.h"

namespace breakwater::new_project_test {
namespace fs = std::filesystem;

std::string refusal(const std::string& name) {
  return complaint_of([&] { check_project_name(testing::catalogue(), name); });
}

TEST(ProjectName, IsALetterThenLettersDigitsAndUnderscores) {
  for (const char* name : {"a", "admittance", "eso2", "my_own", "a__b_", "double"}) {
    EXPECT_EQ(refusal(name), "") << name;
  }
}

TEST(ProjectName, OtherNamesAreRefusedInOneLine) {
  for (const std::string& name :
       {std::string(), std::string("Admittance"), std::string("2nd"), std::string("_a"),
        std::string("a-b"), std::string("a b"), std::string("../a"), std::string("a/b"),
        std::string("äther"), std::string("a\n"), std::string(65, 'a')}) {
    EXPECT_TRUE(refusal(name).starts_with("new: NAME must be a letter from a to z")) << name;
  }
  EXPECT_EQ(refusal(std::string(64, 'a')), "");
}

TEST(ProjectName, ANameOfTheCatalogueIsRefused) {
  EXPECT_EQ(refusal("hpfc"), "new: NAME is taken: there is the controller of the arm \"hpfc\"");
  EXPECT_EQ(refusal("stf"), "new: NAME is taken: there is the estimator of an axis \"stf\"");
  EXPECT_EQ(refusal("arm_push"), "new: NAME is taken: there is the scenario \"arm_push\"");
}

class NewProject : public ::testing::Test {
 protected:
  NewProject() {
    fs::create_directories(root_ / "part/my_part");
    write("part/main.cpp", "#include \"my_part/my_part.h\"\n");
    write("part/my_part/my_part.h", "class MyPart {};  // MY_PART_FOLDER\n");
  }

  void make(const std::string& name, const fs::path& out) const {
    make_project({root_ / "part"}, name, out);
  }
  void write(const std::string& file, const std::string& text) const {
    write_text_file((root_ / file).string(), text);
  }
  std::string text(const fs::path& file) const { return testing::text_of(root_ / file); }
  std::string refusal(const std::string& name, const fs::path& out) const {
    return complaint_of([&] { make(name, out); });
  }
  std::set<std::string> entries() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(root_)) names.insert(entry.path().filename());
    return names;
  }

  const testing::TemporaryPath root_{"new_project"};
};

TEST_F(NewProject, HasTheNameInItsFilesAndTheirNames) {
  make("big_door", root_ / "out/");
  EXPECT_EQ(text("out/main.cpp"), "#include \"big_door/big_door.h\"\n");
  EXPECT_EQ(text("out/big_door/big_door.h"), "class BigDoor {};  // BIG_DOOR_FOLDER\n");
  EXPECT_EQ(entries(), (std::set<std::string>{"out", "part"}));
}

TEST_F(NewProject, DoesNotChangeExistingFiles) {
  write("out", "mine");
  EXPECT_EQ(refusal("door", root_ / "out"), (root_ / "out").string() + ": is there already");
  EXPECT_EQ(text("out"), "mine");
  fs::remove(root_ / "out");
  fs::create_symlink(root_ / "nowhere", root_ / "out");
  EXPECT_EQ(refusal("door", root_ / "out"), (root_ / "out").string() + ": is there already");
}

TEST_F(NewProject, NeedsAParentFolder) {
  EXPECT_EQ(refusal("door", root_ / "no/out"), (root_ / "no").string() + ": is no folder");
}

TEST_F(NewProject, LeavesNothingBehindOnFailure) {
  write("part/my_part.cpp", "");
  EXPECT_EQ(refusal("main", root_ / "out"),
            "main: the project has a main.cpp already: choose another name");
  EXPECT_EQ(entries(), (std::set<std::string>{"part"}));
}

// A name with a template's name in it is written once. No two files get the same name.
TEST_F(NewProject, ShippedTemplatesHaveTheirPlaceholderNameAlone) {
  const auto kinds = kinds_of_projects(testing::source_file("templates"));
  EXPECT_EQ(kinds.size(), 5U);
  for (const auto& [kind, from] : kinds) {
    for (const std::string name : {"own_name", "my_part_of", "my_controller_of"}) {
      const fs::path out = root_ / (kind + name);
      make_project(from, name, out);
      std::size_t files = 0;
      for (const auto& entry : fs::recursive_directory_iterator(out)) {
        if (!entry.is_regular_file()) continue;
        ++files;
        const std::string all = entry.path().string() + text(entry.path());
        EXPECT_TRUE(lacks(all, "_of_of")) << entry.path();
        if (name != "own_name") continue;
        for (const char* word : {"my_controller", "my_observer", "my_part", "my_plant", "my_robot",
                                 "MyController", "MyObserver", "MY_"}) {
          EXPECT_TRUE(lacks(all, word)) << entry.path() << " has " << word;
        }
      }
      EXPECT_GE(files, from.size() == 1 ? 2U : from.size() == 2 ? 5U : 8U);
    }
  }
}

}  // namespace breakwater::new_project_test
