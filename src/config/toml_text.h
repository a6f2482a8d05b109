// Values written as TOML.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// A basic string, with its quotes.
std::string toml_string(const std::string& text);

/// An array of strings.
std::string toml_strings(const std::vector<std::string>& texts);

/// A key, without quotes if TOML allows it.
std::string toml_key(const std::string& key);

/// The shortest text that reads back as the same double. TOML reads it as a float, not an integer.
std::string toml_number(double value);

/// The reverse of toml_string(): a string without its quotes. Any other value stays as it is.
std::string plain_text(const std::string& value);

/// The finite number that the whole text is, if it is one.
std::optional<double> number_in(const std::string& text);

/// Checks of an option's text for CLI11: the reason why it is refused, or "".
std::string must_be_number(const std::string& text);
std::string must_be_positive(const std::string& text);
std::string must_be_0_or_more(const std::string& text);

}  // namespace breakwater
