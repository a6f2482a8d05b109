#include <breakwater/render/offscreen.h>

#include <GL/gl.h>
#include <GL/osmesa.h>
#include <dlfcn.h>

#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

constexpr const char* kLibrary = "libOSMesa.so.8";
constexpr int kDepthBits = 24;
constexpr int kStencilBits = 8;  // for reflections

[[noreturn]] void refuse(const std::string& reason) {
  throw RenderError("pictures need OpenGL: " + reason);
}

void* load_library() {
  // Global: MuJoCo looks for OSMesa's functions among all that the process has.
  static void* const library = dlopen(kLibrary, RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr) {
    refuse(std::string(dlerror()) + " (Debian package libosmesa6)");
  }
  return library;
}

template <typename Function>
Function* find(const char* name) {
  void* const address = dlsym(load_library(), name);
  if (address == nullptr) refuse(std::string(kLibrary) + " has no " + name);
  return reinterpret_cast<Function*>(address);
}

}  // namespace

struct Offscreen::Mesa {
  decltype(OSMesaDestroyContext)* destroy =
      find<decltype(OSMesaDestroyContext)>("OSMesaDestroyContext");
  void (*finish)() = nullptr;
  OSMesaContext context = nullptr;

  Mesa() = default;
  Mesa(const Mesa&) = delete;
  Mesa& operator=(const Mesa&) = delete;
  ~Mesa() {
    if (context != nullptr) destroy(context);
  }

  template <typename Function>
  Function* opengl(const char* name) const {
    const auto address = find<decltype(OSMesaGetProcAddress)>("OSMesaGetProcAddress")(name);
    if (address == nullptr) refuse(std::string("it has no ") + name);
    return reinterpret_cast<Function*>(address);
  }
};

Offscreen::Offscreen(int width, int height)
    : width_(width),
      height_(height),
      pixels_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      mesa_(std::make_unique<Mesa>()) {
  mesa_->context = find<decltype(OSMesaCreateContextExt)>("OSMesaCreateContextExt")(
      OSMESA_BGRA, kDepthBits, kStencilBits, 0, nullptr);
  if (mesa_->context == nullptr) refuse("OSMesa made no context");
  if (find<decltype(OSMesaMakeCurrent)>("OSMesaMakeCurrent")(
          mesa_->context, pixels_.data(), GL_UNSIGNED_BYTE, width, height) == GL_FALSE) {
    refuse("OSMesa draws no picture of " + std::to_string(width) + "x" + std::to_string(height));
  }
  find<decltype(OSMesaPixelStore)>("OSMesaPixelStore")(OSMESA_Y_UP, 0);
  mesa_->finish = mesa_->opengl<void()>("glFinish");
  const GLubyte* name = mesa_->opengl<const GLubyte*(GLenum)>("glGetString")(GL_RENDERER);
  renderer_ = name != nullptr ? reinterpret_cast<const char*>(name) : "";
}

Offscreen::~Offscreen() = default;

std::optional<std::string> Offscreen::slowness() const {
  if (renderer_.starts_with("llvmpipe")) return std::nullopt;
  return "OpenGL is drawn by " + renderer_ + ", not by llvmpipe, which is 15 times faster";
}

void Offscreen::finish() {
  mesa_->finish();
}

}  // namespace breakwater
