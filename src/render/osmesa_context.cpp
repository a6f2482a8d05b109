#include <GL/gl.h>

#include <breakwater/render/opengl_context.h>

namespace breakwater {
namespace {

// The used part of GL/osmesa.h. Mesa has neither this header nor the library since 25.1. Where the
// library exists, it has this interface.
using OsmesaHandle = struct osmesa_context*;
using CreateContextExt = OsmesaHandle(GLenum format, GLint depth_bits, GLint stencil_bits,
                                      GLint accumulation_bits, OsmesaHandle shared);
using DestroyContext = void(OsmesaHandle);
using MakeCurrent = GLboolean(OsmesaHandle, void* pixels, GLenum type, GLsizei width,
                              GLsizei height);
using PixelStore = void(GLint name, GLint value);
using GetProcAddress = void*(const char* name);
constexpr GLenum kBgra = 0x1;
constexpr GLint kRowsFromBelow = 0x11;

constexpr int kDepthBits = 24;
constexpr int kStencilBits = 8;  // for reflections

class OsmesaContext : public OpenGlContext {
 public:
  explicit OsmesaContext(const OpenGlTarget& target) {
    if (handle_ == nullptr) throw NoOpenGl("OSMesa made no context");
    if (osmesa_library().symbol<NoOpenGl, MakeCurrent>("OSMesaMakeCurrent")(
            handle_, target.pixels, GL_UNSIGNED_BYTE, target.width, target.height) == GL_FALSE) {
      destroy_(handle_);
      throw NoOpenGl("OSMesa draws no picture of " + std::to_string(target.width) + "x" +
                     std::to_string(target.height));
    }
    osmesa_library().symbol<NoOpenGl, PixelStore>("OSMesaPixelStore")(kRowsFromBelow, 0);
    finish_ = function<void()>("glFinish");
  }
  ~OsmesaContext() override { destroy_(handle_); }

  const char* library() const override { return "OSMesa"; }
  void finish() override { finish_(); }

 private:
  void* find(const char* name) const override {
    return osmesa_library().symbol<NoOpenGl, GetProcAddress>("OSMesaGetProcAddress")(name);
  }

  DestroyContext* destroy_ =
      osmesa_library().symbol<NoOpenGl, DestroyContext>("OSMesaDestroyContext");
  OsmesaHandle handle_ = osmesa_library().symbol<NoOpenGl, CreateContextExt>(
      "OSMesaCreateContextExt")(kBgra, kDepthBits, kStencilBits, 0, nullptr);
  void (*finish_)() = nullptr;
};

}  // namespace

std::unique_ptr<OpenGlContext> make_osmesa_context(const OpenGlTarget& target) {
  return std::make_unique<OsmesaContext>(target);
}

}  // namespace breakwater
