// Only the simulations of a sweep: runs of a case of motor_estimation with seeds 1 … N. All runs
// are prepared before the clock starts. Prints the processor time of the runs [s].
//
// Usage: bare_points CASE DURATION_S N
#include <cstdio>
#include <cstdlib>
#include <string>

#include <breakwater/experiment/runner.h>
#include <breakwater/program/program.h>
#include <breakwater/signals/thread_time.h>
#include <breakwater/sim/model.h>

using namespace breakwater;

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: bare_points CASE DURATION_S N\n", stderr);
    return 2;
  }
  const SharedModels shared;
  const Catalogue catalogue = standard_catalogue();
  const std::string scenario = "motor_estimation";
  const ScenarioFile file(catalogue.get<ScenarioKind>(scenario).file().string(), scenario);
  const int runs = std::atoi(argv[3]);
  RunControl control;
  control.logs = false;
  double seconds = 0.0;
  for (int seed = 1; seed <= runs; ++seed) {
    const PreparedRun run = prepare_point(
        catalogue, scenario, file, argv[1],
        {std::string("run.duration_s=") + argv[2], "run.seed=" + std::to_string(seed)});
    const double begin = thread_time_s();
    run.scenario->run(control);
    seconds += thread_time_s() - begin;
  }
  std::printf("%.6f\n", seconds);
  return 0;
}
