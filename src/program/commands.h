// The commands of a program that are no room's own: main() of each, argv[0] being its name. Each
// returns its exit status.
#pragma once

#include <breakwater/experiment/catalogue.h>
#include <breakwater/experiment/command_kind.h>

namespace breakwater {

/// Every command of a program that has all of them.
std::vector<CommandKind> all_commands(const Catalogue& catalogue);

/// `doctor`: what works on this machine, and what to install for what does not: 1 if something is
/// broken.
int doctor_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `list`: what there is to choose from.
int list_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `ls` and `rm`: the runs and studies below a folder.
inline constexpr const char* kListRuns = "ls";
inline constexpr const char* kRemoveRuns = "rm";
int list_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);
int remove_runs_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `new`: a project of the user's own. Its kinds are the folders of templates/.
int new_project_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `reference`: pages about commands, keys, metrics, columns and exit statuses.
int reference_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `sweep`: studies of many runs: 3 if a run failed and the study is to stop then.
int sweep_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `tune`: the best values of some keys, and what they are worth elsewhere: 3 if no candidate met
/// the constraints or survived.
int tune_main(const Catalogue& catalogue, int argc, const char* const* argv);

/// `waves`: a sea, checked and printed.
int waves_main(const Catalogue& catalogue, int argc, const char* const* argv);

}  // namespace breakwater
