#include <breakwater/pages/tuning_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <breakwater/config/names.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/svg_plot.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/search/tuning_outputs.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/goal.h>
#include <breakwater/study/ranking_text.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

constexpr double kFrontWidth = 480.0, kFrontHeight = 310.0;
constexpr PlotArea kFrontArea{60.0, kFrontWidth - 12.0, 12.0, kFrontHeight - 40.0};
constexpr int kTicks = 6;
constexpr int kDigits = 5;  // for readers

struct Mark {
  double x, y;
  double y_fresh, x_fresh;  // after validation; NaN: none
  std::size_t tuned;        // index of the candidate
  std::string text;
};

// The axis of a range, with a margin.
ChartScale scale_of(const PlotRange& range, double a, double b) {
  constexpr double kShare = 0.04;
  const bool is_log = is_for_log(range.low, range.high);
  const double margin = kShare * (range.high - range.low);
  const double factor = is_log ? std::pow(range.high / range.low, kShare) : 1.0;
  return is_log ? ChartScale(range.low / factor, range.high * factor, true, a, b)
                : ChartScale(range.low - margin, range.high + margin, false, a, b);
}

ChartScale across(const PlotRange& range) {
  return scale_of(range, kFrontArea.left, kFrontArea.right);
}
ChartScale upwards(const PlotRange& range) {
  return scale_of(range, kFrontArea.bottom, kFrontArea.top);
}

SvgPlot axes(const ChartScale& x, const ChartScale& y, const std::string& x_title,
             const std::string& y_title, const std::string& about) {
  SvgPlot plot("front", kFrontWidth, kFrontHeight, about);
  plot.y_grid(kFrontArea, y, kTicks);
  plot.x_grid(kFrontArea, x, kTicks);
  plot.frame(kFrontArea);
  plot.x_ticks(kFrontArea, x, kTicks);
  plot.x_title(kFrontArea, x_title);
  plot.y_title(kFrontArea, y_title);
  return plot;
}

double value_of(const std::optional<Evaluation>& evaluation, std::size_t objective) {
  if (!evaluation || evaluation->failures > 0) return std::nan("");
  return evaluation->objectives[objective].value;
}

std::string front_chart(const TuningPlan& plan, const TuningResult& result,
                        const std::vector<Identity>& looks, std::size_t chosen) {
  const Tuning& tuning = plan.tuning();
  std::vector<Mark> marks;
  PlotRange x_range, y_range;
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
    return fmt::format("{}, {}", metric_label_with_unit(one.metric, unit_of(one.metric)),
                       name_of(over_names(), one.over));
  };
  SvgPlot plot = axes(x, y, title(tuning.objectives[0]), title(tuning.objectives[1]),
                      "The fronts of all cases; the table below has the numbers");
  // With three objectives the front is not a line.
  const std::size_t drawn = tuning.objectives.size() == 2 ? result.fronts.size() : 0;
  for (std::size_t c = 0; c < drawn; ++c) {
    std::vector<PlotPoint> points;
    for (const Mark& mark : marks) {
      if (mark.tuned == c) points.emplace_back(x(mark.x), y(mark.y));
    }
    std::sort(points.begin(), points.end());
    plot.path("line faint " + series_class(looks[c]), line_path(points));
  }
  for (const Mark& mark : marks) {
    plot.add(fmt::format("<g class=\"{}\"><title>{}</title>", series_class(looks[mark.tuned]),
                         xml_text(mark.text)));
    if (!std::isnan(mark.x_fresh)) {
      plot.path("x", cross_path(x(mark.x_fresh), y(mark.y_fresh), 3.0));
    }
    plot.path("spot", spot_path(x(mark.x), y(mark.y), looks[mark.tuned]));
    const auto number = static_cast<std::size_t>(&mark - marks.data()) + 1;
    if (number == chosen) {
      plot.add(fmt::format("<circle class=\"chosen\" cx=\"{}\" cy=\"{}\" r=\"8\"/>", px(x(mark.x)),
                           px(y(mark.y))));
      const bool is_right = x(mark.x) > 0.5 * (kFrontArea.left + kFrontArea.right);
      plot.text(x(mark.x) + (is_right ? -12.0 : 12.0), y(mark.y) + 3.5, is_right ? "end" : "start",
                fmt::format("point {}", number), "title");
    }
    plot.add("</g>");
  }
  return plot.svg();
}

std::string progress_chart(const Tuning& tuning, const TuningResult& result,
                           const std::vector<Identity>& looks) {
  PlotRange x_range, y_range;
  for (const TunedFront& front : result.fronts) {
    for (const auto& [evaluations, volume] : front.progress) {
      x_range.add(static_cast<double>(evaluations));
      y_range.add(volume);
    }
  }
  const ChartScale x = across(x_range), y = upwards(y_range);
  const std::string& metric = tuning.objectives.front().metric;
  const std::string what =
      tuning.has_front() ? "hypervolume" : metric_label_with_unit(metric, unit_of(metric));
  SvgPlot plot = axes(x, y, "evaluations", what, "Progress over the evaluations: " + what);
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    std::vector<PlotPoint> points;
    for (const auto& [evaluations, volume] : result.fronts[c].progress) {
      points.emplace_back(x(static_cast<double>(evaluations)), y(volume));
    }
    plot.path("line " + series_class(looks[c]), line_path(points));
  }
  return plot.svg();
}

// The point that is nearest to the best of all objectives, each over its range on the fronts: of
// fresh worlds where they were met.
struct ChosenPoint {
  std::size_t front = 0, point = 0, label = 0;
};
std::optional<ChosenPoint> chosen_point(const Tuning& tuning, const TuningResult& result) {
  std::vector<std::vector<double>> values;
  std::vector<ChosenPoint> points;
  std::size_t label = 0;
  for (std::size_t f = 0; f < result.fronts.size(); ++f) {
    for (std::size_t k = 0; k < result.fronts[f].points.size(); ++k) {
      const FrontPoint& point = result.fronts[f].points[k];
      ++label;
      if (point.fresh && point.fresh->failures > 0) continue;
      values.push_back(minimised(tuning, point.fresh.value_or(point.tuned)));
      points.push_back({f, k, label});
    }
  }
  std::vector<PlotRange> ranges(tuning.objectives.size());
  for (const auto& all : values) {
    for (std::size_t i = 0; i < all.size(); ++i) ranges[i].add(all[i]);
  }
  std::optional<ChosenPoint> chosen;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < points.size(); ++k) {
    double distance = 0.0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double width = ranges[i].high - ranges[i].low;
      const double part = width > 0.0 ? (values[k][i] - ranges[i].low) / width : 0.0;
      distance += part * part;
    }
    if (distance < least) {
      least = distance;
      chosen = points[k];
    }
  }
  return chosen;
}

// Four digits: the axis of a front may be so short that three are all the same.
std::string short_text(double value) {
  return fmt::format("{:.4g}", value);
}

// "Point 3 of hpfc-2N is the best compromise, …: Peak force, filtered 2.3 N (95 %: 2.2 to 2.4), …".
std::string in_words(const Tuning& tuning, const TuningResult& result, const ChosenPoint& chosen) {
  const TunedFront& front = result.fronts[chosen.front];
  const FrontPoint& point = front.points[chosen.point];
  const Evaluation& shown = point.fresh ? *point.fresh : point.tuned;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < tuning.objectives.size(); ++i) {
    const std::string& metric = tuning.objectives[i].metric;
    const GatheredValue& value = shown.objectives[i];
    const std::string unit = unit_of(metric);
    std::string text = fmt::format("{} {}{}", metric_label(metric, unit), short_text(value.value),
                                   unit_after(unit));
    if (value.interval) {
      text += fmt::format(" (95 %: {} to {})", short_text(value.interval->lower),
                          short_text(value.interval->upper));
    }
    parts.push_back(text);
  }
  return fmt::format(
      "Point {} of {} is the best compromise{}, nearest to the best value of every objective: {}.",
      chosen.label, front.case_name, point.fresh ? " on fresh worlds" : "", fmt::join(parts, ", "));
}

mustache::data drawing(const std::string& svg) {
  mustache::data data;
  data.set("svg", svg);
  return data;
}

mustache::data legend(const TuningResult& result, const std::vector<Identity>& looks) {
  mustache::data list(mustache::data::type::list);
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    mustache::data one;
    one.set("series", series_class(looks[c]));
    one.set("spot", spot_path(0.0, 0.0, looks[c]));
    one.set("case", result.fronts[c].case_name);
    one.set("size", std::to_string(result.fronts[c].points.size()));
    one.set("evaluations", std::to_string(result.fronts[c].evaluations.size()));
    const auto& evaluations = result.fronts[c].evaluations;
    one.set("feasible", std::to_string(std::count_if(evaluations.begin(), evaluations.end(),
                                                     [](const Evaluation& evaluation) {
                                                       return evaluation.is_feasible();
                                                     })));
    one.set("reached", result.fronts[c].progress.empty()
                           ? "-"
                           : fmt::format("{:.5g}", result.fronts[c].progress.back().second));
    list << one;
  }
  return list;
}

// The reference point of the hypervolume: "peak_N = 12, free_motion_s = 1.5".
std::string reference_text(const Tuning& tuning, const TuningResult& result) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < result.reference.size(); ++i) {
    const Objective& objective = tuning.objectives[i];
    const double sign = objective.goal == Goal::max ? -1.0 : 1.0;
    parts.push_back(fmt::format("{} = {:.5g}", objective.metric, sign * result.reference[i]));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Whole numbers are counts, and stay as they are.
std::string readable(const std::string& cell) {
  return cell.find('.') == std::string::npos ? cell : in_short(cell, kDigits);
}

mustache::data front_rows(const FrontTable& table, const std::string& chosen) {
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
    line.set("is_chosen", row.label == chosen);
    rows << line;
  }
  return rows;
}

// The header and the rows of a table.
mustache::data ranking_rows(const std::vector<std::vector<std::string>>& table) {
  mustache::data rows(mustache::data::type::list);
  for (const std::vector<std::string>& texts : table) {
    mustache::data cells(mustache::data::type::list);
    for (const std::string& text : texts) cells << mustache::data("text", text);
    rows << mustache::data("cells", cells);
  }
  return rows;
}

}  // namespace

void write_tuning_report(const Catalogue& catalogue, const TuningPlan& plan,
                         const TuningResult& result, const std::optional<Ranking>& ranking,
                         const std::filesystem::path& folder) {
  const Tuning& tuning = plan.tuning();
  const FrontTable table = front_table(plan, result, ranking);
  std::vector<std::string> names;
  for (const TunedFront& front : result.fronts) names.push_back(front.case_name);
  const std::vector<Identity> looks =
      candidate_identities(names, cases_of(catalogue, tuning.scenario));
  mustache::data data;
  data.set("title", "Tuning of " + tuning.scenario);
  mustache::data toc(mustache::data::type::list);
  const bool has_front = tuning.has_front();
  for (const auto& [href, label] :
       {std::pair("front", has_front ? "Pareto front" : "Tuned cases"),
        {"budget", "Progress over the budget"},
        {"points", has_front ? "Points of the front" : "Tuned values"}}) {
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
  const auto chosen = has_front ? chosen_point(tuning, result) : std::nullopt;
  std::string label = chosen ? std::to_string(chosen->label) : "";
  if (!has_front && !table.rows.empty()) label = table.rows.front().label;
  if (!label.empty()) {
    mustache::data lead;
    lead.set("text",
             chosen ? in_words(tuning, result, *chosen) : tuned_sentence(plan, result, ranking));
    lead.set("label", label);
    data.set("chosen", lead);
  }
  data.set("has_front", has_front);
  data.set("kind", has_front ? "front" : "tuned");
  data.set("progress", has_front ? "hypervolume" : "best value");
  data.set("is_ranked", ranking.has_value());
  if (ranking) data.set("ranking", ranking_rows(ranking_table(*ranking)));
  data.set("cases", legend(result, looks));
  if (has_front && !table.rows.empty()) {
    mustache::data reference;
    reference.set("text", reference_text(tuning, result));
    data.set("reference", reference);
  }
  if (tuning.objectives.size() > 1 && !table.rows.empty()) {
    data.set("front", drawing(front_chart(plan, result, looks, chosen ? chosen->label : 0)));
  }
  if (!table.rows.empty()) data.set("volumes", drawing(progress_chart(tuning, result, looks)));
  mustache::data columns(mustache::data::type::list);
  for (const std::string& name : table.columns) {
    mustache::data one;
    one.set("name", name);
    columns << one;
  }
  data.set("columns", columns);
  data.set("rows", front_rows(table, label));
  replace_file(folder / "report.html", html_page("tuning", data, PageCharts::drawn));
}

}  // namespace breakwater
