#include <breakwater/pages/tuning_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <breakwater/config/names.h>
#include <breakwater/pages/chart_scale.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/search/tuning_outputs.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/goal.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

// In units of the drawing.
constexpr double kChartWidth = 640.0, kChartHeight = 400.0;
constexpr double kLeftEdge = 64.0, kRightEdge = 16.0, kTopEdge = 14.0, kBottomEdge = 46.0;
constexpr int kTicks = 6;
constexpr int kDigits = 5;  // that people read
// Told apart by people who see no red or green too (P. Tol's bright colours).
constexpr std::array<const char*, 6> kColours = {"#4477aa", "#ee6677", "#228833",
                                                 "#aa8800", "#66aacc", "#aa3377"};

// Where there are more cases than colours, their marks differ in shape, and lines in dashes.
constexpr std::array<const char*, 3> kShapes = {"m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z",
                                                "m0 -4.6l4.6 4.6l-4.6 4.6l-4.6 -4.6z",
                                                "m-3.2 -3.2h6.4v6.4h-6.4z"};
constexpr std::array<const char*, 3> kDashes = {"none", "7 3", "2 3"};

std::string colour(std::size_t i) {
  return kColours[i % kColours.size()];
}
std::string shape(std::size_t i) {
  return kShapes[i / kColours.size() % kShapes.size()];
}
std::string dashes(std::size_t i) {
  return kDashes[i / kColours.size() % kDashes.size()];
}

std::string place(double x) {
  return fmt::format("{:.2f}", x);
}

struct Mark {
  double x, y;
  double y_fresh, x_fresh;  // NaN: there is none
  std::size_t tuned;        // whose
  std::string text;
};

// A drawing's range, of all that is shown.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double value) {
    if (std::isnan(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  ChartScale scale(double a, double b) const {
    if (is_for_log(low, high)) {
      const double margin = std::pow(high / low, 0.04);
      return {low / margin, high * margin, true, a, b};
    }
    const double margin = 0.04 * (high - low);
    return {low - margin, high + margin, false, a, b};
  }
};

mustache::data frame(const ChartScale& x, const ChartScale& y, const std::string& x_title,
                     const std::string& y_title) {
  mustache::data chart;
  chart.set("x_title", x_title);
  chart.set("y_title", y_title);
  mustache::data across(mustache::data::type::list), up(mustache::data::type::list);
  for (const ChartScale::Tick& tick : x.ticks(kTicks)) {
    mustache::data one;
    one.set("at", place(x(tick.value)));
    one.set("label", tick.label);
    across << one;
  }
  for (const ChartScale::Tick& tick : y.ticks(kTicks)) {
    mustache::data one;
    one.set("at", place(y(tick.value)));
    one.set("label", tick.label);
    up << one;
  }
  chart.set("x_ticks", across);
  chart.set("y_ticks", up);
  return chart;
}

ChartScale across(const Range& range) {
  return range.scale(kLeftEdge, kChartWidth - kRightEdge);
}
ChartScale upwards(const Range& range) {
  return range.scale(kChartHeight - kBottomEdge, kTopEdge);
}

double value_of(const std::optional<Evaluation>& evaluation, std::size_t objective) {
  if (!evaluation || evaluation->failures > 0) return std::nan("");
  return evaluation->objectives[objective].value;
}

// Through points of the drawing, in their order.
mustache::data line_of(const std::vector<std::pair<double, double>>& points, std::size_t tuned) {
  std::string path;
  for (const auto& [x, y] : points) {
    path += fmt::format("{}{} {}", path.empty() ? "M" : "L", place(x), place(y));
  }
  mustache::data line;
  line.set("path", path);
  line.set("colour", colour(tuned));
  line.set("dashes", dashes(tuned));
  return line;
}

mustache::data front_chart(const TuningPlan& plan, const TuningResult& result) {
  const Tuning& tuning = plan.tuning();
  std::vector<Mark> marks;
  Range x_range, y_range;
  std::size_t label = 0;
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    for (const FrontPoint& point : result.fronts[c].points) {
      const Mark mark{point.tuned.objectives[0].value,
                      point.tuned.objectives[1].value,
                      value_of(point.fresh, 1),
                      value_of(point.fresh, 0),
                      c,
                      fmt::format("{} of {}", ++label, result.fronts[c].case_name)};
      x_range.add(mark.x), x_range.add(mark.x_fresh);
      y_range.add(mark.y), y_range.add(mark.y_fresh);
      marks.push_back(mark);
    }
  }
  const ChartScale x = across(x_range), y = upwards(y_range);
  const auto title = [&](const Objective& one) {
    return fmt::format("{} ({})", one.metric, name_of(over_names(), one.over));
  };
  mustache::data chart = frame(x, y, title(tuning.objectives[0]), title(tuning.objectives[1]));
  mustache::data list(mustache::data::type::list);
  for (const Mark& mark : marks) {
    mustache::data one;
    one.set("x", place(x(mark.x)));
    one.set("y", place(y(mark.y)));
    one.set("colour", colour(mark.tuned));
    one.set("shape", shape(mark.tuned));
    one.set("text", mark.text);
    if (!std::isnan(mark.x_fresh)) {
      mustache::data fresh;
      fresh.set("x", place(x(mark.x_fresh)));
      fresh.set("y", place(y(mark.y_fresh)));
      one.set("fresh", fresh);
    }
    list << one;
  }
  chart.set("marks", list);
  mustache::data lines(mustache::data::type::list);
  // Of three objectives the front is no line.
  const std::size_t drawn = tuning.objectives.size() == 2 ? result.fronts.size() : 0;
  for (std::size_t c = 0; c < drawn; ++c) {
    std::vector<std::pair<double, double>> points;
    for (const Mark& mark : marks) {
      if (mark.tuned == c) points.emplace_back(x(mark.x), y(mark.y));
    }
    std::sort(points.begin(), points.end());
    lines << line_of(points, c);
  }
  chart.set("lines", lines);
  return chart;
}

mustache::data volume_chart(const TuningResult& result) {
  Range x_range, y_range;
  for (const TunedFront& front : result.fronts) {
    for (const auto& [evaluations, volume] : front.hypervolume) {
      x_range.add(static_cast<double>(evaluations));
      y_range.add(volume);
    }
  }
  const ChartScale x = across(x_range), y = upwards(y_range);
  mustache::data chart = frame(x, y, "evaluations", "hypervolume");
  mustache::data lines(mustache::data::type::list);
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    std::vector<std::pair<double, double>> points;
    for (const auto& [evaluations, volume] : result.fronts[c].hypervolume) {
      points.emplace_back(x(static_cast<double>(evaluations)), y(volume));
    }
    lines << line_of(points, c);
  }
  chart.set("lines", lines);
  return chart;
}

mustache::data legend(const TuningResult& result) {
  mustache::data list(mustache::data::type::list);
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    mustache::data one;
    one.set("colour", colour(c));
    one.set("shape", shape(c));
    one.set("case", result.fronts[c].case_name);
    one.set("size", std::to_string(result.fronts[c].points.size()));
    one.set("evaluations", std::to_string(result.fronts[c].evaluations.size()));
    const auto& evaluations = result.fronts[c].evaluations;
    one.set("feasible", std::to_string(std::count_if(evaluations.begin(), evaluations.end(),
                                                     [](const Evaluation& evaluation) {
                                                       return evaluation.is_feasible();
                                                     })));
    one.set("volume", result.fronts[c].hypervolume.empty()
                          ? "-"
                          : fmt::format("{:.5g}", result.fronts[c].hypervolume.back().second));
    list << one;
  }
  return list;
}

// Where the hypervolumes end: "peak_N = 12, free_motion_s = 1.5".
std::string reference_text(const Tuning& tuning, const TuningResult& result) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < result.reference.size(); ++i) {
    const Objective& objective = tuning.objectives[i];
    const double sign = objective.goal == Goal::max ? -1.0 : 1.0;
    parts.push_back(fmt::format("{} = {:.5g}", objective.metric, sign * result.reference[i]));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Whole numbers are counts, and names of what is counted.
std::string readable(const std::string& cell) {
  return cell.find('.') == std::string::npos ? cell : in_short(cell, kDigits);
}

mustache::data front_rows(const FrontTable& table) {
  mustache::data rows(mustache::data::type::list);
  for (const FrontRow& row : table.rows) {
    mustache::data cells(mustache::data::type::list);
    for (const std::string& cell : row.cells) {
      mustache::data one;
      one.set("text", readable(cell));
      cells << one;
    }
    mustache::data line;
    line.set("cells", cells);
    line.set("colour", colour(row.tuned));
    rows << line;
  }
  return rows;
}

}  // namespace

void write_tuning_report(const TuningPlan& plan, const TuningResult& result,
                         const std::filesystem::path& folder) {
  const Tuning& tuning = plan.tuning();
  const FrontTable table = front_table(plan, result);
  mustache::data data;
  data.set("title", "Tuning of " + tuning.scenario);
  mustache::data toc(mustache::data::type::list);
  for (const auto& [href, label] :
       {std::pair("front", "The front"), {"budget", "Over the budget"}, {"points", "Its points"}}) {
    mustache::data entry;
    entry.set("href", href);
    entry.set("label", label);
    toc << entry;
  }
  data.set("toc", toc);
  data.set("scenario", tuning.scenario);
  data.set("algorithm", name_of(search_algorithms(), tuning.algorithm));
  data.set("budget", std::to_string(tuning.budget));
  data.set("worlds", number_of(tuning.worlds.size(), "world"));
  if (tuning.validation) {
    mustache::data fresh;
    fresh.set("worlds", number_of(tuning.validation->size(), "world"));
    data.set("validation", fresh);
  }
  data.set("cases", legend(result));
  if (!table.rows.empty()) {
    mustache::data reference;
    reference.set("text", reference_text(tuning, result));
    data.set("reference", reference);
  }
  if (tuning.objectives.size() > 1 && !table.rows.empty()) {
    data.set("front", front_chart(plan, result));
  }
  if (!table.rows.empty()) data.set("volumes", volume_chart(result));
  mustache::data columns(mustache::data::type::list);
  for (const std::string& name : table.columns) {
    mustache::data one;
    one.set("name", name);
    columns << one;
  }
  data.set("columns", columns);
  data.set("rows", front_rows(table));
  replace_file(folder / "report.html", html_page("tuning", data));
}

}  // namespace breakwater
