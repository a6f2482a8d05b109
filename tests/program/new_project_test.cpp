#include <breakwater/program/new_project.h>

#include <set>

#include <breakwater/record/text_outputs.h>

#include "catalogue.h"

namespace breakwater {
namespace {
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
    fs::create_directories(root_ / "template/my_part");
    write("template/main.cpp", "#include \"my_part/my_part.h\"\n");
    write("template/my_part/my_part.h", "class MyPart {};  // MY_PART_FOLDER\n");
  }

  void make(const std::string& name, const fs::path& out) const {
    make_project(root_ / "template", "my_part", name, out);
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
  EXPECT_EQ(entries(), (std::set<std::string>{"out", "template"}));
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
  write("template/my_part.cpp", "");
  EXPECT_EQ(refusal("main", root_ / "out"),
            "main: the project has a main.cpp already: choose another name");
  EXPECT_EQ(entries(), (std::set<std::string>{"template"}));
}

// For any name, no two files of a shipped template get the same name.
TEST_F(NewProject, ShippedTemplatesHaveTheirPlaceholderNameAlone) {
  for (const char* kind : {"controller", "observer", "plant", "scenario"}) {
    const fs::path from = testing::source_file(std::string("templates/") + kind);
    make_project(from, std::string("my_") + kind, "own_name", root_ / kind);
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / kind)) {
      if (!entry.is_regular_file()) continue;
      ++files;
      const std::string all = entry.path().string() + text(entry.path());
      for (const char* word : {"my_controller", "my_observer", "my_plant", "my_scenario",
                               "MyController", "MyObserver", "MyScenario", "MY_SCENARIO"}) {
        EXPECT_TRUE(lacks(all, word)) << entry.path() << " has " << word;
      }
    }
    EXPECT_GE(files, std::string(kind) == "plant" ? 4U : 7U);
  }
}

}  // namespace
}  // namespace breakwater
