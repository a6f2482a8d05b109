// `breakwater new`: makes a project from a template.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Throws std::invalid_argument unless `name` matches [a-z][a-z0-9_]*, has at most 64 characters,
/// and is not the name of a scenario or part.
void check_project_name(const Catalogue& catalogue, const std::string& name);

/// The kinds of projects, each with the folders that have its files. A line of the file kinds.txt
/// in `templates` is a kind and the names of its folders. A plant and a scenario are the same
/// project.
std::map<std::string, std::vector<std::filesystem::path>> kinds_of_projects(
    const std::filesystem::path& templates);

/// Makes the project folder `out` from the files of the folders `from`. In the names and texts of
/// the files, my_FOLDER of each folder ("my_controller") becomes `name`. Likewise MyController
/// becomes "Name" and MY_CONTROLLER "NAME". On an error no folder is left. Throws
/// std::invalid_argument if `out` exists, its parent does not, or two files would have the same
/// name; OutputError. `complete` may add files to the folder, and may be empty.
void make_project(const std::vector<std::filesystem::path>& from, const std::string& name,
                  const std::filesystem::path& out,
                  const std::function<void(const std::filesystem::path&)>& complete = {});

}  // namespace breakwater
