#include <breakwater/pictures/strip.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakwater {
namespace {

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
                                (shots.moments.empty()
                                     ? ": its scenario has no shot list with moments (shots.toml)"
                                     : ": none of the shot list's moments is in this run's log"));
  }
  return moments;
}

// The reasons why moments of the list are not in the strip, one line each.
std::vector<std::string> notes_of_missing(const FinishedRun& run, const ShotList& shots) {
  std::vector<std::string> notes;
  for (const ShotMoment& moment : shots.moments) {
    if (time_of(moment, run)) continue;
    const std::string& signal = moment.first_positive;
    notes.push_back(
        fmt::format("{}: \"{}\" is not in the strip: {}", run.folder().string(), moment.caption,
                    !signal.empty() && !run.has(signal) ? "its log has no signal " + signal
                                                        : "it is not within this run"));
  }
  return notes;
}

}  // namespace

Strip draw_strip(const FinishedRun& run, const ShotList& shots, const StripStyle& style) {
  constexpr Colour kInk{0.10, 0.12, 0.15, 1.0};
  constexpr int kGap = 12;
  const std::vector<Moment> moments = moments_of(run, shots);
  const ShownRuns runs = {&run};
  const Window window = choose_window(runs, shots, {});
  PictureStage stage = stage_pictures(runs, shots, style.camera, window);
  for (std::string& note : notes_of_missing(run, shots)) stage.notes.push_back(std::move(note));
  const std::vector<ChartLine> lines = std::exchange(stage.runs.front().lines, {});
  stage.style.width = style.width;
  stage.style.height = style.height;
  stage.style.look = style.look;
  stage.style.title.clear();
  stage.style.captions = false;

  const auto count = static_cast<int>(moments.size());
  const double unit = Picture::unit_px(style.width, style.height);
  const double text = 19.0 * unit;
  const int caption = static_cast<int>(std::lround(3.0 * text));
  const int chart_height = lines.empty() ? 0 : static_cast<int>(std::lround(240.0 * unit));
  const int width = count * style.width + (count - 1) * kGap;
  Canvas page(width, style.height + caption + chart_height);
  Picture picture(stage.runs, stage.style);
  if (const auto warning = picture.offscreen().slowness()) stage.notes.push_back(*warning);
  Canvas panel(style.width, style.height);
  for (int i = 0; i < count; ++i) {
    const Moment& moment = moments[static_cast<std::size_t>(i)];
    std::copy_n(picture.draw(moment.time_s), 4 * style.width * style.height, panel.pixels());
    const int left = i * (style.width + kGap);
    page.paste(panel, left, 0);
    const std::string letter(1, static_cast<char>('a' + i));
    page.text({left + 0.5 * style.width, style.height + 1.3 * text},
              fmt::format("({}) {}", letter, moment.caption), text, kInk, Align::center, true);
    page.text({left + 0.5 * style.width, style.height + 2.5 * text},
              fmt::format("t = {:.3f} s", moment.time_s), text, kInk, Align::center);
  }
  if (!lines.empty()) {
    Chart chart(shots.chart_title + "   " + stage.runs.front().caption, lines,
                stage.style.chart_range, width, chart_height, unit);
    for (int i = 0; i < count; ++i) {
      const double time_s = moments[static_cast<std::size_t>(i)].time_s;
      if (time_s >= window.from_s && time_s <= window.to_s) {
        chart.mark(time_s, std::string(1, static_cast<char>('a' + i)));
      }
    }
    chart.draw(page, 0, style.height + caption, window.to_s);
  }
  return {page.png(), count, picture.offscreen().renderer(), stage.notes};
}

}  // namespace breakwater
