#include <breakwater/sim/opengl_asked.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>
#include <string>

#include <breakwater/signals/environment.h>

namespace breakwater {
namespace {

constexpr const char* kLibraryKey = "MUJOCO_GL";
constexpr const char* kDeviceKey = "MUJOCO_EGL_DEVICE_ID";

// The value of MUJOCO_GL in lower case.
std::string library_asked() {
  const std::string text = environment(kLibraryKey).value_or("");
  std::string name = text;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.empty() || name == "osmesa" || name == "egl") return name;
  throw std::invalid_argument(std::string(kLibraryKey) + ": \"" + text +
                              "\": must be egl or osmesa, which need no screen, or unset");
}

std::optional<int> device_asked() {
  const auto text = environment(kDeviceKey);
  if (!text) return std::nullopt;
  int number = 0;
  const char* const end = text->data() + text->size();
  const auto read = std::from_chars(text->data(), end, number);
  if (read.ec != std::errc() || read.ptr != end || number < 0) {
    throw std::invalid_argument(std::string(kDeviceKey) + ": \"" + *text +
                                "\": must be a whole number: which of EGL's devices, from 0");
  }
  return number;
}

}  // namespace

OpenGlAsked opengl_asked() {
  const std::string library = library_asked();
  const std::optional<int> device = device_asked();
  // MuJoCo's programs read the device only for EGL. A machine may set it for them.
  if (library == "osmesa") return {};
  return {device, library.empty()};
}

}  // namespace breakwater
