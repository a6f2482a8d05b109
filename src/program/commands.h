// The commands that belong to no other room. Each function is the main() of a command, with argv[0]
// as its name. It returns the exit status.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <breakwater/experiment/catalogue.h>
#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/shell/process.h>

namespace breakwater {

/// All commands of a complete program.
std::vector<CommandKind> all_commands(const Catalogue& catalogue);

/// Copies the files of a model's assets into FOLDER/assets, and names them there.
void bring_assets(MjcfElement& root, const std::filesystem::path& folder);

/// `convert`: writes a model file of MuJoCo 3 for MuJoCo 2.2. Exit status 3 if something was
/// dropped.
int convert_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `diff`: prints the first sample in which two runs differ. Exit status 1 if they differ.
int diff_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `doctor`: checks this machine and names the packages to install. Exit status 1 if something is
/// broken.
int doctor_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `ls`: lists the runs and studies below a folder.
int list_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `new`: makes a project from the folders of templates/.
int new_project_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `reference`: writes pages about commands, keys, metrics and columns.
int reference_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `sweep`: runs studies. Exit status 3 if a run failed and this stops the study.
int sweep_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `tune`: searches and validates the best values of some keys. Exit status 3 if no candidate met
/// the constraints or survived.
int tune_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// For --help: docs/how-to/running.md has their meaning.
inline constexpr const char* kExitStatuses =
    "Exit status: 0 success, 1 a defect, 2 usage or input, 3 the run failed, 4 only a later output "
    "failed, 130 interrupted.";

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
