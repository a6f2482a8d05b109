#include <breakwater/sim/opengl_asked.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "environment.h"
#include "support.h"

namespace breakwater {
namespace {

TEST(OpenGlAsked, ReadsTheVariablesOfMujocosPrograms) {
  struct Row {
    std::string library, device;
    std::optional<int> number;
    bool software_only;
  };
  const std::vector<Row> rows = {{"", "", {}, true},       {"EGL", "", {}, false},
                                 {"osmesa", "", {}, true}, {"osmesa", "1", {}, true},
                                 {"egl", "0", 0, false},   {"", "2", 2, true}};
  for (const Row& row : rows) {
    const testing::Environment library("MUJOCO_GL", row.library);
    const testing::Environment device("MUJOCO_EGL_DEVICE_ID", row.device);
    const OpenGlAsked asked = opengl_asked();
    EXPECT_EQ(asked.device, row.number) << row.library << " " << row.device;
    EXPECT_EQ(asked.software_only, row.software_only) << row.library << " " << row.device;
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
