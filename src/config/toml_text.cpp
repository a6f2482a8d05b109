#include <breakwater/config/toml_text.h>

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace breakwater {

std::string toml_string(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += {'\\', c};
    } else if (c == '\n') {
      result += "\\n";
    } else if (std::iscntrl(static_cast<unsigned char>(c)) != 0) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string toml_strings(const std::vector<std::string>& texts) {
  std::vector<std::string> all;
  for (const std::string& text : texts) all.push_back(toml_string(text));
  return fmt::format("[{}]", fmt::join(all, ", "));
}

std::string toml_key(const std::string& key) {
  const bool is_bare = std::ranges::all_of(
      key, [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
  return is_bare ? key : toml_string(key);
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string plain_text(const std::string& value) {
  if (value.size() < 2 || value.front() != '"') return value;
  const toml::table table = toml::parse("value = " + value);
  return table["value"].value_or(value);
}

std::optional<double> number_in(const std::string& text) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || last != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::string must_be_number(const std::string& text) {
  return number_in(text) ? "" : "must be a number, is \"" + text + '"';
}

std::string must_be_positive(const std::string& text) {
  const auto number = number_in(text);
  return number && *number <= 0.0 ? "must be positive, is " + text : must_be_number(text);
}

std::string must_be_0_or_more(const std::string& text) {
  const auto number = number_in(text);
  return number && *number < 0.0 ? "must be 0 or more, is " + text : must_be_number(text);
}

}  // namespace breakwater
