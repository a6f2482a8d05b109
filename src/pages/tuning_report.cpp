#include <breakwater/pages/study_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include <breakwater/config/names.h>
#include <breakwater/experiment/saved_run.h>
#include <breakwater/pages/labels.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/search/tuning_outputs.h>
#include <breakwater/shell/table.h>
#include <breakwater/statistics/goal.h>
#include <breakwater/study/ranking_text.h>

namespace breakwater {
namespace {

constexpr int kDigits = 5;  // for readers

double value_of(const std::optional<Evaluation>& evaluation, std::size_t objective) {
  if (!evaluation || evaluation->failures > 0) return std::nan("");
  return evaluation->objectives[objective].value;
}

// The points of all cases as the search measured them, and on fresh worlds. `chosen` is a number.
PageChart front_chart(const Tuning& tuning, const TuningResult& result,
                      const std::vector<Identity>& looks, std::size_t chosen) {
  const auto title = [&](const Objective& one) {
    return fmt::format("{}, {}", metric_label_with_unit(one.metric, unit_of(one.metric)),
                       name_of(over_names(), one.over));
  };
  PageChart chart{.id = "fronts", .group = "fronts", .title = title(tuning.objectives[1])};
  chart.x_title = title(tuning.objectives[0]);
  ChartSeries ring{.label = "best compromise",
                   .identity = kReferenceIdentity,
                   .has_line = false,
                   .marks = "ring"};
  std::size_t number = 0;
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    const TunedFront& front = result.fronts[c];
    std::vector<std::tuple<double, double, std::string>> points, fresh;
    for (const FrontPoint& point : front.points) {
      const std::string name = fmt::format("(point {})", ++number);
      points.emplace_back(point.tuned.objectives[0].value, point.tuned.objectives[1].value, name);
      const double x = value_of(point.fresh, 0), y = value_of(point.fresh, 1);
      if (!std::isnan(x)) fresh.emplace_back(x, y, name);
      if (number != chosen) continue;
      ring.values = {{std::get<0>(points.back())}, {std::get<1>(points.back())}};
      ring.names = {name};
    }
    // With three objectives the front is not a line.
    ChartSeries tuned{.label = front.case_name,
                      .identity = looks[c],
                      .has_line = tuning.objectives.size() == 2,
                      .marks = "dot"};
    ChartSeries again{.label = front.case_name + ", fresh",
                      .identity = looks[c],
                      .has_line = false,
                      .marks = "cross"};
    for (auto [from, to] : {std::pair(&points, &tuned), std::pair(&fresh, &again)}) {
      std::ranges::sort(*from);
      for (const auto& [x, y, name] : *from) {
        to->values.times_s.push_back(x);
        to->values.values.push_back(y);
        to->names.push_back(name);
      }
      if (!from->empty()) chart.series.push_back(*to);
    }
  }
  if (!ring.names.empty()) chart.series.push_back(ring);
  return chart.scaled();
}

PageChart progress_chart(const Tuning& tuning, const TuningResult& result,
                         const std::vector<Identity>& looks) {
  const std::string& metric = tuning.objectives.front().metric;
  PageChart chart{.id = "progress", .group = "progress"};
  chart.title =
      tuning.has_front() ? "hypervolume" : metric_label_with_unit(metric, unit_of(metric));
  chart.x_title = "evaluations";
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    ChartSeries line{.label = result.fronts[c].case_name, .identity = looks[c]};
    for (const auto& [evaluations, volume] : result.fronts[c].progress) {
      line.values.times_s.push_back(static_cast<double>(evaluations));
      line.values.values.push_back(volume);
    }
    chart.series.push_back(line);
  }
  return chart.scaled();
}

// The point that is nearest to the best of all objectives, each over its range on the fronts: of
// fresh worlds where they were met.
struct ChosenPoint {
  std::size_t front = 0, point = 0;
  std::size_t label = 0;  // from 1; 0: there is none
};
ChosenPoint chosen_point(const Tuning& tuning, const TuningResult& result) {
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
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, double>> ranges(tuning.objectives.size(), {infinity, -infinity});
  for (const auto& all : values) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      ranges[i] = {std::min(ranges[i].first, all[i]), std::max(ranges[i].second, all[i])};
    }
  }
  ChosenPoint chosen;
  double least = infinity;
  for (std::size_t k = 0; k < points.size(); ++k) {
    double distance = 0.0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const auto [low, high] = ranges[i];
      const double part = high > low ? (values[k][i] - low) / (high - low) : 0.0;
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
    const EstimatedValue& value = shown.objectives[i];
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

PageData cases_table(const Tuning& tuning, const TuningResult& result,
                     const std::vector<Identity>& looks) {
  PageData columns = {"case", "evaluations", "feasible"};
  if (tuning.has_front()) columns.push_back("points on the front");
  columns.push_back(tuning.has_front() ? "hypervolume" : "best value");
  auto rows = PageData::array();
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    const TunedFront& front = result.fronts[c];
    PageData row = {{{"value", front.case_name}, {"look", series_class(looks[c])}},
                    front.evaluations.size(),
                    std::ranges::count_if(front.evaluations, &Evaluation::is_feasible)};
    if (tuning.has_front()) row.push_back(front.points.size());
    row.push_back(front.progress.empty() ? PageData() : PageData(front.progress.back().second));
    rows.push_back(row);
  }
  return {{"label", "Cases"}, {"columns", columns}, {"rows", rows}};
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

PageData points_table(const FrontTable& table, const std::string& chosen) {
  auto rows = PageData::array();
  for (const FrontRow& row : table.rows) {
    auto cells = PageData::array();
    for (const std::string& cell : row.cells.in(table.columns)) cells.push_back(readable(cell));
    rows.push_back(cells);
    if (row.label != chosen) continue;
    for (PageData& cell : rows.back()) cell = {{"value", cell}, {"tone", "chosen"}};
  }
  return {{"label", "What was found"}, {"columns", table.columns}, {"rows", rows}};
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
  const bool has_front = tuning.has_front();
  const ChosenPoint chosen = has_front ? chosen_point(tuning, result) : ChosenPoint{};
  std::string label = chosen.label > 0 ? std::to_string(chosen.label) : "";
  if (!has_front && !table.rows.empty()) label = table.rows.front().label;
  const std::string kind = has_front ? "front" : "tuned";
  const std::string run = "breakwater run " + tuning.scenario + " --config " + kind + "/";
  auto lead = PageData::array();
  if (!label.empty()) {
    lead = {{{"finding", chosen.label > 0 ? in_words(tuning, result, chosen)
                                          : tuned_sentence(plan, result, ranking)}},
            {{"command", run + label + ".toml"}}};
  }
  auto blocks = PageData::array();
  const auto add = [&blocks](const char* name, const PageData& value) {
    add_block(blocks, name, value);
  };
  if (ranking) add("table", text_table("Ranking", ranking_table(*ranking)));
  if (tuning.objectives.size() > 1 && !table.rows.empty()) {
    add("figures",
        PageData::array({figure_of(
            front_chart(tuning, result, looks, chosen.label), "",
            "The ring marks the best compromise. A dot is a point as the search measured "
            "it; a cross is the same point on fresh worlds.")}));
  }
  add("table", cases_table(tuning, result, looks));
  if (has_front && !table.rows.empty()) {
    add("text", "Hypervolumes have the reference point " + reference_text(tuning, result) + ".");
  }
  add("text",
      fmt::format(
          "{}, {} evaluations of each case, each evaluation in {} (seeds included). {}",
          name_of(search_algorithms(), tuning.algorithm), tuning.budget,
          number_of(tuning.worlds.size(), "world"),
          tuning.validation
              ? fmt::format("{} were run again in {} that the search did not have: “fresh”.",
                            has_front ? "Points of the front" : "The best candidates",
                            number_of(tuning.validation->size(), "world"))
              : "Nothing was validated: the numbers are those that were tuned on, and so too "
                "good."));
  auto sections = PageData::array();
  sections.push_back({{"id", "front"},
                      {"heading", has_front ? "Pareto front" : "Tuned cases"},
                      {"blocks", std::exchange(blocks, PageData::array())}});
  if (!table.rows.empty()) {
    add("figures", PageData::array({figure_of(
                       progress_chart(tuning, result, looks), "",
                       fmt::format("A line that still {} at its end says that the budget "
                                   "was small.",
                                   has_front ? "climbs" : "changes"))}));
  }
  sections.push_back({{"id", "budget"},
                      {"heading", "Progress over the budget"},
                      {"blocks", std::exchange(blocks, PageData::array())}});
  add("text", has_front
                  ? fmt::format("front/N.toml is point N: {}N.toml. front.csv has all digits.", run)
                  : "tuned/CASE.toml is a tuned case. A key in at_bound has its best value "
                    "at a bound of its range: a better one may lie beyond. tuned.csv has all "
                    "digits.");
  add("table", points_table(table, label));
  sections.push_back({{"id", "points"},
                      {"heading", has_front ? "Points of the front" : "Tuned values"},
                      {"blocks", blocks}});
  replace_file(folder / "report.html",
               html_page("tuning", {{"title", "Tuning of " + tuning.scenario},
                                    {"lead", lead},
                                    {"sections", sections}}));
}

}  // namespace breakwater
