#include <breakwater/pictures/replay_motion.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr double kLargest = 4e15;  // whole numbers below it are exact, also in a browser

}  // namespace

void append_channel(std::span<const double> values, double unit, std::vector<std::uint8_t>& bytes) {
  std::int64_t last = 0;
  for (const double value : values) {
    const double exact = value / unit;
    const std::int64_t now =
        std::isfinite(exact) ? std::llround(std::clamp(exact, -kLargest, kLargest)) : last;
    const std::int64_t step = now - last;
    last = now;
    std::uint64_t left =
        static_cast<std::uint64_t>(step) << 1U ^ static_cast<std::uint64_t>(step >> 63);
    while (left >= 128U) {
      bytes.push_back(static_cast<std::uint8_t>(left & 127U) | 128U);
      left >>= 7U;
    }
    bytes.push_back(static_cast<std::uint8_t>(left));
  }
}

std::vector<double> read_channel(std::span<const std::uint8_t> bytes, std::size_t& at,
                                 std::size_t count, double unit) {
  std::vector<double> values;
  std::int64_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t word = 0;
    std::uint8_t byte = 128U;
    for (unsigned shift = 0; (byte & 128U) != 0; shift += 7) {
      if (at >= bytes.size() || shift > 63) throw std::invalid_argument("a channel is cut off");
      byte = bytes[at++];
      word |= static_cast<std::uint64_t>(byte & 127U) << shift;
    }
    last += static_cast<std::int64_t>(word >> 1U) ^ -static_cast<std::int64_t>(word & 1U);
    values.push_back(static_cast<double>(last) * unit);
  }
  return values;
}
namespace {

constexpr double kFramesPerSecond = 60.0;
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

TimeSpan span_of(double from_s, double to_s, double step_s) {
  if (!(to_s > from_s)) return {from_s, step_s, 0};
  // The end belongs to the next span or is the last frame.
  const auto count =
      static_cast<std::size_t>(std::max(1.0, std::ceil((to_s - from_s) / step_s - 1e-6)));
  return {from_s, (to_s - from_s) / static_cast<double>(count), count};
}

}  // namespace

std::vector<TimeSpan> replay_times(const std::vector<double>& log_times_s, const Window& window) {
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
  std::vector<TimeSpan> spans;
  for (const TimeSpan& span :
       {span_of(begin, fine_begin, coarse), span_of(fine_begin, fine_end, fine),
        span_of(fine_end, end, coarse)}) {
    if (span.count > 0) spans.push_back(span);
  }
  spans.back().count += 1;
  return spans;
}

std::vector<double> times_of(const std::vector<TimeSpan>& spans) {
  std::vector<double> times;
  for (const TimeSpan& span : spans) {
    for (std::size_t i = 0; i < span.count; ++i) {
      times.push_back(span.from_s + static_cast<double>(i) * span.step_s);
    }
  }
  return times;
}

ReplayMotion replay_motion(PictureRun& run, const std::vector<double>& times_s) {
  Model& model = run.model;
  ScenePoser poser(model);
  ReplayMotion motion;
  motion.bodies.resize(static_cast<std::size_t>(model->nbody));
  motion.cameras.resize(static_cast<std::size_t>(model->ncam));
  motion.lights.resize(static_cast<std::size_t>(model->nlight));
  std::vector<Visibility> visibility(static_cast<std::size_t>(model->ngeom));
  std::vector<double> qpos;
  double looks = 0.0;
  const auto add = [](std::vector<PoseTrack>& tracks, auto&& pose_of) {
    for (std::size_t i = 0; i < tracks.size(); ++i)
      tracks[i].push_back(pose_of(static_cast<int>(i)));
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
    for (int i = 0; i < model->ngeom; ++i) {
      Visibility& geom = visibility[static_cast<std::size_t>(i)];
      const bool now = is_drawn(model, i);
      geom.geom = i;
      if (frame == 0) geom.at_first = now;
      if (now != (geom.at_first == (geom.changes.size() % 2 == 0))) geom.changes.push_back(frame);
    }
  }
  for (const Visibility& geom : visibility) {
    if (geom.at_first || !geom.changes.empty()) motion.geoms.push_back(geom.geom);
    if (!geom.changes.empty()) motion.visibility.push_back(geom);
  }
  return motion;
}

}  // namespace breakwater
