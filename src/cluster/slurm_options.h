// What every command that speaks Slurm is told of the cluster.
#pragma once

#include <CLI/CLI.hpp>

#include <breakwater/cluster/slurm.h>

namespace breakwater {

inline constexpr const char* kOnCluster = "On a cluster";  ///< the group of options

/// --tasks, --minutes, --parallel and --sbatch; what the request has is their default.
void add_slurm_options(CLI::App& app, SlurmRequest& request);

}  // namespace breakwater
