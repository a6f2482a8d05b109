#include <breakwater/program/scenario_program.h>

#include <filesystem>

#include <breakwater/program/command_line.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>

namespace breakwater {
namespace {

// Before main(), which makes the catalogue.
[[maybe_unused]] const bool is_said = (say_lack_of_memory(), true);

}  // namespace

void set_places(const Catalogue& catalogue, const char* installation) {
  DataPlaces places{.scenarios = {}, .installation = installation};
  set_data_places(places);
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    if (kind.folder.empty()) continue;
    // The folder in which the program was built or, if it is gone, the installed one.
    const auto installed = look_for("scenarios/" + kind.name);
    places.scenarios.push_back(kind.folder);
    if (installed) places.scenarios.push_back(*installed);
  }
  if (!places.scenarios.empty()) set_data_places(places);
}

int detail::scenario_program(int argc, const char* const* argv, const Catalogue& catalogue,
                             const std::string& scenario, const char* installation) {
  set_places(catalogue, installation);
  const auto beside = std::filesystem::path(own_program()).replace_filename("breakwater");
  return scenario_main(catalogue, scenario, beside.string(), argc, argv);
}

}  // namespace breakwater
