// Values written as TOML.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// A basic string, with its quotes.
std::string toml_string(const std::string& text);

/// An array of strings.
std::string toml_strings(const std::vector<std::string>& texts);

/// A key: bare where TOML lets it be.
std::string toml_key(const std::string& key);

/// The shortest text that reads back as the same double, and as a TOML float.
std::string toml_number(double value);

/// The text of a value that toml_string() and the like wrote: a string without its quotes, anything
/// else as it is.
std::string plain_text(const std::string& value);

}  // namespace breakwater
