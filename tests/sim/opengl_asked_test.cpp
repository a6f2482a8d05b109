#include <breakwater/sim/opengl_asked.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "environment.h"
#include "support.h"

namespace breakwater {
namespace {

using Library = OpenGlAsked::Library;

TEST(OpenGlAsked, ReadsTheVariablesOfMujocosPrograms) {
  struct Row {
    std::string library, device;
    Library expected;
    std::optional<int> number;
  };
  const std::vector<Row> rows = {
      {"", "", Library::any, std::nullopt}, {"EGL", "", Library::egl, std::nullopt},
      {"osmesa", "", Library::osmesa, {}},  {"osmesa", "1", Library::osmesa, std::nullopt},
      {"egl", "0", Library::egl, 0},        {"", "2", Library::egl, 2}};
  for (const Row& row : rows) {
    const testing::Environment library("MUJOCO_GL", row.library);
    const testing::Environment device("MUJOCO_EGL_DEVICE_ID", row.device);
    const OpenGlAsked asked = opengl_asked();
    EXPECT_EQ(asked.library, row.expected) << row.library << " " << row.device;
    EXPECT_EQ(asked.egl_device, row.number) << row.library << " " << row.device;
  }
}

TEST(OpenGlAsked, RefusesOtherValues) {
  for (const char* number : {"-1", "1x", "x", "1.5", "99999999999"}) {
    const testing::Environment device("MUJOCO_EGL_DEVICE_ID", number);
    EXPECT_THROW(opengl_asked(), std::invalid_argument) << number;
  }
  const testing::Environment library("MUJOCO_GL", "glfw");
  EXPECT_THROW(opengl_asked(), std::invalid_argument);
}

}  // namespace
}  // namespace breakwater
