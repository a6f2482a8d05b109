// A file that is either complete or unchanged.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <breakwater/record/output_error.h>

namespace breakwater {
namespace detail {
class DataFile;
}

/// A file that is written under a temporary name beside the final one. Without commit() it is
/// removed. If the name is a symbolic link, the file that it names is written. Something that is no
/// file, such as /dev/null, is never replaced.
class PartialFile {
 public:
  /// Throws OutputError.
  explicit PartialFile(std::filesystem::path file);
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile();

  /// The final name.
  const std::filesystem::path& file() const { return file_; }
  /// The temporary name, under which to write.
  const std::filesystem::path& path() const { return path_; }

  /// Waits until it is on the disk, and renames it to the final name. Throws OutputError.
  void commit();

 private:
  friend bool create_file(const std::filesystem::path& file, const std::string& bytes);
  void sync() const;
  [[noreturn]] void fail(const std::string& reason) const;

  std::filesystem::path file_;
  std::filesystem::path path_;
  std::unique_ptr<detail::DataFile> lock_;  // while it is written
};

/// Removes what killed processes have left of a file. PartialFile does this first.
void remove_left(const std::filesystem::path& file);

/// Writes a new file, complete at once. Returns false and keeps the file if it exists. Throws
/// OutputError.
bool create_file(const std::filesystem::path& file, const std::string& bytes);

/// Writes a file completely. On an error it keeps the old file and throws OutputError.
void replace_file(const std::filesystem::path& file, const std::string& bytes);

}  // namespace breakwater
