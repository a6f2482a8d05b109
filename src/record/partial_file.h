// A file that is there whole, or as it was before.
#pragma once

#include <filesystem>
#include <string>

#include <breakwater/record/output_error.h>

namespace breakwater {

/// A file that is written beside its name, which it takes when it is complete; it is removed if it
/// never is.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path file);
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile();

  /// The name that it is to take.
  const std::filesystem::path& file() const { return file_; }
  /// Where to write it.
  const std::filesystem::path& path() const { return path_; }

  /// Takes the name. Throws OutputError.
  void commit();

 private:
  std::filesystem::path file_;
  std::filesystem::path path_;
};

/// Writes a file that is not there yet, whole at once. Returns false if there is one by now, which
/// stays as it is. Throws OutputError.
bool create_file(const std::filesystem::path& file, const std::string& bytes);

/// Writes all of a file, or leaves it as it was and throws OutputError.
void replace_file(const std::filesystem::path& file, const std::string& bytes);

}  // namespace breakwater
