#include <breakwater/program/commands.h>

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>

namespace breakwater {
namespace {

void print_scenarios(const Catalogue& catalogue) {
  std::size_t width = 0;
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    width = std::max(width, kind.name.size());
  }
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    fmt::print("{:<{}} {}\n", kind.name, width, kind.make(catalogue)->summary());
  }
}

void print_parts(const Catalogue& catalogue) {
  std::vector<std::string> headings;
  for (const ListedPart& part : catalogue.parts()) {
    if (std::find(headings.begin(), headings.end(), part.what) == headings.end()) {
      headings.push_back(part.what);
    }
  }
  std::size_t width = 0;
  for (const ListedPart& part : catalogue.parts()) width = std::max(width, part.name.size());
  for (const std::string& heading : headings) {
    fmt::print("{}{}\n", heading == headings.front() ? "" : "\n", heading);
    for (const ListedPart& part : catalogue.parts()) {
      if (part.what == heading) fmt::print("  {:<{}} {}\n", part.name, width, part.help);
    }
  }
}

}  // namespace

int list_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " list";
  return guarded(program, [&] {
    CLI::App app("print the scenarios and what they study", program);
    bool parts = false;
    app.add_flag("--parts", parts, "the controllers and estimators instead");
    if (const auto status = parse(app, argc, argv)) return *status;
    parts ? print_parts(catalogue) : print_scenarios(catalogue);
    return static_cast<int>(kSuccess);
  });
}

}  // namespace breakwater
