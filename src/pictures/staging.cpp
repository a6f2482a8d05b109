#include <breakwater/pictures/staging.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <breakwater/experiment/differing_keys.h>
#include <breakwater/sim/model.h>

namespace breakwater {
namespace {

constexpr Colour kForce{0.84, 0.10, 0.10, 1.0};
constexpr Colour kOtherForce{0.0, 0.35, 0.70, 1.0};
constexpr double kLongestVideo_frames = 1e6;

// Finds a name of the shot list in the model. An error names the shot list.
template <typename Find>
int of_shot_list(const std::string& place, Find&& find) {
  try {
    return std::forward<Find>(find)();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(place + ": " + error.what());
  }
}

ArrowTrack stage_arrow(const FinishedRun& run, const ShotArrow& shot, const Model& model,
                       const Colour& colour) {
  ArrowTrack track = shot.track;
  track.arrow.site =
      of_shot_list(shot.site_place, [&] { return site_id(model, run.fill_in(shot.site)); });
  track.arrow.colour = colour;
  for (const std::string& value : value_names(run.saved(), track.signal)) {
    track.components.push_back(run.saved().signal(value));
  }
  if (const std::size_t width = track.components.size(); width != 1 && width != 3) {
    throw std::invalid_argument(
        fmt::format("arrow: signal {} has {} values, not 1 or 3", track.signal, width));
  }
  return track;
}

}  // namespace

std::vector<std::string> value_names(const SavedRun& run, const std::string& signal) {
  const std::size_t width = run.entry(signal).width;
  if (width == 1 || signal.find('[') != std::string::npos) return {signal};
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= width; ++i) names.push_back(fmt::format("{}[{}]", signal, i));
  return names;
}

PictureRun stage(const FinishedRun& run, const ShotList& shots, const std::string& camera,
                 std::vector<std::string>* notes) {
  const auto is_missing = [&](const std::string& signal) {
    if (notes == nullptr || run.has(signal)) return false;
    notes->push_back(fmt::format("{}: its log has no signal {}, which the shot list names",
                                 run.folder().string(), signal));
    return true;
  };
  PictureRun staged{.model = run.load_scene()};
  const Scenario* const scenario = &run.scenario();
  staged.animate = [scenario](Model& model, double time_s) {
    scenario->animate_scene(model, time_s);
  };
  staged.surfaces = scenario->waving_surfaces(staged.model);
  staged.camera =
      camera.empty()
          ? of_shot_list(shots.camera_place, [&] { return camera_id(staged.model, shots.camera); })
          : camera_id(staged.model, camera);
  staged.times_s = run.times_s();
  staged.qpos = run.qpos();
  for (const ShotArrow& shot : shots.arrows) {
    if (is_missing(shot.track.signal)) continue;
    const Colour& colour = staged.arrows.empty() ? kForce : kOtherForce;
    staged.arrows.push_back(stage_arrow(run, shot, staged.model, colour));
  }
  std::vector<std::optional<LineStyle>> roles;
  for (const ShotLine& line : shots.lines) {
    if (is_missing(line.value)) continue;
    staged.lines.push_back({line.label, run.value(line.value)});
    const auto role = role_of_signal(line.value);
    roles.push_back(role || !line.is_dashed ? role : kReferenceStyle);
  }
  const std::vector<LineStyle> styles = distinct_styles(roles);
  for (std::size_t i = 0; i < styles.size(); ++i) staged.lines[i].style = styles[i];
  staged.caption = run.case_name();
  return staged;
}

std::size_t Window::frames(int fps) const {
  const double exact = (to_s - from_s) / speed * fps;
  if (!(std::round(exact) >= 1.0)) {
    throw std::invalid_argument(
        fmt::format("video: {:g} s at speed {:g} and {} frames/s give no frame: choose a longer "
                    "window or a lower speed",
                    to_s - from_s, speed, fps));
  }
  if (exact > kLongestVideo_frames) {
    throw std::invalid_argument(fmt::format(
        "video: {:g} s at speed {:g} and {} frames/s give {:.0f} frames: choose a shorter window",
        to_s - from_s, speed, fps, exact));
  }
  return static_cast<std::size_t>(std::llround(exact));
}

std::vector<FinishedRun> open_runs(const Catalogue& catalogue,
                                   const std::vector<std::string>& folders) {
  if (folders.size() > kMostRuns) {
    throw std::invalid_argument(
        fmt::format("{} runs: at most {} fit side by side", folders.size(), kMostRuns));
  }
  std::vector<FinishedRun> runs;
  for (const std::string& folder : folders) {
    runs.emplace_back(catalogue, SavedRun(folder));
    const std::string& first = runs.front().scenario().name();
    if (runs.back().scenario().name() != first) {
      throw std::invalid_argument(fmt::format("{}: is a run of {}, but another one is of {}: {}",
                                              folder, runs.back().scenario().name(), first,
                                              "choose runs of one scenario"));
    }
  }
  return runs;
}

std::vector<LineStyle> styles_of(const Catalogue& catalogue, const std::vector<SavedRun>& runs) {
  std::vector<std::string> names;
  for (const SavedRun& run : runs) names.push_back(run.case_name());
  return candidate_styles(names, cases_of(catalogue, runs.front().scenario()));
}

std::vector<std::string> cases_of(const Catalogue& catalogue, const std::string& scenario) {
  if (!catalogue.has<ScenarioKind>(scenario)) return {};
  try {
    return catalogue.get<ScenarioKind>(scenario).scenario_file()->cases();
  } catch (const std::invalid_argument&) {
    return {};  // the colours then go by place
  }
}

Window whole_window(ShownRuns runs) {
  Window all{runs.front().times_s().front(), runs.front().end_s(), 1.0};
  for (const FinishedRun& run : runs) {
    all.from_s = std::min(all.from_s, run.times_s().front());
    all.to_s = std::max(all.to_s, run.end_s());
  }
  return all;
}

Window choose_window(ShownRuns runs, const ShotList& shots, const Wish& wish) {
  const Window all = whole_window(runs);
  const double begin_s = all.from_s;
  const double end_s = all.to_s;
  const double slack_s = 1e-9 * std::max(1.0, end_s);

  Window window{std::max(shots.from_s, begin_s), std::min(shots.to_s, end_s), shots.style.speed};
  if (window.from_s >= window.to_s) window = all;
  if (wish.from_s) window.from_s = *wish.from_s;
  if (wish.to_s) window.to_s = *wish.to_s;
  if (wish.speed) window.speed = *wish.speed;
  // A single end moves a window that does not contain it.
  if (wish.from_s && !wish.to_s && window.to_s <= window.from_s) window.to_s = end_s;
  if (wish.to_s && !wish.from_s && window.from_s >= window.to_s) window.from_s = begin_s;

  if (window.from_s < begin_s - slack_s || window.to_s > end_s + slack_s) {
    throw std::invalid_argument(
        fmt::format("--from {:g}, --to {:g}: the log lasts from {:g} s to {:g} s", window.from_s,
                    window.to_s, begin_s, end_s));
  }
  if (!(window.to_s > window.from_s)) {
    throw std::invalid_argument(fmt::format(
        "--from {:g}, --to {:g}: the end must be after the beginning", window.from_s, window.to_s));
  }
  return window;
}

PictureStage stage_pictures(ShownRuns runs, const ShotList& shots, const std::string& camera,
                            const Window& window) {
  PictureStage stage;
  std::vector<SavedRun> saved;
  for (const FinishedRun& run : runs) saved.push_back(run.saved());
  const std::vector<std::string> labels = labels_of(runs.front().catalogue(), saved);
  stage.styles = styles_of(runs.front().catalogue(), saved);
  std::vector<ChartLine> lines;
  for (const FinishedRun& run : runs) {
    stage.notes.insert(stage.notes.end(), run.notes().begin(), run.notes().end());
    stage.runs.push_back(breakwater::stage(run, shots, camera, &stage.notes));
    stage.runs.back().caption = labels[stage.runs.size() - 1];
    const auto& own = stage.runs.back().lines;
    lines.insert(lines.end(), own.begin(), own.end());
  }
  stage.style = shots.style;
  stage.style.chart_range = chart_range(lines, window.from_s, window.to_s);
  stage.style.speed = window.speed;
  return stage;
}

std::optional<double> time_of(const ShotMoment& moment, const FinishedRun& run) {
  double time_s = moment.at_s;
  if (!moment.first_positive.empty()) {
    if (!run.has(moment.first_positive)) return std::nullopt;
    const Series signal = run.saved().signal(moment.first_positive);
    std::size_t i = 0;
    while (i < signal.values.size() &&
           (signal.times_s[i] < moment.at_s || signal.values[i] <= 0.0)) {
      ++i;
    }
    if (i == signal.values.size()) return std::nullopt;
    time_s = signal.times_s[i];
  }
  time_s += moment.plus_s;
  if (time_s < run.times_s().front() || time_s > run.end_s()) return std::nullopt;
  return time_s;
}

std::vector<Moment> moments_of(const FinishedRun& run, const ShotList& shots,
                               std::vector<std::string>* missing) {
  std::vector<Moment> moments;
  for (const ShotMoment& moment : shots.moments) {
    const std::string& signal = moment.first_positive;
    if (const auto time_s = time_of(moment, run)) {
      moments.push_back({moment.caption, *time_s});
    } else if (missing != nullptr) {
      missing->push_back(
          fmt::format("{}: \"{}\" is not in the strip: {}", run.folder().string(), moment.caption,
                      !signal.empty() && !run.has(signal) ? "its log has no signal " + signal
                                                          : "it is not within this run"));
    }
  }
  return moments;
}

std::string draw_strip(const FinishedRun& run, const ShotList& shots,
                       const std::vector<Moment>& moments, const std::string& camera,
                       const PictureStyle& each, std::vector<std::string>* notes) {
  constexpr Colour kInk{0.10, 0.12, 0.15, 1.0};
  constexpr int kGap = 12;
  const ShownRuns runs(&run, 1);
  const Window window = choose_window(runs, shots, {});
  PictureStage stage = stage_pictures(runs, shots, camera, window);
  const std::vector<ChartLine> lines = std::exchange(stage.runs.front().lines, {});
  stage.style.width = each.width;
  stage.style.height = each.height;
  stage.style.look = each.look;
  stage.style.title.clear();
  stage.style.captions = false;

  const auto count = static_cast<int>(moments.size());
  const double unit = Picture::unit_px(each.width, each.height);
  const double text = 19.0 * unit;
  const int caption = static_cast<int>(std::lround(3.0 * text));
  const int chart_height = lines.empty() ? 0 : static_cast<int>(std::lround(240.0 * unit));
  const int width = count * each.width + (count - 1) * kGap;
  Canvas page(width, each.height + caption + chart_height);
  Picture picture(stage.runs, stage.style);
  Canvas panel(each.width, each.height);
  std::optional<Chart> chart;
  if (!lines.empty()) {
    chart.emplace(shots.style.chart_title + "   " + stage.runs.front().caption, lines,
                  stage.style.chart_range, width, chart_height, unit);
  }
  for (int i = 0; i < count; ++i) {
    const Moment& moment = moments[static_cast<std::size_t>(i)];
    std::copy_n(picture.draw(moment.time_s), 4 * each.width * each.height, panel.pixels());
    const int left = i * (each.width + kGap);
    page.paste(panel, left, 0);
    const std::string letter(1, static_cast<char>('a' + i));
    page.text({left + 0.5 * each.width, each.height + 1.3 * text},
              fmt::format("({}) {}", letter, moment.caption), text, kInk, Align::center, true);
    page.text({left + 0.5 * each.width, each.height + 2.5 * text},
              fmt::format("t = {:.3f} s", moment.time_s), text, kInk, Align::center);
    if (chart && moment.time_s >= window.from_s && moment.time_s <= window.to_s) {
      chart->mark(moment.time_s, letter);
    }
  }
  if (chart) chart->draw(page, 0, each.height + caption, window.to_s);
  if (notes != nullptr) notes->insert(notes->end(), stage.notes.begin(), stage.notes.end());
  return page.png();
}

}  // namespace breakwater
