// Another program, called and waited for.
#pragma once

#include <string>
#include <vector>

namespace breakwater {

/// Our own program `breakwater`, which stands beside the running one.
std::string own_program();

/// Calls a program, words[0] being its path or a name to be found. Returns its exit status. If it
/// cannot be called or a signal ends it, says so on stderr as `WHAT: …` and returns 4. An
/// interruption of ours is passed on to it.
int call_program(const std::string& what, std::vector<std::string> words);

}  // namespace breakwater
