// `doctor`: checks of the software that the program needs at run time.
#include <breakwater/program/commands.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/experiment/runner.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/render/canvas.h>
#include <breakwater/render/frame_farm.h>
#include <breakwater/render/offscreen.h>
#include <breakwater/render/video_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/shell/table.h>
#include <breakwater/signals/environment.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr const char* kWorks = "ok";
constexpr const char* kMissing = "missing";  // an optional part is absent
constexpr const char* kBroken = "broken";    // it does not work, or a necessary part is absent

struct HealthCheck {
  std::string what;  // one word
  std::string state;
  std::string found;    // one line: a description, or the reason of the fault
  std::string install;  // a command that repairs it, if any
};

constexpr int kPictureSide = 64;

HealthCheck check_scenarios(const Catalogue& catalogue) {
  std::size_t count = 0;
  for (const ScenarioKind& kind : catalogue.all<ScenarioKind>()) {
    try {
      const auto file = kind.scenario_file();
      const PreparedRun run = prepare_run(catalogue, kind.name, *file, file->default_case(),
                                          {"run.duration_s=0.1"});  // it calls every part
      model_hashes(run.model_files);
      const Recording recording =
          run.scenario->run({.progress = {}, .stop = nullptr, .logs = false});
      if (recording.failure) throw std::runtime_error(recording.failure->reason);
      ++count;
    } catch (const std::exception& error) {
      return {"runs", kBroken, kind.name + ": " + error.what(), ""};
    }
  }
  return {"runs", kWorks,
          fmt::format("{} scenarios ran for 0.1 s each, MuJoCo {} with our {}", count,
                      engine_version(), fmt::join(engine_functions(), ", ")),
          ""};
}

// Draws one frame as a video does, in a process of its own, since a driver may crash.
HealthCheck check_pictures() {
  const auto asked = environment("MUJOCO_GL");
  const std::string when = asked ? "MUJOCO_GL=" + *asked : "MUJOCO_GL unset";
  try {
    opengl_asked();
    const std::string missing = Offscreen::missing_library();
    if (!missing.empty()) {
      return {"pictures", kMissing, missing, "apt install libegl1 libgl1-mesa-dri"};
    }
    Canvas(kPictureSide, kPictureSide);  // throws without Cairo
    const auto start = [](std::size_t) -> Drawer {
      return {[](std::size_t) { return nullptr; },
              Offscreen(kPictureSide, kPictureSide).renderer()};
    };
    const std::string renderer = draw_frames({.frames = 1}, start, [](const std::uint8_t*) {});
    return {"pictures", kWorks, fmt::format("drawn by {} ({})", renderer, when), ""};
  } catch (const RenderError& error) {
    return {"pictures", kBroken, fmt::format("{} ({})", error.what(), when), ""};
  } catch (const std::invalid_argument& error) {
    return {"pictures", kBroken, error.what(), ""};
  }
}

HealthCheck check_video() {
  const fs::path file = fs::temp_directory_path() / fmt::format("breakwater-{}.mp4", getpid());
  try {
    VideoFile video(file, {.width = kPictureSide, .height = kPictureSide});
    video.append(Canvas(kPictureSide, kPictureSide).pixels());
    video.finish();
    fs::remove(file);
    return {"video", kWorks, "H.264 by libx264 of ffmpeg", ""};
  } catch (const std::exception& error) {
    return {"video", kMissing, error.what(), "apt install ffmpeg"};
  }
}

HealthCheck check_pages() {
  std::vector<std::string> missing;
  for (const fs::path& file : page_libraries()) {
    if (!fs::is_regular_file(file)) missing.push_back(file.string());
  }
  if (missing.empty()) return {"pages", kWorks, "charts by dygraphs, replays by three.js", ""};
  return {"pages", kMissing, fmt::format("reports and replays lack {}", fmt::join(missing, ", ")),
          "apt install libjs-dygraphs libjs-three"};
}

// Makes all checks, the most important first. It runs each scenario briefly and draws a picture. No
// other thread may run.
std::vector<HealthCheck> check_health(const Catalogue& catalogue) {
  // It forks, so it comes first: the runs may leave threads.
  const HealthCheck pictures = check_pictures();
  return {check_scenarios(catalogue), pictures, check_video(), check_pages()};
}

constexpr std::size_t kWidth = 80;
constexpr std::size_t kTextColumn = 19;

std::size_t count(const std::vector<HealthCheck>& checks, const std::string& state) {
  return static_cast<std::size_t>(std::ranges::count(checks, state, &HealthCheck::state));
}

std::string summary(const std::vector<HealthCheck>& checks) {
  const std::size_t broken = count(checks, kBroken);
  const std::size_t missing = count(checks, kMissing);
  if (broken > 0) return fmt::format("{} of {} broken", broken, checks.size());
  if (missing == 0) return "all works";
  return fmt::format("all that is there works; {} of {} missing, which are optional", missing,
                     checks.size());
}

void print_checks(const std::vector<HealthCheck>& checks) {
  const std::string indent(kTextColumn, ' ');
  for (const HealthCheck& check : checks) {
    const std::vector<std::string> lines = wrapped(one_line(check.found), kWidth - kTextColumn);
    fmt::print("{:<10}{:<9}{}\n", check.what, check.state, lines.front());
    for (std::size_t i = 1; i < lines.size(); ++i) fmt::print("{}{}\n", indent, lines[i]);
    if (check.install.empty()) continue;
    for (const std::string& line : wrapped(check.install, kWidth - kTextColumn - 2)) {
      fmt::print("{}> {}\n", indent, line);
    }
  }
  fmt::print("\n{}\n", summary(checks));
}

}  // namespace

int doctor_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const std::string program = own_program_name() + " doctor";
  return guarded(program, [&] {
    CLI::App app("check this machine and name the packages to install", program);
    app.footer(
        "missing: an optional part is not installed; everything else works.\n"
        "broken: a part does not work, or a necessary part is not installed.\n"
        "Exit status: 0 nothing is broken, 1 something is, 2 usage.");
    if (const auto status = parse(app, argc, argv)) return *status;
    const std::vector<HealthCheck> checks = check_health(catalogue);
    print_checks(checks);
    return static_cast<int>(count(checks, kBroken) == 0 ? kSuccess : kDefect);
  });
}

}  // namespace breakwater
