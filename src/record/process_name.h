// A name of a process, unique among several computers.
#pragma once

#include <unistd.h>

#include <string>

namespace breakwater {

std::string host_name();

/// "HOST-PID", since two computers that share a file system may have processes of the same number.
std::string process_name(pid_t process = getpid());

/// Begins what may follow such a name, where one process needs several.
inline constexpr char kCopyMark = '+';

/// Whether a process of this name was on this computer and has ended. The number of the calling
/// process may have belonged to an earlier one, so its own name counts as such.
bool is_of_dead_process(const std::string& name);

}  // namespace breakwater
