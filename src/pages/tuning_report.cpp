#include <breakwater/pages/study_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include <breakwater/config/names.h>
#include <breakwater/pages/page_chart.h>
#include <breakwater/pictures/staging.h>
#include <breakwater/record/partial_file.h>
#include <breakwater/shell/table.h>
#include <breakwater/study/comparison_table.h>

namespace breakwater {
namespace {

using Mark = std::tuple<double, double, std::string>;

// Adds marks in the order of x.
void add_marks(ChartSeries& to, std::vector<Mark> marks) {
  std::ranges::sort(marks);
  for (const auto& [x, y, name] : marks) {
    to.values.times_s.push_back(x);
    to.values.values.push_back(y);
    to.names.push_back(name);
  }
}

// The points of all cases as the search measured them, and on fresh worlds.
PageChart front_chart(const Tuning& tuning, const TuningResult& result,
                      const std::vector<LineStyle>& looks) {
  const auto title = [&](const Objective& one) {
    return fmt::format("{}, {}", one.metric, name_of(over_names(), one.over));
  };
  PageChart chart{.id = "fronts", .group = "fronts", .title = title(tuning.objectives[1])};
  chart.x_title = title(tuning.objectives[0]);
  std::size_t number = 0;
  for (std::size_t c = 0; c < result.fronts.size(); ++c) {
    const TunedFront& front = result.fronts[c];
    // With three objectives the front is not a line.
    ChartSeries tuned{.label = front.case_name,
                      .style = looks[c],
                      .has_line = tuning.objectives.size() == 2,
                      .marks = "dot"};
    ChartSeries fresh{.label = front.case_name + ", fresh",
                      .style = looks[c],
                      .has_line = false,
                      .marks = "cross"};
    std::vector<Mark> dots, crosses;
    for (const FrontPoint& point : front.points) {
      const std::string name = fmt::format("(point {})", ++number);
      const auto mark = [&](const Evaluation& one) {
        return Mark(one.objectives[0].value, one.objectives[1].value, name);
      };
      dots.push_back(mark(point.tuned));
      if (point.fresh && point.fresh->failures == 0) crosses.push_back(mark(*point.fresh));
    }
    add_marks(tuned, dots);
    add_marks(fresh, crosses);
    for (ChartSeries* const series : {&tuned, &fresh}) {
      if (!series->names.empty()) chart.series.push_back(*series);
    }
  }
  return chart.scaled();
}

constexpr std::size_t kMostPrinted = 12;  // points of a front without validation, in a terminal

// The points or tuned cases, each objective as tuned and on fresh worlds.
PageData points_table(const std::vector<std::string>& columns, const std::vector<FrontRow>& rows) {
  std::vector<std::string> shown, heads;
  for (const std::string& column : columns) {
    const bool is_end = column.ends_with("_fresh_lower") || column.ends_with("_fresh_upper");
    const bool has_any = std::ranges::any_of(rows, [&](const FrontRow& row) {
      const std::string text = row.cells.at(column);
      return !text.empty() && (!column.starts_with("fresh_") || text != "0");
    });
    if (is_end || !has_any || column == "evaluation") continue;
    shown.push_back(column);
    heads.push_back(column.ends_with("_fresh") ? "on fresh worlds" : column);
  }
  std::vector<std::vector<std::string>> table = {heads};
  for (const FrontRow& row : rows) {
    auto& cells = table.emplace_back();
    for (const std::string& column : shown) cells.push_back(row.cells.shown(column));
  }
  return text_table("What was found", table);
}

}  // namespace

void write_tuning_report(const Catalogue& catalogue, const TuningPlan& plan,
                         const TuningResult& result, const FrontTable& table,
                         const std::filesystem::path& folder) {
  const Tuning& tuning = plan.tuning();
  const auto& ranking = table.ranking;
  std::vector<std::string> names;
  for (const TunedFront& front : result.fronts) names.push_back(front.case_name);
  const std::vector<LineStyle> looks =
      candidate_styles(names, cases_of(catalogue, tuning.scenario));
  const bool has_front = tuning.has_front();
  const std::string kind = has_front ? "front" : "tuned";
  const std::string run = "breakwater run " + tuning.scenario + " --config " + kind + "/";
  auto lead = PageData::array();
  if (has_front || ranking) {
    add_block(lead, "finding",
              has_front
                  ? fmt::format("The Pareto front has {}.", number_of(table.rows.size(), "point"))
                  : ranking_sentence(*ranking));
  }
  if (!table.rows.empty()) add_block(lead, "command", run + table.rows.front().label + ".toml");
  std::size_t judged = 0, broken = 0;
  for (const TunedFront& front : result.fronts) {
    for (const FrontPoint& point : front.points) {
      if (!point.fresh || point.fresh->failures > 0) continue;
      ++judged;
      broken += point.fresh->is_feasible() ? 0 : 1;
    }
  }
  if (broken > 0) {
    add_block(lead, "finding",
              fmt::format("Constraints broken on fresh worlds: {} of {} points (fresh_violation).",
                          broken, judged));
  }
  auto blocks = PageData::array();
  const auto add = [&blocks](const char* name, const PageData& value) {
    add_block(blocks, name, value);
  };
  if (ranking) add("table", text_table("Ranking", ranking_table(*ranking)));
  if (tuning.objectives.size() > 1 && !table.rows.empty()) {
    add("figures",
        PageData::array({figure_of(
            front_chart(tuning, result, looks), "",
            "A dot is a point as the search measured it; a cross is the same point on fresh "
            "worlds.")}));
  }
  for (const TunedFront& front : result.fronts) {
    add("text", fmt::format("{}: {} of {} evaluations are feasible.", front.case_name,
                            std::ranges::count_if(front.evaluations, &Evaluation::is_feasible),
                            front.evaluations.size()));
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
  add_section(sections, "front", has_front ? "Pareto front" : "Tuned cases",
              std::exchange(blocks, PageData::array()));
  add("text", has_front
                  ? fmt::format("front/N.toml is point N: {}N.toml. front.csv has all digits.", run)
                  : "tuned/CASE.toml is a tuned case. A key in at_bound has its best value "
                    "at a bound of its range: a better one may lie beyond. tuned.csv has all "
                    "digits.");
  add("table", points_table(table.columns, table.rows));
  add_section(sections, "points", has_front ? "Points of the front" : "Tuned values", blocks);
  replace_file(folder / "report.html",
               html_page("tuning", {{"title", "Tuning of " + tuning.scenario},
                                    {"lead", lead},
                                    {"sections", sections}}));
}

std::string tuning_text(const TuningPlan& plan, const FrontTable& table, std::size_t width) {
  std::vector<FrontRow> rows = table.rows;
  std::string text;
  if (!plan.tuning().has_front()) {
    if (table.ranking) text = ranking_text(*table.ranking, width);
  } else if (plan.tuning().validation) {
    std::erase_if(rows, [](const FrontRow& row) { return row.cells.at("fresh_failures").empty(); });
  } else if (rows.size() > kMostPrinted) {
    rows.clear();
    for (const std::size_t i : evenly_spaced(table.rows.size(), kMostPrinted)) {
      rows.push_back(table.rows[i]);
    }
  }
  if (rows.empty()) return text;
  const std::size_t more = table.rows.size() - rows.size();
  return text + printed_table(points_table(table.columns, rows), width) +
         (more > 0 ? fmt::format("and {} more\n", more) : "");
}

}  // namespace breakwater
