// A bare mjr_render loop over the frames of `breakwater video`: the same scene, size and look on
// one core. Smooth edges, captions, chart, colours and encoding are left out. Their cost is that of
// Breakwater.
//
// Usage: bare_render RUN_FOLDER fast|full FRAMES
#include <cstdio>
#include <cstdlib>
#include <string>

#include <breakwater/pictures/staging.h>
#include <breakwater/program/program.h>
#include <breakwater/render/offscreen.h>
#include <breakwater/render/scene_view.h>

using namespace breakwater;

namespace {

void render(char** argv) {
  setenv("LP_NUM_THREADS", "0", 1);
  std::deque<FinishedRun> runs;
  runs.emplace_back(standard_catalogue(), argv[1]);
  const ShotList shots = shot_list(runs.front().shots_file());
  const Window window = choose_window(pointers_to(runs), shots, {});
  const long frames = std::strtol(argv[3], nullptr, 10);
  PictureRun run = stage(runs.front(), shots, "");

  Offscreen offscreen(shots.width, shots.height);
  SceneView view(offscreen, run.model, run.camera,
                 std::string(argv[2]) == "fast" ? kFastLook : kFullLook);
  const auto rows = static_cast<double>(run.qpos.rows - 1);
  const double per_s = rows / (run.times_s.back() - run.times_s.front());
  for (long k = 0; k < frames; ++k) {
    const double part = static_cast<double>(k) / static_cast<double>(frames);
    const double time_s = window.from_s + part * (window.to_s - window.from_s);
    const auto row = static_cast<std::size_t>((time_s - run.times_s.front()) * per_s);
    run.animate(run.model, time_s);
    view.pose({run.qpos.row(row), run.qpos.width});
    std::vector<SceneArrow> arrows;
    for (const ArrowTrack& track : run.arrows) arrows.push_back(arrow_at(track, time_s).arrow);
    view.draw({0, 0, shots.width, shots.height}, arrows);
    offscreen.finish();
  }
  std::printf("frames %ld, %s\n", frames, offscreen.renderer().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: bare_render RUN_FOLDER fast|full FRAMES\n", stderr);
    return 2;
  }
  try {
    render(argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
