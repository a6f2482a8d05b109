// Waiting for the disk.
#pragma once

#include <unistd.h>

#include <cerrno>

namespace breakwater {

/// Waits until the written data are on the disk. Returns false, and sets errno, if that fails. A
/// file system without fsync (for folders, for example) counts as success.
inline bool is_on_disk(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

}  // namespace breakwater
