#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <vector>

#include <breakwater/render/opengl_context.h>

namespace breakwater {
namespace {

constexpr std::array<EGLint, 17> kConfig = {EGL_SURFACE_TYPE,
                                            EGL_PBUFFER_BIT,
                                            EGL_RENDERABLE_TYPE,
                                            EGL_OPENGL_BIT,
                                            EGL_RED_SIZE,
                                            8,
                                            EGL_GREEN_SIZE,
                                            8,
                                            EGL_BLUE_SIZE,
                                            8,
                                            EGL_ALPHA_SIZE,
                                            8,
                                            EGL_DEPTH_SIZE,
                                            24,
                                            EGL_STENCIL_SIZE,
                                            8,
                                            EGL_NONE};

template <typename Function>
Function* egl(const char* name) {
  return egl_library().symbol<NoOpenGl, Function>(name);
}

// A function of an extension; null if EGL does not have it.
template <typename Function>
Function* extension(const char* name) {
  return reinterpret_cast<Function*>(egl<decltype(eglGetProcAddress)>("eglGetProcAddress")(name));
}

bool has_word(const char* words, std::string_view word) {
  if (words == nullptr) return false;
  const std::string_view text(words);
  for (std::size_t at = text.find(word); at != std::string_view::npos;
       at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || text[at - 1] == ' ') && (end == text.size() || text[end] == ' ')) return true;
  }
  return false;
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
  return query != nullptr && has_word(query(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

// The devices to try, in order. nullptr means Mesa's own choice.
std::vector<EGLDeviceEXT> chosen(const EglDevices& wanted) {
  std::vector<EGLDeviceEXT> devices = all_devices();
  if (wanted.number) {
    if (*wanted.number >= static_cast<int>(devices.size())) {
      throw NoOpenGl(fmt::format("EGL has no device {} (MUJOCO_EGL_DEVICE_ID) but lists {}",
                                 *wanted.number, devices.size()));
    }
    return {devices[static_cast<std::size_t>(*wanted.number)]};
  }
  if (wanted.software_only) {
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

// Draws into a pbuffer. finish() reads the pixels from it.
class EglContext : public OpenGlContext {
 public:
  // Throws RenderError if the device is not suitable.
  EglContext(const OpenGlTarget& target, EGLDeviceEXT device)
      : target_(target), display_(display_of(device)) {
    try {
      make_current();
      const auto size = static_cast<GLint>(std::max(target.width, target.height));
      GLint largest = 0;
      function<void(GLenum, GLint*)>("glGetIntegerv")(GL_MAX_TEXTURE_SIZE, &largest);
      if (size > largest) {
        throw NoOpenGl(fmt::format("EGL draws no picture of {}x{}", target.width, target.height));
      }
      // The background: black, with 0 in the fourth byte.
      function<void(GLbitfield)>("glClear")(GL_COLOR_BUFFER_BIT);
      read_pixels_ = function<std::remove_pointer_t<decltype(read_pixels_)>>("glReadPixels");
    } catch (...) {
      release();
      throw;
    }
  }
  ~EglContext() override { release(); }

  const char* library() const override { return "EGL"; }

  // OpenGL's first row is at the bottom.
  void finish() override {
    read_pixels_(0, 0, target_.width, target_.height, GL_BGRA, GL_UNSIGNED_BYTE, target_.pixels);
    const std::size_t row = 4 * static_cast<std::size_t>(target_.width);
    std::uint8_t* upper = target_.pixels;
    std::uint8_t* lower = target_.pixels + row * static_cast<std::size_t>(target_.height - 1);
    for (; upper < lower; upper += row, lower -= row) std::swap_ranges(upper, upper + row, lower);
  }

 private:
  void* find(const char* name) const override {
    return reinterpret_cast<void*>(egl<decltype(eglGetProcAddress)>("eglGetProcAddress")(name));
  }

  void make_current() {
    if (display_ == EGL_NO_DISPLAY ||
        egl<decltype(eglInitialize)>("eglInitialize")(display_, nullptr, nullptr) == EGL_FALSE) {
      fail("has no display without a screen");
    }
    if (egl<decltype(eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API) == EGL_FALSE) {
      fail("has no desktop OpenGL");
    }
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (egl<decltype(eglChooseConfig)>("eglChooseConfig")(display_, kConfig.data(), &config, 1,
                                                          &count) == EGL_FALSE ||
        count == 0) {
      fail("has no frame buffer of 8 bits a colour");
    }
    const std::array<EGLint, 5> size = {EGL_WIDTH, target_.width, EGL_HEIGHT, target_.height,
                                        EGL_NONE};
    surface_ = egl<decltype(eglCreatePbufferSurface)>("eglCreatePbufferSurface")(display_, config,
                                                                                 size.data());
    context_ = egl<decltype(eglCreateContext)>("eglCreateContext")(display_, config, EGL_NO_CONTEXT,
                                                                   nullptr);
    if (surface_ == EGL_NO_SURFACE || context_ == EGL_NO_CONTEXT ||
        egl<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, surface_, surface_, context_) ==
            EGL_FALSE) {
      fail("made no context");
    }
  }

  // Keep the display: other contexts of the process may use it.
  void release() {
    if (display_ == EGL_NO_DISPLAY) return;
    egl<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, EGL_NO_SURFACE, EGL_NO_SURFACE,
                                                    EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) {
      egl<decltype(eglDestroyContext)>("eglDestroyContext")(display_, context_);
    }
    if (surface_ != EGL_NO_SURFACE) {
      egl<decltype(eglDestroySurface)>("eglDestroySurface")(display_, surface_);
    }
  }

  [[noreturn]] static void fail(const std::string& reason) {
    const EGLint error = egl<decltype(eglGetError)>("eglGetError")();
    throw NoOpenGl(fmt::format("EGL {} (error {:#06x})", reason, error));
  }

  OpenGlTarget target_;
  EGLDisplay display_;
  EGLSurface surface_ = EGL_NO_SURFACE;
  EGLContext context_ = EGL_NO_CONTEXT;
  void (*read_pixels_)(GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void*) = nullptr;
};

}  // namespace

std::unique_ptr<OpenGlContext> make_egl_context(const OpenGlTarget& target,
                                                const EglDevices& devices) {
  const std::vector<EGLDeviceEXT> candidates = chosen(devices);
  for (std::size_t i = 0; i + 1 < candidates.size(); ++i) {
    try {
      return std::make_unique<EglContext>(target, candidates[i]);
    } catch (const RenderError&) {
      continue;  // try the next one; the last is Mesa's software renderer, if installed
    }
  }
  return std::make_unique<EglContext>(target, candidates.back());
}

}  // namespace breakwater
