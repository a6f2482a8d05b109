// TOML of any origin, read without harm.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>

namespace breakwater {

/// Parses a file, whose text goes into `text` unless it is null. Throws std::invalid_argument
/// `FILE[:LINE]: reason` if it cannot be read, is not TOML, or is such as no file of ours: of more
/// than 4 MiB, with control characters, or nested so deeply (values or dotted keys) that the
/// parser, which recurses, would not survive it.
toml::table parse_toml_file(const std::string& file, std::string* text = nullptr);

/// The value that `text` is, as if it stood behind `key =`; nothing if it is none. Throws
/// std::invalid_argument `ORIGIN: reason` for what parse_toml_file() does not let pass either.
std::optional<toml::table> parse_toml_value(const std::string& text, const std::string& origin);

/// "FILE:LINE".
std::string at_line(const std::string& file, const toml::source_region& source);

}  // namespace breakwater
