#include <breakwater/render/offscreen.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include <breakwater/record/loaded_library.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace {

// Loaded when the first picture is drawn. The symbols are global, so that MuJoCo finds them.
const LoadedLibrary& egl_library() {
  static const LoadedLibrary library("libEGL.so.1", "libegl1", true);
  return library;
}

#define X(name) BREAKWATER_LOADED(egl_library, NoOpenGl, name)
// clang-format off
X(eglBindAPI) X(eglChooseConfig) X(eglCreateContext) X(eglCreatePbufferSurface)
X(eglDestroyContext) X(eglDestroySurface) X(eglGetError) X(eglGetProcAddress)
X(eglInitialize) X(eglMakeCurrent)
#undef X

constexpr std::array<EGLint, 17> kConfig = {
    EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
    EGL_RED_SIZE, 8, EGL_GREEN_SIZE, 8, EGL_BLUE_SIZE, 8, EGL_ALPHA_SIZE, 8,
    EGL_DEPTH_SIZE, 24, EGL_STENCIL_SIZE, 8, EGL_NONE};
// clang-format on

// A function of an extension; null if EGL does not have it.
template <typename Function>
Function* extension(const char* name) {
  return reinterpret_cast<Function*>(eglGetProcAddress(name));
}

// All devices that EGL lists; none if it cannot list them.
std::vector<EGLDeviceEXT> all_devices() {
  const auto query =
      extension<std::remove_pointer_t<PFNEGLQUERYDEVICESEXTPROC>>("eglQueryDevicesEXT");
  EGLint count = 0;
  if (query == nullptr || query(0, nullptr, &count) == EGL_FALSE) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (query(count, devices.data(), &count) == EGL_FALSE) return {};
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

bool is_software(EGLDeviceEXT device) {
  const auto query =
      extension<std::remove_pointer_t<PFNEGLQUERYDEVICESTRINGEXTPROC>>("eglQueryDeviceStringEXT");
  const char* const words = query != nullptr ? query(device, EGL_EXTENSIONS) : nullptr;
  return words != nullptr && std::strstr(words, "EGL_MESA_device_software") != nullptr;
}

// The devices to try, in order. nullptr means Mesa's own choice.
std::vector<EGLDeviceEXT> chosen(const OpenGlAsked& asked) {
  std::vector<EGLDeviceEXT> devices = all_devices();
  if (asked.device) {
    if (*asked.device >= static_cast<int>(devices.size())) {
      throw NoOpenGl(fmt::format("EGL has no device {} (MUJOCO_EGL_DEVICE_ID) but lists {}",
                                 *asked.device, devices.size()));
    }
    return {devices[static_cast<std::size_t>(*asked.device)]};
  }
  if (asked.software_only) {
    std::erase_if(devices, [](EGLDeviceEXT device) { return !is_software(device); });
  }
  if (devices.empty()) devices.push_back(nullptr);
  return devices;
}

EGLDisplay display_of(EGLDeviceEXT device) {
  const auto get =
      extension<std::remove_pointer_t<PFNEGLGETPLATFORMDISPLAYEXTPROC>>("eglGetPlatformDisplayEXT");
  if (get == nullptr) return EGL_NO_DISPLAY;
  return device != nullptr ? get(EGL_PLATFORM_DEVICE_EXT, device, nullptr)
                           : get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
}

[[noreturn]] void fail(const std::string& reason) {
  const EGLint error = eglGetError();
  throw NoOpenGl(fmt::format("EGL {} (error {:#06x})", reason, error));
}

}  // namespace

Offscreen::Offscreen(int width, int height)
    : width_(width),
      height_(height),
      pixels_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
  const std::vector<EGLDeviceEXT> devices = chosen(opengl_asked());
  for (const EGLDeviceEXT& device : devices) {
    try {
      open(device);
      return;
    } catch (const NoOpenGl&) {
      close();  // try the next one; the last is Mesa's software renderer, if installed
      if (&device == &devices.back()) throw;
    }
  }
}

Offscreen::~Offscreen() {
  close();
}

// Draws into a pbuffer. finish() reads the pixels from it.
void Offscreen::open(void* device) {
  display_ = display_of(device);
  if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) == EGL_FALSE) {
    fail("has no display without a screen");
  }
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
    fail("has no desktop OpenGL");
  }
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display_, kConfig.data(), &config, 1, &count) == EGL_FALSE || count == 0) {
    fail("has no frame buffer of 8 bits a colour");
  }
  const std::array<EGLint, 5> size = {EGL_WIDTH, width_, EGL_HEIGHT, height_, EGL_NONE};
  surface_ = eglCreatePbufferSurface(display_, config, size.data());
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (surface_ == EGL_NO_SURFACE || context_ == EGL_NO_CONTEXT ||
      eglMakeCurrent(display_, surface_, surface_, context_) == EGL_FALSE) {
    fail("made no context");
  }
  GLint largest = 0;
  function<void(GLenum, GLint*)>("glGetIntegerv")(GL_MAX_TEXTURE_SIZE, &largest);
  if (std::max(width_, height_) > largest) {
    throw NoOpenGl(fmt::format("EGL draws no picture of {}x{}", width_, height_));
  }
  // The background: black, with 0 in the fourth byte.
  function<void(GLbitfield)>("glClear")(GL_COLOR_BUFFER_BIT);
  const GLubyte* name = function<const GLubyte*(GLenum)>("glGetString")(GL_RENDERER);
  if (name != nullptr) renderer_ = reinterpret_cast<const char*>(name);
  renderer_ += ", EGL";
}

// Keeps the display: other contexts of the process may use it.
void Offscreen::close() {
  if (display_ == EGL_NO_DISPLAY) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
  display_ = surface_ = context_ = nullptr;
}

std::string Offscreen::missing_library() {
  return egl_library().is_there() ? "" : NoOpenGl(egl_library().complaint()).what();
}

// OpenGL's first row is at the bottom.
void Offscreen::finish() {
  function<void(GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void*)>("glReadPixels")(
      0, 0, width_, height_, GL_BGRA, GL_UNSIGNED_BYTE, pixels_.data());
  const std::ptrdiff_t row = std::ptrdiff_t{4} * width_;
  auto upper = pixels_.begin(), lower = pixels_.end() - row;
  for (; upper < lower; upper += row, lower -= row) std::swap_ranges(upper, upper + row, lower);
}

void* Offscreen::find(const char* name) {
  return reinterpret_cast<void*>(eglGetProcAddress(name));
}

}  // namespace breakwater
