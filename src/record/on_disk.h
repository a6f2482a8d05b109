// Waiting for the disk.
#pragma once

#include <unistd.h>

#include <cerrno>

namespace breakwater {

/// Waits until what was written is on the disk. False if it cannot be, and errno says why; file
/// systems that know no fsync (of folders above all) are taken at their word.
inline bool is_on_disk(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

}  // namespace breakwater
