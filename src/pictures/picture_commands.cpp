#include <breakwater/pictures/picture_commands.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>
#include <thread>

#include <breakwater/config/toml_text.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/render/frame_farm.h>
#include <breakwater/render/picture.h>
#include <breakwater/render/render_error.h>
#include <breakwater/render/video_file.h>
#include <breakwater/shell/child_program.h>
#include <breakwater/shell/process.h>
#include <breakwater/shell/progress.h>
#include <breakwater/sim/engine_guard.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr int kSmallestSide = 64;
constexpr int kLargestSide = 7680;

struct PictureArguments {
  std::vector<std::string> runs;
  std::string camera;
  std::string size;
  std::string look;
  std::string out;
  std::optional<int> fps;
  Wish wish;
  double at_s = 0.0;
  bool quiet = false;
};

// The size and the look of a picture as the user asks.
void set_look(const PictureArguments& arguments, PictureStyle& style) {
  const std::string& size = arguments.size;
  static const std::regex form("(\\d{1,99})x(\\d{1,99})");
  std::smatch sides;
  if (!size.empty() && !std::regex_match(size, sides, form)) {
    throw std::invalid_argument("--size " + size + ": must be of the form 1280x720");
  }
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const double side = std::stod(sides[i]);
    if (side < kSmallestSide || side > kLargestSide || std::fmod(side, 2.0) != 0.0) {
      throw std::invalid_argument(fmt::format("--size {}: sides must be even, from {} to {}", size,
                                              kSmallestSide, kLargestSide));
    }
    (i == 1 ? style.width : style.height) = static_cast<int>(side);
  }
  const std::map<std::string, Look> looks = {
      {"", style.look}, {"fast", kFastLook}, {"full", kFullLook}, {"print", kPrintLook}};
  const auto look = looks.find(arguments.look);
  if (look == looks.end()) {
    throw std::invalid_argument("--look " + arguments.look + ": must be fast, full or print");
  }
  style.look = look->second;
}

PictureStage set_stage(ShownRuns runs, const ShotList& shots, const PictureArguments& arguments,
                       const Window& window, const Look& look) {
  PictureStage stage = stage_pictures(runs, shots, arguments.camera, window);
  stage.style.look = look;
  set_look(arguments, stage.style);
  for (const std::string& note : stage.notes) fmt::print(stderr, "pictures: {}\n", note);
  return stage;
}

// The place of a picture or video. The name of a picture must end with .png. That of a video must
// not end with another format.
fs::path picture_file(const PictureArguments& arguments, const fs::path& otherwise) {
  if (arguments.out.empty()) return otherwise;
  fs::path file = arguments.out;
  std::string end = file.extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool is_video = otherwise.extension() == ".mp4";
  if (end != otherwise.extension() && !(is_video && end.empty())) {
    throw std::invalid_argument(fmt::format(
        "--out {}: {}: choose a name that ends with {}", arguments.out,
        is_video ? "a video is MP4" : "pictures are PNG", otherwise.extension().string()));
  }
  return file;
}

int video(const Catalogue& catalogue, const PictureArguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const ShotList shots = shot_list(runs.front().shots_file());
  const Window window = choose_window(runs, shots, arguments.wish);
  const int fps = arguments.fps.value_or(shots.fps);
  const std::size_t frames = window.frames(fps);
  PictureStage stage = set_stage(runs, shots, arguments, window, kFullLook);
  const int width = stage.style.width, height = stage.style.height;
  stage.style.time_decimals = window.speed / fps < 0.01 ? 3 : 2;
  const fs::path file = picture_file(arguments, runs.front().folder() / "video.mp4");

  stop_on_signals();
  VideoFile output(file, {.width = width, .height = height, .fps = fps});
  Progress progress("video", {1.0}, arguments.quiet);
  FrameFarm farm;
  farm.frames = frames;
  farm.processes = std::max(1U, std::thread::hardware_concurrency());
  farm.stop = &interrupted();
  farm.progress = [&](double done) { progress.update(0, done); };
  const auto start = [&](std::size_t /*process*/) -> Drawer {
    const auto picture = std::make_shared<Picture>(stage.runs, stage.style);
    return {[picture, &window, fps](std::size_t number) {
              return picture->draw(window.time_of(number, fps));
            },
            picture->offscreen().renderer()};
  };
  std::string renderer;
  try {
    renderer = draw_frames(farm, start, [&](const std::uint8_t* frame) { output.append(frame); });
  } catch (const OutputError&) {
    output.end();
    throw;
  }
  output.finish();
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!arguments.quiet) {
    fmt::print("video, {} frame{} of {}x{} in {:.1f} s by {}: {}\n", frames, frames == 1 ? "" : "s",
               width, height, wall_s, renderer, file.string());
  }
  return kSuccess;
}

int still(const Catalogue& catalogue, const PictureArguments& arguments) {
  const std::vector<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const ShotList shots = shot_list(runs.front().shots_file());
  Window window = choose_window(runs, shots, {});
  const Window all = whole_window(runs);
  if (!(arguments.at_s >= all.from_s && arguments.at_s <= all.to_s)) {
    throw std::invalid_argument(fmt::format("--at {:g}: the log lasts from {:g} s to {:g} s",
                                            arguments.at_s, all.from_s, all.to_s));
  }
  if (arguments.at_s < window.from_s || arguments.at_s > window.to_s) window = all;
  PictureStage stage = set_stage(runs, shots, arguments, window, kPrintLook);
  stage.style.speed = 1.0;  // a still has no speed
  const fs::path file = picture_file(arguments, runs.front().folder() / "still.png");

  Picture picture(stage.runs, stage.style);
  Canvas canvas(stage.style.width, stage.style.height);
  std::copy_n(picture.draw(arguments.at_s), 4 * canvas.width() * canvas.height(), canvas.pixels());
  replace_file(file, canvas.png());
  if (!arguments.quiet) fmt::print("still: {}\n", file.string());
  return kSuccess;
}

int strip(const Catalogue& catalogue, const PictureArguments& arguments) {
  const std::vector<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const FinishedRun& run = runs.front();
  PictureStyle style{.width = 560, .height = 320, .look = kPrintLook};
  set_look(arguments, style);
  const fs::path file = picture_file(arguments, run.folder() / "strip.png");
  const ShotList shots = shot_list(run.shots_file());
  std::vector<std::string> notes;
  const std::vector<Moment> moments = moments_of(run, shots, &notes);
  if (moments.empty()) {
    throw std::invalid_argument(run.folder().string() +
                                (shots.moments.empty()
                                     ? ": its scenario has no shot list with moments (shots.toml)"
                                     : ": none of the shot list's moments is in this run's log"));
  }
  const std::string png = draw_strip(run, shots, moments, arguments.camera, style, &notes);
  for (const std::string& note : notes) fmt::print(stderr, "pictures: {}\n", note);
  replace_file(file, png);
  if (!arguments.quiet) fmt::print("strip of {}: {}\n", moments.size(), file.string());
  return kSuccess;
}

struct Command {
  const char* name;
  const char* summary;
  const char* size;
  const char* look;
  int (*execute)(const Catalogue&, const PictureArguments&);
};

constexpr const char* kPrintLooks = "choose fast, full or print (default)";
constexpr Command kCommands[] = {
    {"video", "make a video of a finished run, or of up to four side by side",
     "set the size of the whole picture (default: the shot list's)",
     "choose fast (without shadows), full (default) or print (smoothest)", video},
    {"still", "make a picture of a finished run at one time",
     "set the size of the picture (default: the shot list's)", kPrintLooks, still},
    {"strip", "make the shot list's pictures of a finished run, in a row",
     "set the size of each of its pictures (default: 560x320)", kPrintLooks, strip}};

void describe(const Command& command, CLI::App& app, PictureArguments& arguments) {
  const bool is_video = command.execute == video, is_strip = command.execute == strip;
  auto* const runs = app.add_option("RUN", arguments.runs,
                                    is_strip ? "draw the run of this folder"
                                             : "show these finished runs, up to 4, side by side")
                         ->required();
  if (is_strip) runs->expected(1);
  if (!is_video && !is_strip) {
    app.add_option("--at", arguments.at_s, "draw this simulated time")->type_name("S")->required();
  }
  app.add_option("--camera", arguments.camera,
                 "use this camera of the model (default: the shot list's)")
      ->type_name("NAME");
  app.add_option("--size", arguments.size, command.size)->type_name("WxH");
  app.add_option("--look", arguments.look, command.look)->type_name("LOOK");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
  if (is_video) {
    app.add_option("--fps", arguments.fps, "set the frames per second (default: the shot list's)")
        ->type_name("N")
        ->check(CLI::Range(1, 240));
    app.add_option("--speed", arguments.wish.speed,
                   "set the speed: 0.1 is ten times slower than real time")
        ->type_name("X")
        ->check(must_be_positive);
    app.add_option("--from", arguments.wish.from_s, "begin at this simulated time")->type_name("S");
    app.add_option("--to", arguments.wish.to_s, "end at this simulated time")->type_name("S");
  }
  app.add_option("--out", arguments.out,
                 fmt::format("write this file (default: RUN/{}.{})", command.name,
                             is_video ? "mp4" : "png"))
      ->type_name("FILE");
}

int picture_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const Command& command = *std::ranges::find(kCommands, std::string(argv[0]), &Command::name);
  const std::string program = own_program_name() + " " + command.name;
  return guarded(program, [&] {
    CLI::App app(command.summary, program);
    app.footer(
        "The program draws it from the run's log and the scenario's shots.toml.\n"
        "Exit status: 0 success, 1 a defect, 2 usage or input, 4 it could not be drawn or\n"
        "written, 130 interrupted.");
    PictureArguments arguments;
    describe(command, app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;
    opengl_asked();  // refuse wrong environment variables at once
    return drawing_status([&] { return command.execute(catalogue, arguments); });
  });
}

}  // namespace

int drawing_status(const std::function<int()>& draw) {
  try {
    return draw();
  } catch (const RenderError& error) {
    fmt::print(stderr, "{}\n", error.what());
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", error.what());
  }
  return kLaterOutputFailed;
}

std::vector<CommandKind> picture_commands() {
  std::vector<CommandKind> all;
  for (const Command& command : kCommands)
    all.push_back({command.name, command.summary, picture_main});
  return all;
}

}  // namespace breakwater
