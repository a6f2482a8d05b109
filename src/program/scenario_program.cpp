// Apart from program.cpp: what it links, a scenario's own binary does not load.
#include "pictures/video_later.h"
#include "program/program.h"
#include "report/printed_results.h"
#include "scenario/child_program.h"
#include "scenario/command_line.h"

namespace breakwater {

int scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                     const std::string& scenario) {
  const RunExtras extras{
      [](const std::filesystem::path& folder, const std::string& file, bool quiet) {
        return make_video(neighbour_program("breakwater"), folder, file, quiet);
      },
      thesis_references()};
  return scenario_main(catalogue, scenario, extras, argc, argv);
}

}  // namespace breakwater
