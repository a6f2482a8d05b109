// Files of models (MJCF, URDF) as XML, and their numbers: what the libraries that read them let by.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace breakwater {

/// A well-formed XML file in UTF-8.
class XmlFile {
 public:
  /// Throws std::invalid_argument `FILE[:LINE]: reason` if it cannot be read or is none.
  explicit XmlFile(const std::string& file);
  /// Of a file that has been read.
  XmlFile(std::string file, std::string text);

  const std::string& text() const { return text_; }
  const tinyxml2::XMLElement* root() const { return document_.RootElement(); }

  /// Throws std::invalid_argument `FILE:LINE: WHAT`.
  [[noreturn]] void fail(int line, const std::string& what) const;

 private:
  std::string file_;
  std::string text_;
  tinyxml2::XMLDocument document_;
};

/// Throws std::invalid_argument if a file is a device, a pipe or a socket.
void check_ends(const std::filesystem::path& file);

/// The bytes of a file. Throws std::invalid_argument if it cannot be read, or as check_ends().
std::string read_text(const std::string& file);

/// The numbers that `text` is, with blanks between them, in the notation of C whatever the locale;
/// nothing if a word of it is no number. Infinity and NaN are numbers here.
std::optional<std::vector<double>> read_numbers(const std::string& text);

/// Whether a model can have such a number: finite, and not beyond ±1e30.
bool is_sensible(double number);

}  // namespace breakwater
