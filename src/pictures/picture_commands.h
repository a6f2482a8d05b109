// breakwater video | still | strip: pictures of finished runs.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace breakwater {

class Catalogue;

/// Their names and what they do.
const std::vector<std::pair<std::string, std::string>>& picture_commands();
bool is_picture_command(const std::string& name);

/// main() of one of them; argv[0] is its name. Returns its exit status: 0 success, 1 a defect of
/// ours, 2 usage or input, 4 the picture could not be made or written, 130 interrupted.
int picture_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
