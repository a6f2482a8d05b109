// Arms with public model files, as `breakwater new robot` makes them ready, at a wall.
#include <nlohmann/json.hpp>

#include "shell.h"
#include "support.h"

namespace breakwater::robot_test {
namespace {

namespace fs = std::filesystem;

class Robots : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const fs::path robots = testing::source_file("../shared/robots");
    if (!fs::is_directory(robots)) GTEST_SKIP() << robots << ": no public model files here";
    fs::create_directories(folder_);
    testing::output_of(breakwater("new robot it --out " + project().string() + " --mjcf " +
                                  (robots / GetParam()).string()));
  }

  std::string breakwater(const std::string& arguments) const {
    return (testing::bin_folder() / "breakwater").string() + " " + arguments + " 2>&1";
  }
  fs::path project() const { return folder_ / "it"; }

  nlohmann::json metrics(const std::string& case_name, const std::string& more = "") const {
    const fs::path out = folder_ / "run";
    testing::output_of(breakwater("run " + (project() / "it.toml").string() + " --case " +
                                  case_name + " --out " + out.string() + more));
    return nlohmann::json::parse(testing::text_of(out / "metrics.json"));
  }

  const testing::TemporaryPath folder_{"robot"};
};

// Dry friction of the xArm 7 takes its time: 1.2 % of 5 N after 4 s.
TEST_P(Robots, PressWithTheReference) {
  for (const char* method : {"proposed", "hpfc", "drac", "tlsc"}) {
    const auto all = metrics(method);
    const double allowed_N = std::string(GetParam()).starts_with("xarm7") ? 0.065 : 0.05;
    EXPECT_LT(all.at("rms_force_error_N").get<double>(), allowed_N) << method;
    EXPECT_LT(all.at("free_motion_time_s").get<double>(), 0.25) << method;
  }
}

// The frame of the contact turns with the wall: only the place of the tip in it counts.
TEST_P(Robots, PressOnATiltedWall) {
  testing::output_of("sed -i 's/law = \"kelvin_voigt_clipped\"/&\\nwall.angle_rad = 0.5236/' " +
                     (project() / "it.toml").string());
  const auto all = metrics("tlsc");
  EXPECT_NEAR(all.at("mean_force_error_N").get<double>(), 0.0, 0.05);
  EXPECT_LT(all.at("rms_force_error_N").get<double>(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Public, Robots,
                         ::testing::Values("panda_nohand.xml", "iiwa14.xml", "ur5e.xml",
                                           "xarm7_nohand.xml"),
                         [](const auto& one) {
                           const std::string file = one.param;
                           return file.substr(0, file.find_first_of("_."));
                         });

}  // namespace
}  // namespace breakwater::robot_test
