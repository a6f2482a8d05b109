#include <breakwater/pages/replay_part.h>

#include <fmt/format.h>

#include <algorithm>

#include <breakwater/pages/html_page.h>
#include <breakwater/pictures/replay_data.h>
#include <breakwater/render/render_error.h>
#include <breakwater/signals/input_file.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// The pictures for paper and for browsers without WebGL.
std::string strip_png(const FinishedRun& run, const ShotList& shots, const std::string& camera,
                      std::vector<std::string>& notes) {
  const fs::path made = run.folder() / "strip.png";
  if (fs::exists(made)) return bytes_of(made);
  try {
    std::vector<Moment> moments = moments_of(run, shots);
    if (moments.empty()) {
      const Window window = choose_window({&run, 1}, shots, {});
      const double to_s = std::min(window.to_s, run.times_s().back());
      moments = {{"begin", window.from_s}, {"middle", 0.5 * (window.from_s + to_s)}, {"end", to_s}};
    }
    const PictureStyle each{.width = 420, .height = 240, .look = kFullLook};
    return draw_strip(run, shots, moments, camera, each);
  } catch (const RenderError& error) {
    notes.push_back(fmt::format("no strip for browsers without WebGL: {}", error.what()));
    return "";
  }
}

PageChart chart_of(const PictureStage& stage, const std::string& group) {
  PageChart chart;
  chart.id = group + "-shots";
  chart.group = group;
  chart.title = stage.style.chart_title;
  const bool is_one = stage.runs.size() == 1;
  for (std::size_t i = 0; i < stage.runs.size(); ++i) {
    const PictureRun& run = stage.runs[i];
    for (const ChartLine& line : run.lines) {
      const bool is_reference = line.style == kReferenceStyle;
      if (is_reference && i > 0) continue;  // it is equal for all runs
      ChartSeries series;
      series.label = is_one || is_reference ? line.label : run.caption + ", " + line.label;
      series.values = line.series;
      if (is_one || is_reference) series.style = line.style;
      // With several runs each run has one line in its colour. The user can switch on its other
      // lines.
      if (!is_one && &line == &run.lines.front()) series.style = stage.styles[i];
      series.is_off = !series.style;
      chart.series.push_back(series);
    }
  }
  return chart;
}

// When the page begins: a little before the moment that it is about.
double begin_of(const ShotList& shots, const FinishedRun& run, const Window& window) {
  constexpr double kShare = 0.02;
  for (const Moment& moment : moments_of(run, shots)) {
    if (moment.caption != shots.page.opens_before) continue;
    return std::max(run.times_s().front(), moment.time_s - kShare * (window.to_s - window.from_s));
  }
  return window.from_s;
}

// `camera`, if not empty, replaces that of the shot list.
ReplayPart replay_part(ShownRuns runs, const std::string& group, const std::string& camera,
                       std::vector<std::string>& notes) {
  ReplayPart part;
  const ShotList shots = shot_list(runs.front().shots_file());
  part.window = choose_window(runs, shots, {});
  PictureStage stage =
      stage_pictures(runs, shots, camera.empty() ? shots.page.camera : camera, part.window);
  PageData data = replay_data(runs, shots, part.window, stage);
  const Window whole = whole_window(runs);
  part.is_whole = part.window.to_s - part.window.from_s > 0.98 * (whole.to_s - whole.from_s);
  notes.insert(notes.end(), stage.notes.begin(), stage.notes.end());
  for (const PictureRun& run : stage.runs) {
    part.labels += (part.labels.empty() ? "" : ", ") + run.caption;
  }
  if (!shots.lines.empty()) {
    part.chart = chart_of(stage, group);
    part.chart->window = part.window;
    if (part.chart->series.empty()) part.chart.reset();
  }
  const std::string about = fmt::format(
      "{} in three dimensions: {}", part.labels,
      shots.style.title.empty() ? runs.front().scenario().summary() : shots.style.title);
  auto strips = PageData::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string png = strip_png(runs[i], shots, camera, notes);
    if (png.empty()) break;  // the others have none either
    const std::string& label = stage.runs[i].caption;
    strips.push_back({{"address", "data:image/png;base64," + base64(png.data(), png.size())},
                      {"alt", "Pictures of the run " + label + " in a row"},
                      {"label", runs.size() > 1 ? PageData(label) : PageData()}});
  }
  part.box = {{"id", group + "-replay"},
              {"group", group},
              {"time", fmt::format("{:.6g}", begin_of(shots, runs.front(), part.window))},
              {"alt", about},
              {"data", std::move(data)},
              {"strip", strips}};
  return part;
}

}  // namespace

std::optional<ReplayPart> replay_of(const Catalogue& catalogue, std::span<const SavedRun> saved,
                                    const std::string& group, std::vector<std::string>& notes) {
  // An estimation from recorded data has nothing to show in three dimensions.
  const SavedRun& first = saved.front();
  if (!catalogue.has<ScenarioKind>(first.scenario()) && !first.has_signal("qpos"))
    return std::nullopt;
  try {
    std::vector<FinishedRun> runs;
    for (const SavedRun& run : saved) runs.emplace_back(catalogue, run);
    return replay_part(runs, group, "", notes);
  } catch (const std::invalid_argument& error) {
    notes.push_back(fmt::format("no replay: {}", error.what()));
  } catch (const RenderError& error) {
    notes.push_back(fmt::format("no replay: {}", error.what()));
  }
  return std::nullopt;
}

PageData window_data(const Window& window, const std::string& axis) {
  return {{"axis", axis},
          {"from_s", fmt::format("{:g}", window.from_s)},
          {"to_s", fmt::format("{:g}", window.to_s)}};
}

std::string replay_page(ShownRuns runs, const std::string& camera,
                        std::vector<std::string>& notes) {
  const ReplayPart part = replay_part(runs, "replay", camera, notes);
  auto blocks = PageData::array();
  add_block(blocks, "replay", part.box);
  if (part.chart) add_block(blocks, "figures", PageData::array({figure_of(*part.chart)}));
  const Scenario& scenario = runs.front().scenario();
  return html_page("replay",
                   {{"title", fmt::format("{}: {}", scenario.name(), part.labels)},
                    {"is_bare", true},
                    {"lead", PageData::array({PageData{{"text", scenario.summary()}}})},
                    {"sections", PageData::array({PageData{{"id", "run"}, {"blocks", blocks}}})}});
}

}  // namespace breakwater
