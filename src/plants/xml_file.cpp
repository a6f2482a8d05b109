#include <breakwater/plants/xml_file.h>

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include <breakwater/signals/input_file.h>

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

// The recursion is safe, because tinyxml2 refuses deeply nested files.
XmlElement element_of(const tinyxml2::XMLElement& from, const std::string& file) {
  XmlElement element{from.Name(), file + ":" + std::to_string(from.GetLineNum()), {}, {}};
  for (const auto* one = from.FirstAttribute(); one != nullptr; one = one->Next()) {
    element.attributes.emplace_back(one->Name(), one->Value());
  }
  for (const auto* child = from.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    element.children.push_back(element_of(*child, file));
  }
  return element;
}

}  // namespace

const std::string* XmlElement::find(std::string_view attribute) const {
  for (const auto& [own, value] : attributes) {
    if (own == attribute) return &value;
  }
  return nullptr;
}

std::string XmlElement::text(std::string_view attribute, const std::string& otherwise) const {
  const std::string* value = find(attribute);
  return value != nullptr ? *value : otherwise;
}

void XmlElement::set(const std::string& attribute, const std::string& value) {
  for (auto& [own, old] : attributes) {
    if (own != attribute) continue;
    old = value;
    return;
  }
  attributes.emplace_back(attribute, value);
}

void XmlElement::set(const std::string& attribute, std::span<const double> numbers) {
  std::string value;
  for (const double number : numbers) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    value.append(value.empty() ? "" : " ").append(digits.data(), end);
  }
  set(attribute, value);
}

void XmlElement::erase(std::string_view attribute) {
  std::erase_if(attributes, [&](const auto& own) { return own.first == attribute; });
}

void XmlElement::fail(const std::string& what) const {
  throw std::invalid_argument(place + ": <" + name + ">: " + what);
}

const XmlElement* XmlElement::child(std::string_view kind) const {
  const auto found = std::ranges::find(children, kind, &XmlElement::name);
  return found == children.end() ? nullptr : &*found;
}

XmlElement read_xml(const std::string& file) {
  const auto fail = [&](std::ptrdiff_t line, const std::string& what) {
    const std::string place = file + ":" + std::to_string(std::max<std::ptrdiff_t>(line, 1));
    throw std::invalid_argument(place + ": " + what);
  };
  std::stringstream bytes;
  bytes << open_input(file).rdbuf();
  const std::string text = bytes.str();
  const std::size_t broken = find_no_utf8(text);
  if (broken != std::string::npos) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(broken);
    fail(1 + std::count(text.begin(), end, '\n'), "is not UTF-8");
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str()) != tinyxml2::XML_SUCCESS) {
    fail(document.ErrorLineNum(),
         std::string("is not well-formed XML (") + document.ErrorName() + ")");
  }
  if (document.RootElement() == nullptr) fail(1, "has no element");
  // The parser accepts any declaration.
  if (const auto* declaration = document.FirstChild()->ToDeclaration()) {
    const std::string begin = std::string(declaration->Value()).substr(0, kLongestShown);
    char opening[2] = "";
    char closing[2] = "";
    const int found = std::sscanf(begin.c_str(), R"(xml%*[^!-~]version = %1["']1.%*[0-9]%1["'])",
                                  opening, closing);
    if (found != 2 || opening[0] != closing[0]) {
      fail(declaration->GetLineNum(), "<?" + begin + "?>: must begin with <?xml version=\"1.0\"");
    }
  }
  return element_of(*document.RootElement(), file);
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
