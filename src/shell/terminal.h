// Colours on a terminal, and nowhere else.
#pragma once

#include <cstdio>
#include <string>

namespace breakwater {

enum class Tone { good, doubtful, bad, faint };

/// Whether what goes to `stream` may be coloured: it is a terminal, which is not `TERM=dumb`, and
/// NO_COLOR is unset or empty (no-color.org).
bool is_colourful(std::FILE* stream);

/// The text between the escape codes of that colour, if `colourful`; else as it is. Padding comes
/// first: the codes have no width.
std::string toned(const std::string& text, Tone tone, bool colourful);

}  // namespace breakwater
