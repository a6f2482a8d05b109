#include <breakwater/plants/xml_file.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace breakwater {
namespace {

constexpr std::size_t kLongestShown = 80;  // longest part of an XML declaration in a message

// The position of the first byte that is not UTF-8; npos: none.
std::size_t find_no_utf8(const std::string& text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xc2 && lead < 0xe0 ? 2
                               : lead >= 0xe0 && lead < 0xf0 ? 3
                               : lead >= 0xf0 && lead < 0xf5 ? 4
                                                             : 0;
    if (length == 0 || lead == 0 || at + length > text.size()) return at;
    std::uint32_t code = length == 1 ? lead : lead & (0x7fU >> length);
    for (std::size_t i = 1; i < length; ++i) {
      const auto next = static_cast<unsigned char>(text[at + i]);
      if ((next & 0xc0U) != 0x80U) return at;
      code = (code << 6U) | (next & 0x3fU);
    }
    constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < kSmallest[length] || (code >= 0xd800 && code < 0xe000) || code > 0x10ffff) return at;
    at += length;
  }
  return std::string::npos;
}

std::string read_text(const std::string& file) {
  check_ends(file);
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) throw std::invalid_argument(file + ": cannot be read");
  return text.str();
}

}  // namespace

void check_ends(const std::filesystem::path& file) {
  std::error_code error;
  const auto type = std::filesystem::status(file, error).type();
  using Type = std::filesystem::file_type;
  if (type == Type::directory) {
    throw std::invalid_argument(file.string() + ": cannot be read (it is a folder)");
  }
  if (type == Type::fifo || type == Type::character || type == Type::block ||
      type == Type::socket) {
    throw std::invalid_argument(file.string() + ": is no regular file: it may never end");
  }
}

XmlFile::XmlFile(std::string file) : file_(std::move(file)) {
  const std::string text = read_text(file_);
  const std::size_t broken = find_no_utf8(text);
  if (broken != std::string::npos) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(broken);
    fail(1 + static_cast<int>(std::count(text.begin(), end, '\n')), "is not UTF-8");
  }
  if (document_.Parse(text.c_str()) != tinyxml2::XML_SUCCESS) {
    fail(document_.ErrorLineNum(),
         std::string("is not well-formed XML (") + document_.ErrorName() + ")");
  }
  if (root() == nullptr) fail(1, "has no element");
  // The parser accepts any declaration.
  const tinyxml2::XMLNode* first = document_.FirstChild();
  const auto* declaration = first->ToDeclaration();
  if (declaration == nullptr) return;
  const std::string begin = std::string(declaration->Value()).substr(0, kLongestShown);
  char opening[2] = "";
  char closing[2] = "";
  const int found =
      std::sscanf(begin.c_str(), R"(xml%*[^!-~]version = %1["']1.%*[0-9]%1["'])", opening, closing);
  if (found == 2 && opening[0] == closing[0]) return;
  fail(declaration->GetLineNum(), "<?" + begin + "?>: must begin with <?xml version=\"1.0\"");
}

void XmlFile::fail(int line, const std::string& what) const {
  throw std::invalid_argument(file_ + ":" + std::to_string(std::max(line, 1)) + ": " + what);
}

std::vector<std::string> words_of(std::string_view text) {
  constexpr std::string_view kSpaces = " \t\n\v\f\r";
  std::vector<std::string> words;
  for (std::size_t from = text.find_first_not_of(kSpaces), end = 0; from != text.npos;
       from = text.find_first_not_of(kSpaces, end)) {
    end = std::min(text.find_first_of(kSpaces, from), text.size());
    words.emplace_back(text.substr(from, end - from));
  }
  return words;
}

std::optional<std::vector<double>> read_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& word : words_of(text)) {
    const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
    const char* end = word.data() + word.size();
    double number = 0.0;
    const auto result = std::from_chars(begin, end, number);
    const bool is_whole = result.ptr == end && end != begin;
    if (!is_whole || result.ec == std::errc::invalid_argument) return std::nullopt;
    // For 1e999 and 1e-999 from_chars reports "out of range", but not the side.
    if (result.ec == std::errc::result_out_of_range) {
      number = word.find("e-") == std::string::npos && word.find("E-") == std::string::npos
                   ? HUGE_VAL
                   : 0.0;
    }
    numbers.push_back(number);
  }
  return numbers;
}

bool is_sensible(double number) {
  constexpr double kLargest = 1e30;
  return std::abs(number) <= kLargest;
}

}  // namespace breakwater
