// Waiting for the disk.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace breakwater {

/// Waits until the written data are on the disk. Returns false, and sets errno, if that fails. A
/// file system without fsync (for folders, for example) counts as success.
inline bool is_on_disk(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

/// The same for the file or the folder of this name.
inline bool is_on_disk(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && is_on_disk(descriptor);
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  errno = error;
  return is_synced;
}

}  // namespace breakwater
