// Model files (MJCF, URDF) as XML, and their numbers, with checks that other libraries omit.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace breakwater {

/// A well-formed XML file in UTF-8.
class XmlFile {
 public:
  /// Throws std::invalid_argument `FILE[:LINE]: reason` if it cannot be read or is not such a file.
  explicit XmlFile(std::string file);

  const tinyxml2::XMLElement* root() const { return document_.RootElement(); }

  /// Throws std::invalid_argument `FILE:LINE: WHAT`.
  [[noreturn]] void fail(int line, const std::string& what) const;

 private:
  std::string file_;
  tinyxml2::XMLDocument document_;
};

/// Throws std::invalid_argument if a file is a folder, a device, a pipe or a socket.
void check_ends(const std::filesystem::path& file);

/// The words of a text, between white space.
std::vector<std::string> words_of(std::string_view text);

/// The numbers in `text`, separated by blanks, in C notation for every locale. Returns nothing if a
/// word is not a number. Infinity and NaN are numbers here.
std::optional<std::vector<double>> read_numbers(const std::string& text);

/// Whether a number is valid in a model: finite and within ±1e30.
bool is_sensible(double number);

}  // namespace breakwater
