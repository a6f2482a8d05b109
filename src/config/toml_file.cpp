#include <breakwater/config/toml_file.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <breakwater/math/float_environment.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace {

constexpr std::size_t kLargestText = 4U << 20U;
constexpr int kDeepest = 32;  // levels of nested values, and parts of a dotted key

// Scans nesting, strings and comments. In a text that is not TOML it may go wrong, but only after
// the place where the parser stops.
class Guard {
 public:
  explicit Guard(std::string_view text) : text_(text) {}

  // The reason not to parse the text, at line(); nullptr if there is none.
  const char* complaint() {
    if (text_.size() > kLargestText) return "is longer than 4 MiB";
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (is_control(c)) return "has a control character";
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == '"' || c == '\'') {
        skip_string(c);
      } else {
        count(c);
        ++at_;
      }
      if (depth_ > kDeepest) return "is nested too deeply";
      if (parts_ > kDeepest) return "has a key of too many parts";
    }
    return nullptr;
  }

  int line() const { return line_; }

 private:
  static bool is_control(char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t';
  }

  void count(char c) {
    if (c == '\n') ++line_;
    if (c == '[' || c == '{') ++depth_;
    if (c == ']' || c == '}') depth_ = std::max(depth_ - 1, 0);
    if (c == '.') {
      ++parts_;
    } else if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
      parts_ = 1;
    }
  }

  // There are four kinds of string: with or without escapes, on one line or on many.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool is_long = text_.substr(at_, 3) == three;
    const std::string end = is_long ? three : three.substr(0, 1);
    at_ += end.size();
    while (at_ < text_.size() && text_.substr(at_, end.size()) != end) {
      if (text_[at_] == '\n') {
        if (!is_long) return;
        ++line_;
      }
      const bool is_escape =
          quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n';
      at_ += is_escape ? 2 : 1;
    }
    at_ = std::min(at_ + end.size(), text_.size());
    // A string with three quotes may end in one or two more.
    while (is_long && at_ < text_.size() && text_[at_] == quote) ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  int depth_ = 0;
  int parts_ = 1;
};

}  // namespace

std::string at_line(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line);
}

std::string toml_file_text(const std::string& file) {
  std::ifstream stream = open_input(file);
  // Reads at most one character more than is allowed, which shows that the file is too long.
  std::string text;
  std::array<char, 1 << 14> block;
  while (stream && text.size() <= kLargestText) {
    stream.read(block.data(), block.size());
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  return text;
}

toml::table parse_toml_file(const std::string& file, std::string* text_of_file) {
  const math::FloatEnvironment floats;
  std::string text = toml_file_text(file);
  Guard guard(text);
  if (const char* complaint = guard.complaint()) {
    throw std::invalid_argument(file + ":" + std::to_string(guard.line()) + ": " + complaint);
  }
  try {
    toml::table table = toml::parse(text, file);
    if (text_of_file != nullptr) *text_of_file = std::move(text);
    return table;
  } catch (const toml::parse_error& e) {
    std::string reason(e.description());
    if (reason.ends_with("expected '=', saw '['")) reason += " (a key with brackets needs quotes)";
    throw std::invalid_argument(at_line(file, e.source()) + ": is not TOML: " + reason);
  }
}

std::optional<toml::table> parse_toml_value(const std::string& text, const std::string& origin) {
  const math::FloatEnvironment floats;
  if (const char* complaint = Guard(text).complaint()) {
    // Only these can nest. Any other text, such as a path with many dots, is a bare word.
    const std::size_t first = text.find_first_not_of(" \t");
    const bool may_nest = first != std::string::npos && (text[first] == '[' || text[first] == '{');
    if (!may_nest) return std::nullopt;
    throw std::invalid_argument(origin + ": " + complaint);
  }
  try {
    toml::table parsed = toml::parse("value = " + text);
    if (parsed.size() == 1 && parsed.contains("value")) return parsed;
  } catch (const toml::parse_error&) {
    // It is a bare word.
  }
  return std::nullopt;
}

}  // namespace breakwater
