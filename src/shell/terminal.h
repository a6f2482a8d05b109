// Colours on a terminal.
#pragma once

#include <cstdio>
#include <string>

namespace breakwater {

enum class Tone { good, doubtful, bad, faint };

/// Whether output to `stream` may be coloured: it is a terminal, `TERM` is not `dumb`, and NO_COLOR
/// is unset or empty (no-color.org).
bool is_colourful(std::FILE* stream);

/// The text between the escape codes of this colour if `colourful`. Pad before: codes have no
/// width.
std::string toned(const std::string& text, Tone tone, bool colourful);

}  // namespace breakwater
