// breakwater reproduce | report | compare: pages about runs.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace breakwater {

class Catalogue;

/// Their names and what they do.
const std::vector<std::pair<std::string, std::string>>& report_commands();
bool is_report_command(const std::string& name);

/// main() of one of them; argv[0] is its name. Returns its exit status: 0 success, 1 a defect of
/// ours, 2 usage or input, 4 a picture or video could not be made, 130 interrupted.
int report_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
