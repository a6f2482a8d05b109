// A name of a process, unique among several computers.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace breakwater {

std::string host_name();

/// "HOST-PID", since two computers that share a file system may have processes of the same number.
std::string process_name(pid_t process = getpid());

/// Begins what may follow such a name, where one process needs several.
inline constexpr char kCopyMark = '+';

/// process_name() with a random end: processes of two containers may have the same name.
std::string unique_name();

/// A name of a temporary file or folder beside the target, ".NAME.partial-" for the mark
/// ".partial-". unique_name() may follow. A long name is shortened.
std::string hidden_name(const std::filesystem::path& target, const std::string& mark);

/// The path to which a write goes: the end of the chain if it is a symbolic link.
std::filesystem::path followed(std::filesystem::path path);

/// Whether a process of this name was on this computer and has ended. The number of the calling
/// process may have belonged to an earlier one, so its own name counts as such.
bool is_of_dead_process(const std::string& name);

}  // namespace breakwater
