// The commands that belong to no other room. Each function is the main() of a command, with argv[0]
// as its name. It returns the exit status.
#pragma once

#include <filesystem>
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

}  // namespace breakwater
