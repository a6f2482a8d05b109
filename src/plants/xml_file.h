// Model files (MJCF, URDF) as XML, and their numbers, with checks that other libraries omit.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace breakwater {

/// An element of an XML file.
struct XmlElement {
  std::string name;
  std::string place;  ///< FILE:LINE
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;

  /// The value of an attribute; null if the element does not have it.
  const std::string* find(std::string_view attribute) const;
  bool has(std::string_view attribute) const { return find(attribute) != nullptr; }
  std::string text(std::string_view attribute, const std::string& otherwise = "") const;
  void set(const std::string& attribute, const std::string& value);
  void set(const std::string& attribute, std::span<const double> numbers);
  void erase(std::string_view attribute);

  /// The first child of this name; null: there is none.
  const XmlElement* child(std::string_view kind) const;

  /// Throws std::invalid_argument `FILE:LINE: <NAME>: WHAT`.
  [[noreturn]] void fail(const std::string& what) const;
};

/// The root of a well-formed XML file in UTF-8. Throws std::invalid_argument `FILE[:LINE]: reason`
/// if it cannot be read or is not such a file.
XmlElement read_xml(const std::string& file);

/// The words of a text, between white space.
std::vector<std::string> words_of(std::string_view text);

/// The numbers in `text`, separated by blanks, in C notation for every locale. Returns nothing if a
/// word is not a number. Infinity and NaN are numbers here.
std::optional<std::vector<double>> read_numbers(const std::string& text);

/// Whether a number is valid in a model: finite and within ±1e30.
bool is_sensible(double number);

}  // namespace breakwater
