// Another program, called and waited for.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// The running program, its name ("breakwater", or a user's "door_lab"), and one that stands beside
/// it.
std::string own_program();
std::string own_program_name();
std::string neighbour_program(const std::string& name);

/// Calls a program, words[0] being its path or a name to be found. Returns its exit status. If it
/// cannot be called or a signal ends it, says so on stderr as `WHAT: …` and returns 4. An
/// interruption of ours is passed on to it.
int call_program(const std::string& what, std::vector<std::string> words);

}  // namespace breakwater
