// An open file that is read and written by place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

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
  /// Returns the number of bytes read: less than `bytes` at the end of the file.
  std::size_t read(void* data, std::size_t bytes, std::uint64_t place) const;
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

/// Copies `bytes` bytes from one file to another.
void copy(const DataFile& from, std::uint64_t from_place, DataFile& to, std::uint64_t to_place,
          std::uint64_t bytes);

}  // namespace breakwater::detail
