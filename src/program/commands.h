// The commands that belong to no other room. Each function is the main() of a command, with argv[0]
// as its name. It returns the exit status.
#pragma once

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// All commands of a complete program.
std::vector<CommandKind> all_commands(const Catalogue& catalogue);

/// `diff`: prints the first sample in which two runs differ. Exit status 1 if they differ.
int diff_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `doctor`: checks this machine and names the packages to install. Exit status 1 if something is
/// broken.
int doctor_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `list`: prints the available scenarios and parts.
int list_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `ls` and `rm`: list or remove the runs and studies below a folder.
inline constexpr const char* kListRuns = "ls";
inline constexpr const char* kRemoveRuns = "rm";
int list_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);
int remove_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `new`: makes a project from the folders of templates/.
int new_project_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `reference`: writes pages about commands, keys, metrics, columns and exit statuses.
int reference_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `sweep`: runs studies. Exit status 3 if a run failed and this stops the study.
int sweep_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `tune`: searches and validates the best values of some keys. Exit status 3 if no candidate met
/// the constraints or survived.
int tune_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `waves`: checks a sea state and prints it.
int waves_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
