#include <breakwater/shell/terminal.h>

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace breakwater {
namespace {

std::string_view environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

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
  return isatty(fileno(stream)) != 0 && environment("NO_COLOR").empty() &&
         environment("TERM") != "dumb";
}

std::string toned(const std::string& text, Tone tone, bool colourful) {
  return colourful ? code(tone) + text + "\033[0m" : text;
}

}  // namespace breakwater
