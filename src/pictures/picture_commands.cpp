#include <breakwater/pictures/picture_commands.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>

#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/render/frame_farm.h>
#include <breakwater/render/picture.h>
#include <breakwater/render/render_error.h>
#include <breakwater/render/video_file.h>
#include <breakwater/scenario/child_program.h>
#include <breakwater/scenario/process.h>
#include <breakwater/scenario/progress.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostRuns = 4;
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

struct Size {
  int width;
  int height;
};

// "1280x720".
Size read_size(const std::string& text, const Size& otherwise) {
  if (text.empty()) return otherwise;
  Size size{};
  const char* const end = text.data() + text.size();
  const auto [middle, first] = std::from_chars(text.data(), end, size.width);
  const bool has_x = first != std::errc::invalid_argument && middle != end && *middle == 'x';
  const auto [last, second] = std::from_chars(has_x ? middle + 1 : end, end, size.height);
  if (!has_x || second == std::errc::invalid_argument || last != end) {
    throw std::invalid_argument("--size " + text + ": must be of the form 1280x720");
  }
  for (const int side : {size.width, size.height}) {
    if (side < kSmallestSide || side > kLargestSide || side % 2 != 0) {
      throw std::invalid_argument(fmt::format("--size {}: sides must be even, from {} to {}", text,
                                              kSmallestSide, kLargestSide));
    }
  }
  return size;
}

Look read_look(const std::string& text, const Look& otherwise) {
  if (text.empty()) return otherwise;
  if (text == "fast") return kFastLook;
  if (text == "full") return kFullLook;
  if (text == "print") return kPrintLook;
  throw std::invalid_argument("--look " + text + ": must be fast, full or print");
}

std::deque<FinishedRun> open_runs(const Catalogue& catalogue,
                                  const std::vector<std::string>& folders) {
  if (folders.size() > kMostRuns) {
    throw std::invalid_argument(
        fmt::format("{} runs: side by side there is room for {}", folders.size(), kMostRuns));
  }
  std::deque<FinishedRun> runs;
  for (const std::string& folder : folders) {
    runs.emplace_back(catalogue, folder);
    const std::string& first = runs.front().scenario().name();
    if (runs.back().scenario().name() != first) {
      throw std::invalid_argument(fmt::format("{}: is a run of {}, beside one of {}: {}", folder,
                                              runs.back().scenario().name(), first,
                                              "only runs of one scenario stand side by side"));
    }
  }
  return runs;
}

// Everything that pictures of these runs are drawn from.
struct Stage {
  ShotList shots;
  std::vector<PictureRun> runs;
  PictureStyle style;
};

Stage set_stage(const std::deque<FinishedRun>& runs, const ShotList& shots,
                const PictureArguments& arguments, const Window& window) {
  Stage stage{shots, {}, {}};
  std::vector<ChartLine> lines;
  for (const FinishedRun& run : runs) {
    std::vector<std::string> missing;
    stage.runs.push_back(breakwater::stage(run, shots, arguments.camera, &missing));
    for (const std::string& note : run.notes()) fmt::print(stderr, "pictures: {}\n", note);
    for (const std::string& signal : missing) {
      fmt::print(stderr, "pictures: {}: its log has no signal {}, which the shot list names\n",
                 run.folder().string(), signal);
    }
    const auto& own = stage.runs.back().lines;
    lines.insert(lines.end(), own.begin(), own.end());
  }
  stage.style.title = shots.title;
  stage.style.chart_title = shots.chart_title;
  stage.style.chart_right =
      shots.chart_corner == Corner::top_right || shots.chart_corner == Corner::bottom_right;
  stage.style.chart_bottom =
      shots.chart_corner == Corner::bottom_left || shots.chart_corner == Corner::bottom_right;
  stage.style.chart_range = chart_range(lines, window.from_s, window.to_s);
  stage.style.speed = window.speed;
  return stage;
}

void warn_if_slow(const Offscreen& offscreen) {
  if (offscreen.is_fast()) return;
  fmt::print(stderr, "pictures: OpenGL is drawn by {}, not by llvmpipe, which is 15 times faster\n",
             offscreen.renderer());
}

void report(const PictureArguments& arguments, const std::string& what, const fs::path& file) {
  if (!arguments.quiet) fmt::print("{}: {}\n", what, file.string());
}

int video(const Catalogue& catalogue, const PictureArguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  const std::deque<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const ShotList shots = shot_list(runs.front().shots_file());
  const Window window = choose_window(runs, shots, arguments.wish);
  const int fps = arguments.fps.value_or(shots.fps);
  const std::size_t frames = window.frames(fps);
  Stage stage = set_stage(runs, shots, arguments, window);
  const Size size = read_size(arguments.size, {shots.width, shots.height});
  stage.style.width = size.width;
  stage.style.height = size.height;
  stage.style.look = read_look(arguments.look, kFullLook);
  stage.style.time_decimals = window.speed / fps < 0.01 ? 3 : 2;
  const fs::path file =
      arguments.out.empty() ? runs.front().folder() / "video.mp4" : fs::path(arguments.out);

  stop_on_signals();
  VideoFile output(file, {.width = size.width, .height = size.height, .fps = fps});
  Progress progress("video", 1, arguments.quiet);
  FrameFarm farm;
  farm.frames = frames;
  farm.frame_bytes = yuv420p_bytes(size.width, size.height);
  farm.processes = std::max(1U, std::thread::hardware_concurrency());
  farm.stop = &interrupted();
  farm.progress = [&](double done) { progress.update(0, done); };
  const auto start = [&](std::size_t process) -> DrawFrame {
    const auto picture = std::make_shared<Picture>(stage.runs, stage.style);
    const auto converter = std::make_shared<ColourConverter>(size.width, size.height);
    if (process == 0) warn_if_slow(picture->offscreen());
    return [picture, converter, &window, fps](std::size_t number, std::uint8_t* frame) {
      converter->convert(picture->draw(window.time_of(number, fps)), frame);
    };
  };
  draw_frames(farm, start, [&](const std::uint8_t* frame) { output.append(frame); });
  output.finish();
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  report(
      arguments,
      fmt::format("video, {} frames of {}x{} in {:.1f} s", frames, size.width, size.height, wall_s),
      file);
  return kSuccess;
}

int still(const Catalogue& catalogue, const PictureArguments& arguments) {
  const std::deque<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const ShotList shots = shot_list(runs.front().shots_file());
  Window window = choose_window(runs, shots, {});
  const Window all = whole_window(runs);
  if (!(arguments.at_s >= all.from_s && arguments.at_s <= all.to_s)) {
    throw std::invalid_argument(fmt::format("--at {:g}: the log lasts from {:g} s to {:g} s",
                                            arguments.at_s, all.from_s, all.to_s));
  }
  if (arguments.at_s < window.from_s || arguments.at_s > window.to_s) window = all;
  Stage stage = set_stage(runs, shots, arguments, window);
  const Size size = read_size(arguments.size, {shots.width, shots.height});
  stage.style.width = size.width;
  stage.style.height = size.height;
  stage.style.look = read_look(arguments.look, kPrintLook);
  stage.style.speed = 1.0;  // nothing moves
  const fs::path file =
      arguments.out.empty() ? runs.front().folder() / "still.png" : fs::path(arguments.out);

  Picture picture(stage.runs, stage.style);
  warn_if_slow(picture.offscreen());
  Canvas canvas(size.width, size.height);
  std::copy_n(picture.draw(arguments.at_s), 4 * size.width * size.height, canvas.pixels());
  replace_file(file, canvas.png());
  report(arguments, "still", file);
  return kSuccess;
}

struct Moment {
  std::string caption;
  double time_s;
};

std::vector<Moment> moments_of(const FinishedRun& run, const ShotList& shots) {
  std::vector<Moment> moments;
  for (const ShotMoment& moment : shots.moments) {
    if (const auto time_s = time_of(moment, run)) moments.push_back({moment.caption, *time_s});
  }
  if (moments.empty()) {
    throw std::invalid_argument(run.folder().string() +
                                ": none of the shot list's moments is in this run's log");
  }
  return moments;
}

// Pictures in a row, each with a letter, its caption and time below, and one chart of all for the
// whole width, with the moments marked.
int strip(const Catalogue& catalogue, const PictureArguments& arguments) {
  constexpr Colour kInk{0.10, 0.12, 0.15, 1.0};
  constexpr int kGap = 12;
  const std::deque<FinishedRun> runs = open_runs(catalogue, arguments.runs);
  const FinishedRun& run = runs.front();
  const ShotList shots = shot_list(run.shots_file());
  const std::vector<Moment> moments = moments_of(run, shots);
  Window window = choose_window(runs, shots, {});
  Stage stage = set_stage(runs, shots, arguments, window);
  const std::vector<ChartLine> lines = std::exchange(stage.runs.front().lines, {});
  const Size size = read_size(arguments.size, {560, 320});
  stage.style.width = size.width;
  stage.style.height = size.height;
  stage.style.look = read_look(arguments.look, kPrintLook);
  stage.style.title.clear();
  stage.style.captions = false;
  const fs::path file =
      arguments.out.empty() ? run.folder() / "strip.png" : fs::path(arguments.out);

  const auto count = static_cast<int>(moments.size());
  const double unit = Picture::unit_px(size.width, size.height);
  const double text = 19.0 * unit;
  const int caption = static_cast<int>(std::lround(3.0 * text));
  const int chart_height = lines.empty() ? 0 : static_cast<int>(std::lround(240.0 * unit));
  const int width = count * size.width + (count - 1) * kGap;
  Canvas page(width, size.height + caption + chart_height);
  Picture picture(stage.runs, stage.style);
  warn_if_slow(picture.offscreen());
  Canvas panel(size.width, size.height);
  for (int i = 0; i < count; ++i) {
    const Moment& moment = moments[static_cast<std::size_t>(i)];
    std::copy_n(picture.draw(moment.time_s), 4 * size.width * size.height, panel.pixels());
    const int left = i * (size.width + kGap);
    page.paste(panel, left, 0);
    const std::string letter(1, static_cast<char>('a' + i));
    page.text({left + 0.5 * size.width, size.height + 1.3 * text},
              fmt::format("({}) {}", letter, moment.caption), text, kInk, Align::center, true);
    page.text({left + 0.5 * size.width, size.height + 2.5 * text},
              fmt::format("t = {:.3f} s", moment.time_s), text, kInk, Align::center);
  }
  if (!lines.empty()) {
    Chart chart(shots.chart_title + "   " + run.case_name(), lines, stage.style.chart_range, width,
                chart_height, unit);
    for (int i = 0; i < count; ++i) {
      const double time_s = moments[static_cast<std::size_t>(i)].time_s;
      if (time_s >= window.from_s && time_s <= window.to_s) {
        chart.mark(time_s, std::string(1, static_cast<char>('a' + i)));
      }
    }
    chart.draw(page, 0, size.height + caption, window.to_s);
  }
  replace_file(file, page.png());
  report(arguments, fmt::format("strip of {}", count), file);
  return kSuccess;
}

void describe_common(CLI::App& app, PictureArguments& arguments, const char* size,
                     const char* look) {
  app.add_option("--camera", arguments.camera, "a camera of the model (default: the shot list's)")
      ->type_name("NAME");
  app.add_option("--size", arguments.size, size)->type_name("WxH");
  app.add_option("--look", arguments.look, look)->type_name("LOOK");
  app.add_flag("--quiet", arguments.quiet, "print errors only");
}

void describe_video(CLI::App& app, PictureArguments& arguments) {
  app.add_option("RUN", arguments.runs, "folders of finished runs, up to 4, side by side")
      ->required();
  describe_common(app, arguments, "of the whole picture (default: the shot list's)",
                  "fast: without shadows; full (default); print: as smooth as can be");
  app.add_option("--fps", arguments.fps, "frames a second (default: the shot list's)")
      ->type_name("N")
      ->check(CLI::Range(1, 240));
  app.add_option("--speed", arguments.wish.speed, "0.1: ten times slower than life")
      ->type_name("X")
      ->check([](const std::string& text) {
        return std::strtod(text.c_str(), nullptr) > 0.0 ? std::string() : text + " is not positive";
      });
  app.add_option("--from", arguments.wish.from_s, "simulated time to begin with")->type_name("S");
  app.add_option("--to", arguments.wish.to_s, "simulated time to end with")->type_name("S");
  app.add_option("--out", arguments.out, "the file (default: RUN/video.mp4)")->type_name("FILE");
}

void describe_still(CLI::App& app, PictureArguments& arguments) {
  app.add_option("RUN", arguments.runs, "folders of finished runs, up to 4, side by side")
      ->required();
  app.add_option("--at", arguments.at_s, "simulated time")->type_name("S")->required();
  describe_common(app, arguments, "of the picture (default: the shot list's)",
                  "fast, full, or print (default)");
  app.add_option("--out", arguments.out, "the file (default: RUN/still.png)")->type_name("FILE");
}

void describe_strip(CLI::App& app, PictureArguments& arguments) {
  app.add_option("RUN", arguments.runs, "the folder of a finished run")->required()->expected(1);
  describe_common(app, arguments, "of each of its pictures (default: 560x320)",
                  "fast, full, or print (default)");
  app.add_option("--out", arguments.out, "the file (default: RUN/strip.png)")->type_name("FILE");
}

struct Command {
  const char* name;
  const char* summary;
  void (*describe)(CLI::App&, PictureArguments&);
  int (*execute)(const Catalogue&, const PictureArguments&);
};

constexpr Command kCommands[] = {
    {"video", "make a video of a finished run, or of up to four side by side", describe_video,
     video},
    {"still", "make a picture of a finished run at one time", describe_still, still},
    {"strip", "make the shot list's pictures of a finished run, in a row", describe_strip, strip}};

const Command* find_command(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kCommands), std::end(kCommands),
                                         [&](const Command& c) { return c.name == name; });
  return found != std::end(kCommands) ? found : nullptr;
}

// A picture that fails leaves its run whole: a status of its own.
int draw(const Command& command, const Catalogue& catalogue, const PictureArguments& arguments) {
  try {
    return command.execute(catalogue, arguments);
  } catch (const RenderError& error) {
    fmt::print(stderr, "{}\n", error.what());
  } catch (const OutputError& error) {
    fmt::print(stderr, "{}\n", error.what());
  } catch (const Stopped&) {
    throw Interrupted();
  }
  return kLaterOutputFailed;
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& picture_commands() {
  static const std::vector<std::pair<std::string, std::string>> all = [] {
    std::vector<std::pair<std::string, std::string>> list;
    for (const Command& command : kCommands) list.emplace_back(command.name, command.summary);
    return list;
  }();
  return all;
}

bool is_picture_command(const std::string& name) {
  return find_command(name) != nullptr;
}

int picture_main(const Catalogue& catalogue, int argc, const char* const* argv) {
  const Command& command = *find_command(argv[0]);
  const std::string program = own_program_name() + " " + command.name;
  return guarded(program, [&] {
    CLI::App app(command.summary, program);
    app.footer(
        "It is drawn from the run's log, as the scenario's shots.toml says.\n"
        "Exit status: 0 success, 1 a defect, 2 usage or input, 4 it could not be drawn or\n"
        "written, 130 interrupted.");
    PictureArguments arguments;
    command.describe(app, arguments);
    if (const auto status = parse(app, argc, argv)) return *status;
    return draw(command, catalogue, arguments);
  });
}

}  // namespace breakwater
