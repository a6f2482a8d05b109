// Repeats one work in one process, for soak.py. After each hundredth part it prints the number of
// repetitions so far, and waits for a line: samples come from between two repetitions.
//
// Usage: soak_work runs|frames|replays|leak COUNT FOLDER [RUN_FOLDER]
// Files are written into FOLDER. RUN_FOLDER is a finished run, for frames and replays. The work
// `leak` is `runs` with 10 kB lost in each run and a descriptor in each hundredth part.
#include <fcntl.h>
#include <malloc.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>

#include <breakwater/experiment/runner.h>
#include <breakwater/pages/replay_part.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/program/program.h>
#include <breakwater/render/picture.h>
#include <breakwater/render/video_file.h>

using namespace breakwater;

namespace {

using Work = std::function<void(long k)>;

constexpr int kWidth = 160, kHeight = 120, kFps = 30;
constexpr long kReports = 100;

void repeat(long count, const Work& work) {
  const long part = std::max(1L, count / kReports);
  for (long k = 0; k < count; ++k) {
    work(k);
    if ((k + 1) % part != 0) continue;
    malloc_trim(0);  // the allocator keeps a varying amount of free memory
    std::printf("%ld\n", k + 1);
    std::fflush(stdout);
    std::getchar();
  }
}

// Whole runs with all their files, each with another seed. Each replaces the one before.
void run(const Catalogue& catalogue, const std::string& folder, long k) {
  const std::string scenario = "motor_estimation";
  const ScenarioFile file(catalogue.get<ScenarioKind>(scenario).file().string(), scenario);
  std::vector<PreparedRun> runs;
  runs.push_back(prepare_run(catalogue, scenario, file, "stf",
                             {"run.duration_s=0.01", "run.seed=" + std::to_string(k + 1)}));
  execute_runs(runs, {folder + "/run"}, {.quiet = true});
}

// One video of `count` frames.
void draw(const Catalogue& catalogue, const std::string& folder, const std::string& run_folder,
          long count) {
  const std::vector<FinishedRun> runs = open_runs(catalogue, {run_folder});
  const ShotList shots = shot_list(runs.front().shots_file());
  const Window window = choose_window(runs, shots, {});
  PictureStage stage = stage_pictures(runs, shots, "", window);
  stage.style.width = kWidth;
  stage.style.height = kHeight;
  Picture picture(stage.runs, stage.style);
  VideoFile video(folder + "/video.mp4", {.width = kWidth, .height = kHeight, .fps = kFps});
  repeat(count, [&](long k) {
    const double part = static_cast<double>(k) / static_cast<double>(count);
    video.append(picture.draw(window.from_s + part * (window.to_s - window.from_s)));
  });
  video.finish();
}

void replay(const Catalogue& catalogue, const std::string& run_folder) {
  std::vector<std::string> notes;
  if (replay_page(open_runs(catalogue, {run_folder}), "", notes).empty()) std::abort();
}

void leak() {
  constexpr std::size_t kBytes = 10'000;
  void* volatile lost = std::malloc(kBytes);
  std::memset(lost, 1, kBytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4 || argc > 5) {
    std::fputs("usage: soak_work runs|frames|replays|leak COUNT FOLDER [RUN_FOLDER]\n", stderr);
    return 2;
  }
  try {
    const Catalogue catalogue = standard_catalogue();
    const std::string what = argv[1], folder = argv[3], run_folder = argc == 5 ? argv[4] : "";
    const long count = std::atol(argv[2]);
    if (what == "frames") {
      draw(catalogue, folder, run_folder, count);
    } else if (what == "replays") {
      repeat(count, [&](long) { replay(catalogue, run_folder); });
    } else {
      const bool leaks = what == "leak";
      repeat(count, [&](long k) {
        run(catalogue, folder, k);
        if (leaks) leak();
        if (leaks && k % std::max(1L, count / kReports) == 0) open("/dev/null", O_RDONLY);
      });
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
