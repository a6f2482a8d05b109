#include <breakwater/render/offscreen.h>

#include <GL/gl.h>

#include <breakwater/sim/opengl_asked.h>

namespace breakwater {
namespace {

struct Choice {
  bool is_osmesa;
  EglDevices devices;
};

Choice choose() {
  const OpenGlAsked asked = opengl_asked();
  switch (asked.library) {
    case OpenGlAsked::Library::osmesa:
      return {true, {}};
    case OpenGlAsked::Library::egl:
      return {false, {asked.egl_device, false}};
    case OpenGlAsked::Library::any:
      break;
  }
  if (osmesa_library().is_there()) return {true, {}};
  if (egl_library().is_there()) return {false, {std::nullopt, true}};
  throw NoOpenGl(osmesa_library().complaint() + ", and " + egl_library().complaint());
}

std::unique_ptr<OpenGlContext> make_context(const OpenGlTarget& target) {
  // Choose once: MuJoCo keeps the functions of the first library.
  static const Choice choice = choose();
  return choice.is_osmesa ? make_osmesa_context(target) : make_egl_context(target, choice.devices);
}

}  // namespace

Offscreen::Offscreen(int width, int height)
    : width_(width),
      height_(height),
      pixels_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      context_(make_context({width, height, pixels_.data()})) {
  const GLubyte* name = context_->function<const GLubyte*(GLenum)>("glGetString")(GL_RENDERER);
  if (name != nullptr) renderer_ = reinterpret_cast<const char*>(name);
  renderer_ += std::string(", ") + context_->library();
}

std::optional<std::string> Offscreen::slowness() const {
  if (!renderer_.starts_with("softpipe") && !renderer_.starts_with("swrast")) return std::nullopt;
  return "OpenGL is drawn by " + renderer_ + ", not by llvmpipe, which is 15 times faster";
}

}  // namespace breakwater
