// The files of a model: exactly those that the engine opens.
#include <cstdint>

#include <breakwater/plants/mjcf_files.h>
#include <breakwater/sim/model.h>
#include "support.h"

namespace breakwater::mjcf_files_test {
namespace {

namespace fs = std::filesystem;

class MjcfFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* folder : {"parts", "shapes/deep", "colours"}) {
      fs::create_directories(folder_ / folder);
    }
    write("robot.xml", R"(<mujoco>
  <compiler meshdir="shapes" texturedir="colours"/>
  <include file="parts/assets.xml"/>
  <worldbody>
    <body><freejoint/><geom type="mesh" mesh="hull"/><include file="parts/arm.xml"/></body>
  </worldbody>
</mujoco>)");
    write("parts/assets.xml", R"(<mujoco>
  <asset>
    <mesh name="hull" file="deep/hull.stl"/>
    <texture name="skin" type="2d" file="skin.png"/>
  </asset>
  <include file="parts/option.xml"/>
</mujoco>)");
    write("parts/option.xml", R"(<mujoco><option gravity="0 0 0"/></mujoco>)");
    write("parts/arm.xml", R"(<mujoco><geom type="sphere" size="0.1"/></mujoco>)");
    write("unused.xml", "<mujoco/>");
    write_tetrahedron("shapes/deep/hull.stl");
    fs::copy(testing::source_file("docs/pictures/impact.png"), folder_ / "colours/skin.png");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  // A binary STL.
  void write_tetrahedron(const std::string& name) const {
    const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    std::ofstream stream(folder_ / name, std::ios::binary);
    stream << std::string(80, ' ');
    const std::uint32_t count = 4;
    stream.write(reinterpret_cast<const char*>(&count), sizeof(count));
    for (const auto& face : faces) {
      stream << std::string(12, '\0');  // the normal, which is not used
      for (const int corner : face) {
        stream.write(reinterpret_cast<const char*>(corners[corner]), sizeof(corners[corner]));
      }
      stream << std::string(2, '\0');
    }
  }

  std::set<std::string> found() const {
    std::set<std::string> names;
    for (const fs::path& file : mjcf_files(folder_ / "robot.xml")) {
      names.insert(file.lexically_relative(folder_).string());
    }
    return names;
  }

  const testing::TemporaryPath folder_{"mjcf_files"};
};

TEST_F(MjcfFiles, AreExactlyTheFilesThatTheEngineNeeds) {
  const std::string model = (folder_ / "robot.xml").string();
  ASSERT_NO_THROW(Model::load(model));
  EXPECT_EQ(found(), std::set<std::string>({"robot.xml", "parts/assets.xml", "parts/arm.xml",
                                            "parts/option.xml", "shapes/deep/hull.stl",
                                            "colours/skin.png"}));
  EXPECT_EQ(mjcf_files(model).front(), fs::path(model));
  const std::set<std::string> needed = found();
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    if (!entry.is_regular_file()) continue;
    const fs::path aside = folder_.string() + ".aside";
    fs::rename(entry.path(), aside);
    const std::string name = entry.path().lexically_relative(folder_).string();
    if (needed.contains(name)) {
      EXPECT_REFUSED(Model::load(model)) << name;
    } else {
      EXPECT_NO_THROW(Model::load(model)) << name;
    }
    fs::rename(aside, entry.path());
  }
}

TEST_F(MjcfFiles, FoldersAreStrippedIfTheModelDemandsIt) {
  write("robot.xml", R"(<mujoco>
  <compiler meshdir="shapes/deep" strippath="true"/>
  <asset><mesh name="hull" file="C/elsewhere/hull.stl"/></asset>
  <worldbody><geom type="mesh" mesh="hull"/></worldbody>
</mujoco>)");
  ASSERT_NO_THROW(Model::load((folder_ / "robot.xml").string()));
  EXPECT_EQ(found(), std::set<std::string>({"robot.xml", "shapes/deep/hull.stl"}));
}

TEST_F(MjcfFiles, AnotherFileHasOnlyItself) {
  for (const char* text : {"", "<mujoco>", "nothing", "<mujoco><include/></mujoco>",
                           R"(<mujoco><include file="robot.xml"/></mujoco>)",
                           R"(<mujoco><include file="nowhere.xml"/></mujoco>)"}) {
    write("robot.xml", text);
    EXPECT_EQ(found(), std::set<std::string>({"robot.xml"})) << text;
  }
  fs::remove(folder_ / "robot.xml");
  EXPECT_EQ(found(), std::set<std::string>());
}

}  // namespace
}  // namespace breakwater::mjcf_files_test
