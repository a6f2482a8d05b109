#include <breakwater/pictures/replay_data.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>

#include <breakwater/render/scene_description.h>

namespace breakwater {
namespace {

constexpr double kFramesPerSecond = 30.0;
constexpr std::size_t kMostFrames = 40000;

// A checksum of properties that a page cannot change: it differs if one of them does.
double looks_of(const Model& model) {
  double sum = 0.0;
  for (int i = 0; i < 3 * model->ngeom; ++i) sum += (i + 1) * model->geom_pos[i];
  for (int i = 0; i < 4 * model->ngeom; ++i) {
    sum += (i + 3) * model->geom_quat[i] + (i + 7) * static_cast<double>(model->geom_rgba[i]);
  }
  return sum;
}

using Json = nlohmann::ordered_json;

// Poses over time, one for each frame.
using PoseTrack = std::vector<Pose>;

struct ReplayMotion {
  std::vector<PoseTrack> bodies, cameras, lights;  // all of the model
  std::vector<std::vector<bool>> visible;          // each geom, in each frame
  // Whether something else changed in the pictures: a colour, or the place of a geom on its body.
  bool is_incomplete = false;
};

// The poses of the run's scene at these times, from its log. Throws RenderError.
ReplayMotion replay_motion(PictureRun& run, const std::vector<double>& times_s) {
  Model& model = run.model;
  ScenePoser poser(model);
  ReplayMotion motion;
  motion.bodies.resize(static_cast<std::size_t>(model->nbody));
  motion.cameras.resize(static_cast<std::size_t>(model->ncam));
  motion.lights.resize(static_cast<std::size_t>(model->nlight));
  motion.visible.resize(static_cast<std::size_t>(model->ngeom));
  std::vector<double> qpos;
  double looks = 0.0;
  const auto add = [](auto& tracks, auto&& now) {
    for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].push_back(now(static_cast<int>(i)));
  };
  for (std::size_t frame = 0; frame < times_s.size(); ++frame) {
    interpolate_qpos(run, times_s[frame], qpos);
    if (run.animate) run.animate(model, times_s[frame]);
    if (frame == 0) looks = looks_of(model);
    motion.is_incomplete = motion.is_incomplete || looks_of(model) != looks;
    poser.pose(qpos);
    add(motion.bodies, [&](int i) { return poser.body(i); });
    add(motion.cameras, [&](int i) { return poser.camera(i); });
    add(motion.lights, [&](int i) { return poser.light(i); });
    add(motion.visible, [&](int i) { return is_drawn(model, i); });
  }
  return motion;
}

// Collects the channels of a run: numbers of 32 bits, one for each frame.
class Channels {
 public:
  // A constant track is written as its seven numbers. Any other is written as the index of its
  // first channel.
  Json track(PoseTrack track) {
    if (std::ranges::count(track, track.front()) == std::ssize(track)) {
      return {{"pose", rounded_list(track.front())}};
    }
    // q and −q are the same rotation: choose the one nearer to the last.
    for (std::size_t i = 1; i < track.size(); ++i) {
      const auto q = track[i].begin() + 3;
      const bool turns = std::inner_product(q, track[i].end(), track[i - 1].begin() + 3, 0.0) < 0.0;
      if (turns) std::transform(q, track[i].end(), q, std::negate<>());
    }
    Json place = {{"channel", count_}};
    for (std::size_t k = 0; k < 7; ++k) add(track, [k](const Pose& pose) { return pose[k]; });
    return place;
  }

  // Appends a channel with a value of each one. A value that is not finite repeats the one before.
  // Returns its index.
  template <typename Range, typename ValueOf>
  int add(const Range& range, const ValueOf& value_of) {
    float last = 0.0F;
    for (const auto& one : range) {
      const auto now = static_cast<float>(value_of(one));
      if (std::isfinite(now)) last = now;
      numbers_.push_back(last);
    }
    return count_++;
  }

  int count() const { return count_; }
  // The first bytes of all numbers, then the second ones, and so on: neighbours are alike, so this
  // packs to less than half.
  std::string packed() const {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(numbers_.data());
    std::vector<std::uint8_t> planes;
    planes.reserve(sizeof(float) * numbers_.size());
    for (std::size_t k = 0; k < sizeof(float); ++k) {
      for (std::size_t i = 0; i < numbers_.size(); ++i) {
        planes.push_back(bytes[sizeof(float) * i + k]);
      }
    }
    return packed_bytes(planes);
  }

 private:
  int count_ = 0;
  std::vector<float> numbers_;
};

Json arrow_json(const ArrowTrack& track, const Model& model, const std::vector<double>& times_s,
                Channels& channels) {
  const int site = track.arrow.site;
  const Pose pose = pose_of(model->site_pos + std::ptrdiff_t{3} * site,
                            model->site_quat + std::ptrdiff_t{4} * site);
  Json components = Json::array();
  for (const Series& series : track.components) {
    components.push_back(
        channels.add(times_s, [&](double time_s) { return series.at(time_s).value; }));
  }
  const Colour& colour = track.arrow.colour;
  return {{"unit", track.unit},
          {"body", model->site_bodyid[site]},
          {"site", rounded_list(pose)},
          {"offset", rounded_list(track.arrow.offset_m)},
          {"along", rounded_list(track.along)},
          {"inSite", track.arrow.in_site_frame},
          {"scale", rounded(track.metres_per_unit)},
          {"mark", rounded(track.arrow.contact_mark_m)},
          {"colour", rounded_list(std::array{colour.red, colour.green, colour.blue})},
          {"values", components}};
}

Json surfaces_json(const std::vector<WavingSurface>& surfaces) {
  Json all = Json::array();
  for (const WavingSurface& surface : surfaces) {
    Json waves = Json::array();
    for (const auto& wave : surface.sea.plane_waves()) waves.push_back(rounded_list(wave));
    all.push_back({{"geom", surface.geom}, {"waves", waves}});
  }
  return all;
}

Json tracks_json(const std::vector<PoseTrack>& tracks, Channels& channels) {
  Json all = Json::array();
  for (const PoseTrack& track : tracks) all.push_back(channels.track(track));
  return all;
}

Json run_json(const std::string& folder, PictureRun& staged, const Window& window,
              SceneAssets& assets, std::vector<std::string>& notes) {
  const std::vector<double> times_s = replay_times(staged.times_s, window);
  const ReplayMotion motion = replay_motion(staged, times_s);
  if (const int skipped = staged.model->nskin + staged.model->ntendon; skipped > 0) {
    notes.push_back(
        fmt::format("{}: {} skins and tendons of its model are not shown", folder, skipped));
  }
  if (motion.is_incomplete) {
    notes.push_back(folder +
                    ": its pictures change colours or places of geoms, but the page shows "
                    "only the last ones");
  }
  Channels channels;
  std::vector<int> geoms;  // visible in at least one frame
  Json visibility = Json::array();
  for (const std::vector<bool>& visible : motion.visible) {
    const auto id = static_cast<int>(&visible - motion.visible.data());
    const auto seen = std::count(visible.begin(), visible.end(), true);
    if (seen > 0) geoms.push_back(id);
    if (seen == 0 || seen == std::ssize(visible)) continue;
    visibility.push_back({{"geom", id}, {"channel", channels.add(visible, std::identity())}});
  }
  Json run;
  run["label"] = staged.caption;
  // Frames in slow motion lie near together, also late in a long run.
  run["times"] = Json::array();
  for (const double time_s : times_s) run["times"].push_back(std::round(time_s * 1e6) / 1e6);
  run["scene"] = describe_scene(staged.model, geoms, staged.surfaces, assets);
  run["bodies"] = tracks_json(motion.bodies, channels);
  run["cameras"] = tracks_json(motion.cameras, channels);
  run["lights"] = tracks_json(motion.lights, channels);
  run["visibility"] = visibility;
  run["surfaces"] = surfaces_json(staged.surfaces);
  run["arrows"] = Json::array();
  for (const ArrowTrack& arrow : staged.arrows) {
    run["arrows"].push_back(arrow_json(arrow, staged.model, times_s, channels));
  }
  run["channels"] = channels.count();
  run["motion"] = channels.packed();
  return run;
}

}  // namespace

std::vector<double> replay_times(const std::vector<double>& log_times_s, const Window& window) {
  const double begin = log_times_s.front();
  const double end = log_times_s.back();
  const double period = (end - begin) / static_cast<double>(log_times_s.size() - 1);
  const double all = end - begin;
  const double coarse =
      std::max({1.0 / kFramesPerSecond, period, 2.0 * all / static_cast<double>(kMostFrames)});
  const double fine_begin = std::clamp(window.from_s, begin, end);
  const double fine_end = std::clamp(window.to_s, begin, end);
  const double fine =
      std::clamp(std::max(window.speed / kFramesPerSecond,
                          2.0 * (fine_end - fine_begin) / static_cast<double>(kMostFrames)),
                 std::min(period, coarse), coarse);
  std::vector<double> times;
  // The end of a part belongs to the next one, or is the last frame.
  const auto add = [&times](double from_s, double to_s, double step_s) {
    const double count = std::ceil((to_s - from_s) / step_s - 1e-6);
    for (double i = 0.0; i < count; ++i) times.push_back(from_s + i * (to_s - from_s) / count);
  };
  add(begin, fine_begin, coarse);
  add(fine_begin, fine_end, fine);
  add(fine_end, end, coarse);
  times.push_back(end);
  return times;
}

Json replay_data(ShownRuns runs, const ShotList& shots, const Window& window, PictureStage& stage) {
  SceneAssets assets;
  Json all = Json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    all.push_back(run_json(runs[i].folder().string(), stage.runs[i], window, assets, stage.notes));
    all.back()["colour"] = stage.styles[i] % kStyleColours;
  }
  Json moments = Json::array();
  for (const Moment& moment : moments_of(runs.front(), shots)) {
    moments.push_back({{"caption", moment.caption}, {"time", moment.time_s}});
  }
  return {{"window", {{"from", window.from_s}, {"to", window.to_s}, {"speed", window.speed}}},
          {"camera", stage.runs.front().camera},
          {"moments", moments},
          {"assets", assets.all()},
          {"runs", all}};
}

}  // namespace breakwater
