#include <breakwater/pages/replay_part.h>

#include <fmt/format.h>

#include <algorithm>

#include <breakwater/pages/html_page.h>
#include <breakwater/pictures/replay_data.h>
#include <breakwater/render/render_error.h>

namespace breakwater {
namespace fs = std::filesystem;
namespace {

// The shot list with moments inside the run: its own ones, or the beginning, middle and end.
ShotList with_moments(const FinishedRun& run, ShotList shots, const Window& window) {
  const bool has_one =
      std::any_of(shots.moments.begin(), shots.moments.end(),
                  [&](const ShotMoment& moment) { return time_of(moment, run).has_value(); });
  if (has_one) return shots;
  const double last_s = std::min(window.to_s, run.times_s().back());
  shots.moments = {{"begin", window.from_s, "", 0.0},
                   {"middle", 0.5 * (window.from_s + last_s), "", 0.0},
                   {"end", last_s, "", 0.0}};
  return shots;
}

// The pictures for paper and for browsers without WebGL.
std::string strip_address(const FinishedRun& run, const ShotList& shots, const std::string& camera,
                          std::vector<std::string>& notes) {
  const fs::path made = run.folder() / "strip.png";
  if (fs::exists(made)) return data_address(made, "image/png");
  try {
    const Window window = choose_window({&run, 1}, shots, {});
    const Strip strip =
        draw_strip(run, with_moments(run, shots, window), {camera, 420, 240, kFullLook});
    return "data:image/png;base64," + base64(strip.png.data(), strip.png.size());
  } catch (const RenderError& error) {
    notes.push_back(fmt::format("no strip for browsers without WebGL: {}", error.what()));
    return "";
  }
}

PageChart chart_of(const ShotList& shots, const PictureStage& stage, const ReplayOptions& options) {
  PageChart chart;
  chart.id = options.id + "-shots";
  chart.group = options.group;
  chart.title = shots.style.chart_title;
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
  const auto moment =
      std::find_if(shots.moments.begin(), shots.moments.end(),
                   [&](const ShotMoment& one) { return one.caption == shots.page.opens_before; });
  const auto time_s = moment == shots.moments.end() ? std::nullopt : time_of(*moment, run);
  if (!time_s) return window.from_s;
  return std::max(run.times_s().front(), *time_s - kShare * (window.to_s - window.from_s));
}

ReplayPart replay_part(ShownRuns runs, const ReplayOptions& options,
                       std::vector<std::string>& notes) {
  ReplayPart part;
  const ShotList shots = shot_list(runs.front().shots_file());
  const ReplayData data =
      replay_data(runs, shots, options.camera.empty() ? shots.page.camera : options.camera);
  part.window = data.window;
  const Window whole = whole_window(runs);
  part.is_whole = data.window.to_s - data.window.from_s > 0.98 * (whole.to_s - whole.from_s);
  notes.insert(notes.end(), data.stage.notes.begin(), data.stage.notes.end());
  for (const PictureRun& run : data.stage.runs) {
    part.labels += (part.labels.empty() ? "" : ", ") + run.caption;
  }
  if (!shots.lines.empty()) {
    part.chart = chart_of(shots, data.stage, options);
    part.chart->from_s = part.window.from_s;
    part.chart->to_s = part.window.to_s;
    if (part.chart->series.empty()) part.chart.reset();
  }
  const std::string about = fmt::format(
      "{} in three dimensions: {}", part.labels,
      shots.style.title.empty() ? runs.front().scenario().summary() : shots.style.title);
  auto strips = PageData::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string strip = strip_address(runs[i], shots, options.camera, notes);
    if (strip.empty()) break;  // the others have none either
    const std::string& label = data.stage.runs[i].caption;
    strips.push_back({{"address", strip},
                      {"alt", "Pictures of the run " + label + " in a row"},
                      {"label", runs.size() > 1 ? PageData(label) : PageData()}});
  }
  part.box = {{"id", options.id},
              {"group", options.group},
              {"time", fmt::format("{:.6g}", begin_of(shots, runs.front(), part.window))},
              {"alt", about},
              {"data", data.json},
              {"strip", strips}};
  return part;
}

}  // namespace

std::optional<ReplayPart> replay_of(const Catalogue& catalogue,
                                    const std::vector<fs::path>& folders,
                                    const ReplayOptions& options, std::vector<std::string>& notes) {
  try {
    std::vector<FinishedRun> runs;
    for (const fs::path& folder : folders) runs.emplace_back(catalogue, folder);
    return replay_part(runs, options, notes);
  } catch (const NothingMoved&) {
    // The scenario has nothing to show in three dimensions, so no note is needed.
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
  const ReplayPart part = replay_part(runs, {"replay", "replay", camera}, notes);
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
