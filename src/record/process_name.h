// What tells a process from all others, on however many computers.
#pragma once

#include <unistd.h>

#include <string>

namespace breakwater {

std::string host_name();

/// "HOST-PID": two computers that share a file system may both have a process of this number.
std::string process_name(pid_t process = getpid());

}  // namespace breakwater
