#include <breakwater/shell/terminal.h>

#include <unistd.h>

#include <breakwater/signals/environment.h>

namespace breakwater {
namespace {

const char* code(Tone tone) {
  switch (tone) {
    case Tone::good:
      return "\033[32m";
    case Tone::doubtful:
      return "\033[33m";
    case Tone::bad:
      return "\033[31m";
    case Tone::faint:
      return "\033[2m";
  }
  return "";
}

}  // namespace

bool is_colourful(std::FILE* stream) {
  return isatty(fileno(stream)) != 0 && !environment("NO_COLOR") && environment("TERM") != "dumb";
}

std::string toned(const std::string& text, Tone tone, bool colourful) {
  return colourful ? code(tone) + text + "\033[0m" : text;
}

}  // namespace breakwater
