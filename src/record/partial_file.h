// A file that is either complete or unchanged, and an open file that is written by place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <breakwater/record/output_error.h>

namespace breakwater::detail {

/// Throws OutputError with the file's name.
class DataFile {
 public:
  /// `flags` are those of open().
  DataFile(std::filesystem::path file, int flags);
  ~DataFile();
  DataFile(const DataFile&) = delete;
  DataFile& operator=(const DataFile&) = delete;

  /// Locks the file. Returns false if another process has it locked. Some file systems have no
  /// locks.
  bool lock() const;
  void write(const void* data, std::size_t bytes, std::uint64_t place);
  /// Waits until all that was written is on the disk.
  void sync() const;

 private:
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path file_;
  int descriptor_;
};

/// Whether somebody has a lock on a file or folder. Unlike the name of a process, this holds for
/// several containers too.
bool is_locked(const std::filesystem::path& path);

}  // namespace breakwater::detail

namespace breakwater {

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

/// The error about a partial file with its final name, since users know only that one.
OutputError with_final_name(const OutputError& error, const std::filesystem::path& partial,
                            const std::filesystem::path& file);

/// Writes a file completely. On an error it keeps the old file and throws OutputError.
void replace_file(const std::filesystem::path& file, const std::string& bytes);

/// Waits until the written data are on the disk. Returns false, and sets errno, if that fails. A
/// file system without fsync (for folders, for example) counts as success.
bool is_on_disk(int descriptor);

}  // namespace breakwater
