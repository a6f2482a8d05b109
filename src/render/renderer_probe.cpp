#include <breakwater/render/renderer_probe.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <system_error>

#include <breakwater/render/offscreen.h>
#include <breakwater/sim/opengl_asked.h>

namespace breakwater {
namespace {

constexpr int kSide = 64;

// Whether a library of the wanted kind is installed.
bool has_library() {
  switch (opengl_asked().library) {
    case OpenGlAsked::Library::osmesa:
      return osmesa_library().is_there();
    case OpenGlAsked::Library::egl:
      return egl_library().is_there();
    case OpenGlAsked::Library::any:
      break;
  }
  return osmesa_library().is_there() || egl_library().is_there();
}

std::string drawn_or_why_not() {
  try {
    return "+" + Offscreen(kSide, kSide).renderer();
  } catch (const std::invalid_argument& error) {
    return "!" +
           std::string(error.what());  // a wrong environment variable, which no library can correct
  } catch (const std::exception& error) {
    return (has_library() ? "!" : "-") + std::string(error.what());
  }
}

// Answers with one character and words. No exception may leave it: the parent's frames are above.
[[noreturn]] void draw_in_child(int answer) noexcept {
  const std::string text = drawn_or_why_not();
  const bool is_said = write(answer, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  _exit(is_said ? EXIT_SUCCESS : EXIT_FAILURE);
}

std::string read_to_end(int file) {
  std::string text;
  std::array<char, 512> part{};
  for (;;) {
    const ssize_t got = read(file, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

RendererProbe probe_renderer(const std::optional<std::string>& mujoco_gl) {
  if (!mujoco_gl) opengl_asked();
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "pipe");
  }
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    throw std::system_error(errno, std::generic_category(), "fork");
  }
  if (child == 0) {
    if (mujoco_gl) {  // test the library itself, on any device
      setenv("MUJOCO_GL", mujoco_gl->c_str(), 1);
      unsetenv("MUJOCO_EGL_DEVICE_ID");
    }
    draw_in_child(ends[1]);
  }
  close(ends[1]);
  const std::string text = read_to_end(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (text.empty()) return {RendererProbe::Outcome::no_context, "the driver crashed"};
  return {text[0] == '+'   ? RendererProbe::Outcome::draws
          : text[0] == '-' ? RendererProbe::Outcome::no_library
                           : RendererProbe::Outcome::no_context,
          text.substr(1)};
}

}  // namespace breakwater
