// A name of a process, unique among several computers.
#pragma once

#include <unistd.h>

#include <string>

namespace breakwater {

std::string host_name();

/// "HOST-PID", since two computers that share a file system may have processes of the same number.
std::string process_name(pid_t process = getpid());

}  // namespace breakwater
