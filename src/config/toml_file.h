// Safe parsing of TOML from any source.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>

namespace breakwater {

/// The text of a file. Throws std::invalid_argument if it cannot be read. A text of more than 4 MiB
/// is cut: the parser refuses it.
std::string toml_file_text(const std::string& file);

/// Parses a file, and stores its text in `text` unless that is null. Throws std::invalid_argument
/// `FILE[:LINE]: reason` if it cannot be read or is not TOML. Files of more than 4 MiB, with
/// control characters or with more than 32 levels are refused too: they could overflow the parser's
/// stack.
toml::table parse_toml_file(const std::string& file, std::string* text = nullptr);

/// The value of `text`, read as the right side of `key =`; nothing if it is not TOML. Throws
/// std::invalid_argument `ORIGIN: reason` for a text that parse_toml_file() refuses for safety.
std::optional<toml::table> parse_toml_value(const std::string& text, const std::string& origin);

/// "FILE:LINE".
std::string at_line(const std::string& file, const toml::source_region& source);

}  // namespace breakwater
