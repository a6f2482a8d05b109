// `breakwater new`: makes a project from a template.
#pragma once

#include <filesystem>
#include <string>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Throws std::invalid_argument unless `name` matches [a-z][a-z0-9_]*, has at most 64 characters,
/// and is not the name of a scenario or part.
void check_project_name(const Catalogue& catalogue, const std::string& name);

/// Makes the project folder `out` from the template folder `from`. `placeholder` ("my_controller")
/// becomes `name` in the names and texts of the files. Likewise MyController becomes "Name" and
/// MY_CONTROLLER "NAME". On an error no folder is left. Throws std::invalid_argument if `out`
/// exists, its parent does not, or two files would have the same name; OutputError.
void make_project(const std::filesystem::path& from, const std::string& placeholder,
                  const std::string& name, const std::filesystem::path& out);

}  // namespace breakwater
