#include <breakwater/program/commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include <breakwater/program/health.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/table.h>
#include <breakwater/shell/terminal.h>

namespace breakwater {
namespace {

using State = HealthCheck::State;

constexpr std::size_t kWidth = 80;
constexpr std::size_t kTextColumn = 19;

const char* word(State state) {
  switch (state) {
    case State::ok:
      return "ok";
    case State::missing:
      return "missing";
    case State::broken:
      return "broken";
  }
  return "";
}

Tone tone(State state) {
  return state == State::ok ? Tone::good : state == State::missing ? Tone::doubtful : Tone::bad;
}

std::size_t count(const std::vector<HealthCheck>& checks, State state) {
  return static_cast<std::size_t>(std::count_if(
      checks.begin(), checks.end(), [&](const HealthCheck& c) { return c.state == state; }));
}

std::string summary(const std::vector<HealthCheck>& checks) {
  const std::size_t broken = count(checks, State::broken);
  const std::size_t missing = count(checks, State::missing);
  if (broken > 0) return fmt::format("{} of {} broken", broken, checks.size());
  if (missing > 0)
    return fmt::format("all that is there works; {} of {} missing, which are optional", missing,
                       checks.size());
  return "all works";
}

void print_checks(const std::vector<HealthCheck>& checks) {
  const bool colourful = is_colourful(stdout);
  const std::string indent(kTextColumn, ' ');
  for (const HealthCheck& check : checks) {
    const std::vector<std::string> lines = wrapped(one_line(check.found), kWidth - kTextColumn);
    fmt::print("{:<10}{}{}\n", check.what,
               toned(fmt::format("{:<9}", word(check.state)), tone(check.state), colourful),
               lines.front());
    for (std::size_t i = 1; i < lines.size(); ++i) fmt::print("{}{}\n", indent, lines[i]);
    if (check.install.empty()) continue;
    for (const std::string& line : wrapped(check.install, kWidth - kTextColumn - 2)) {
      fmt::print("{}> {}\n", indent, line);
    }
  }
  fmt::print("\n{}\n", summary(checks));
}

void print_checks_json(const std::vector<HealthCheck>& checks) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const HealthCheck& check : checks) {
    list.push_back({{"what", check.what},
                    {"state", word(check.state)},
                    {"found", check.found},
                    {"install", check.install}});
  }
  fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace

int doctor_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " doctor";
  return guarded(program, [&] {
    CLI::App app("check this machine and name the packages to install", program);
    bool json = false;
    app.add_flag("--json", json, "print a list of objects instead: what, state, found, install");
    app.footer(
        "missing: an optional part is not installed; everything else works.\n"
        "broken: a part does not work, or a necessary part is not installed.\n"
        "Exit status: 0 nothing is broken, 1 something is, 2 usage.");
    if (const auto status = parse(app, argc, argv)) return *status;
    const std::vector<HealthCheck> checks = check_health(catalogue);
    json ? print_checks_json(checks) : print_checks(checks);
    return static_cast<int>(count(checks, State::broken) == 0 ? kSuccess : kDefect);
  });
}

}  // namespace breakwater
