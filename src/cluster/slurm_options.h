// The options of every command that submits to Slurm.
#pragma once

#include <CLI/CLI.hpp>

#include <breakwater/cluster/slurm.h>

namespace breakwater {

inline constexpr const char* kOnCluster = "On a cluster";  ///< the group of options

/// Adds --tasks, --minutes, --parallel and --sbatch. Their default values are those of the request.
void add_slurm_options(CLI::App& app, SlurmRequest& request);

}  // namespace breakwater
