// `breakwater new`: a project of the user's own, made of a template.
#pragma once

#include <filesystem>
#include <string>

#include <breakwater/experiment/catalogue.h>

namespace breakwater {

/// Throws std::invalid_argument unless `name` is [a-z][a-z0-9_]*, of 64 characters at most, and no
/// scenario and no part of the catalogue has it.
void check_project_name(const Catalogue& catalogue, const std::string& name);

/// Makes the folder `out` of the template in the folder `from`, whose project is called
/// `placeholder` ("my_controller"): in the files' names and texts it becomes `name`, MyController
/// "Name" and MY_CONTROLLER "NAME". The folder is complete or absent. Throws std::invalid_argument
/// if `out` is there already, its parent is not, or two files would have one name; OutputError.
void make_project(const std::filesystem::path& from, const std::string& placeholder,
                  const std::string& name, const std::filesystem::path& out);

}  // namespace breakwater
