#include <breakwater/cluster/slurm_options.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include <breakwater/study/slurm_settings.h>

namespace breakwater {

void add_slurm_options(CLI::App& app, SlurmRequest& request) {
  app.add_option("--tasks", request.tasks,
                 "split the work into this many tasks (default: by --minutes)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000))
      ->group(kOnCluster);
  app.add_option("--minutes", request.minutes,
                 fmt::format("plan this time for a task (default: {:g})", request.minutes))
      ->type_name("M")
      ->check(CLI::PositiveNumber)
      ->group(kOnCluster);
  app.add_option("--parallel", request.parallel, "run at most this many tasks at a time")
      ->type_name("M")
      ->check(CLI::Range(1, 1000000))
      ->group(kOnCluster);
  app.add_option("--sbatch", request.options, "pass these options to sbatch")
      ->type_name("OPTIONS")
      ->check(overriding)
      ->expected(1)
      ->take_all()
      ->group(kOnCluster);
}

}  // namespace breakwater
