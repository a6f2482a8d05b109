#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include <breakwater/program/commands.h>
#include <breakwater/program/reference_pages.h>
#include <breakwater/record/text_outputs.h>
#include <breakwater/recorded/recorded_estimation.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/paths.h>
#include <breakwater/shell/process.h>

namespace breakwater {

int reference_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " reference";
  return guarded(program, [&] {
    CLI::App app("write the reference pages: commands, keys, metrics, columns", program);
    std::filesystem::path out = "reference";
    app.add_option("--out", out, "the folder of the pages (default: reference)")->type_name("DIR");
    app.footer("It leaves commands.md, exit-statuses.md, estimate.md and scenarios/NAME.md.");
    if (const auto status = parse(app, argc, argv)) return *status;

    std::filesystem::create_directories(out / "scenarios");
    write_text_file((out / "commands.md").string(), commands_page(catalogue));
    write_text_file((out / "exit-statuses.md").string(), exit_statuses_page());
    for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
      write_text_file((out / "scenarios" / (kind.name + ".md")).string(),
                      scenario_page(catalogue, kind, {"run.duration_s=0.1"}));
    }
    write_text_file((out / "estimate.md").string(),
                    scenario_page(catalogue, recorded_estimation(),
                                  {"csv.file=" + data_file("data/estimate/motor.csv").string(),
                                   "plant.inertia=1e-3", "encoder.quantum=1.5e-3"}));
    fmt::print("{}\n", (out / "commands.md").string());
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
