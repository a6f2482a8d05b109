#include <breakwater/identification/identification_report.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>

#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/axis_parameters.h>
#include <breakwater/identification/identification_outputs.h>
#include <breakwater/pages/decimation.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/pages/svg_plot.h>

namespace breakwater {
namespace mustache = kainjow::mustache;
namespace {

constexpr PlotArea kArea{58.0, 408.0, 12.0, 210.0};
constexpr double kWidth = 420.0, kHeight = 250.0;
constexpr std::size_t kBuckets = 400;
constexpr double kNormal99 = 2.5758293035489;

struct Line {
  Identity look;
  std::vector<PlotPoint> points;
  bool has_dots = false;
};

// Lines, and horizontal lines at `levels`.
std::string draw_lines(const std::string& x_title, const std::string& y_title,
                       const std::vector<Line>& lines, const std::vector<double>& levels) {
  PlotRange across, up;
  for (const Line& line : lines) {
    for (const auto& [x, y] : line.points) {
      across.add(x);
      up.add(y);
    }
  }
  for (const double level : levels) up.add(level);
  if (across.is_empty() || up.is_empty()) return "";
  const ChartScale x(across.low, across.high, false, kArea.left + 6.0, kArea.right - 6.0);
  const ChartScale y(up.low, up.high, false, kArea.bottom - 5.0, kArea.top + 5.0);
  SvgPlot plot("lines", kWidth, kHeight, y_title + " over " + x_title);
  plot.y_grid(kArea, y);
  plot.frame(kArea);
  plot.x_ticks(kArea, x, 4);
  plot.x_title(kArea, x_title);
  plot.y_title(kArea, y_title);
  for (const double level : levels) {
    plot.path("line " + series_class(kReferenceIdentity),
              line_path({{kArea.left, y(level)}, {kArea.right, y(level)}}));
  }
  for (const Line& line : lines) {
    std::vector<PlotPoint> points;
    std::string dots;
    for (const auto& [a, b] : line.points) {
      points.emplace_back(x(a), y(b));
      if (line.has_dots) dots += svg_dot(x(a), y(b));
    }
    plot.path("line " + series_class(line.look), line_path(points));
    if (line.has_dots) {
      plot.add(fmt::format("<g class=\"m {}\">{}</g>", series_class(line.look), dots));
    }
  }
  return plot.svg();
}

std::vector<PlotPoint> points_of(const std::vector<double>& times, std::vector<double> values) {
  const Series few = decimate({times, std::move(values)}, kBuckets);
  std::vector<PlotPoint> points;
  for (std::size_t k = 0; k < few.times_s.size(); ++k) {
    points.emplace_back(few.times_s[k], few.values[k]);
  }
  return points;
}

std::string number(double value) {
  return fmt::format("{:.6g}", value);
}

mustache::data parameter_rows(const Identification& identification) {
  mustache::data rows(mustache::data::type::list);
  for (const ParameterEstimate& estimate : identification.parameters) {
    mustache::data row;
    const auto shown = [&estimate](double value) {
      return estimate.is_identifiable ? number(value) : std::string("–");
    };
    row.set("name", parameter_key(estimate.parameter));
    row.set("value", shown(estimate.value));
    row.set("low", shown(estimate.low));
    row.set("high", shown(estimate.high));
    row.set("unit", parameter_unit(estimate.parameter));
    row.set("identifiable",
            estimate.is_identifiable
                ? identifiable_text(identification, estimate)
                : fmt::format("no: {}. This would help: {}", estimate.reason, estimate.excitation));
    rows << row;
  }
  return rows;
}

mustache::data error_rows(const Identification& identification) {
  mustache::data rows(mustache::data::type::list);
  const auto add = [&](const char* name, const FitErrors& errors) {
    mustache::data row;
    row.set("name", name);
    row.set("rms", number(errors.rms));
    row.set("plain", number(errors.plain_rms));
    row.set("normalised", fmt::format("{:.3g}", errors.normalised));
    rows << row;
  };
  add("records of the fit", identification.errors);
  if (identification.held_out) add("held-out records", *identification.held_out);
  return rows;
}

void chart(mustache::data& list, const std::string& title, const std::string& about,
           const std::string& svg) {
  if (svg.empty()) return;
  mustache::data one;
  one.set("title", title);
  one.set("about", about);
  one.set("svg", svg);
  list << one;
}

mustache::data fit_charts(const Identification& identification) {
  mustache::data charts(mustache::data::type::list);
  const std::vector<double> positions = fitted_positions(identification.data, identification.fit);
  std::size_t from = 0;
  std::size_t count = 0;
  for (const AxisStretch& stretch : identification.data.stretches) {
    const auto first = positions.begin() + static_cast<std::ptrdiff_t>(from);
    const std::vector<double> fitted(first,
                                     first + static_cast<std::ptrdiff_t>(stretch.times_s.size()));
    std::vector<double> residuals;
    for (std::size_t k = 0; k < fitted.size(); ++k) {
      residuals.push_back(stretch.positions[k] - fitted[k]);
    }
    from += fitted.size();
    const std::string which = identification.data.stretches.size() > 1
                                  ? fmt::format(", stretch {}", ++count)
                                  : std::string();
    chart(charts, "Position" + which, "Measured, and the fit above it.",
          draw_lines("t [s]", "position [rad]",
                     {{0, points_of(stretch.times_s, stretch.positions)},
                      {1, points_of(stretch.times_s, fitted)}},
                     {}));
    chart(charts, "Residuals" + which, "Measured minus fitted. The dashed lines are one count.",
          draw_lines("t [s]", "residual [rad]", {{0, points_of(stretch.times_s, residuals)}},
                     {-identification.data.quantum, identification.data.quantum}));
  }
  std::vector<PlotPoint> correlations;
  for (const double r : identification.whiteness.correlations) {
    correlations.emplace_back(static_cast<double>(correlations.size() + 1), r);
  }
  const double band = kNormal99 / std::sqrt(static_cast<double>(positions.size()));
  chart(
      charts, "Correlation of the residuals",
      fmt::format("Scores of the likelihood. White ones stay between the dashed lines (99 % each). "
                  "Ljung and Box: {:.4g}, limit {:.4g}: {}.",
                  identification.whiteness.statistic, identification.whiteness.limit,
                  identification.whiteness.is_white() ? "white" : "not white"),
      draw_lines("lag [rows]", "correlation", {{0, correlations, true}}, {-band, 0.0, band}));
  return charts;
}

mustache::data profile_charts(const Identification& identification) {
  mustache::data charts(mustache::data::type::list);
  for (const ParameterEstimate& estimate : identification.parameters) {
    if (estimate.profile.size() < 3 || !estimate.is_identifiable) continue;
    // The differences fit the axis better than many equal digits.
    std::vector<PlotPoint> points;
    for (const auto& [value, rise] : estimate.profile) {
      points.emplace_back(value - estimate.value, rise);
    }
    chart(charts, parameter_key(estimate.parameter),
          fmt::format("Estimate {}. The interval ends at the dashed line.", number(estimate.value)),
          draw_lines(fmt::format("change [{}]", parameter_unit(estimate.parameter)),
                     "rise of −2 ln L", {{0, points, true}}, {kChiSquare95}));
  }
  return charts;
}

}  // namespace

std::string identification_report(const Identification& identification,
                                  const std::string& command) {
  mustache::data page;
  const bool is_axis = identification.data.model == &friction_axis();
  page.set("title", is_axis ? "Identification of an axis" : "Identification of a motor and a load");
  page.set("command", command);
  page.set("method",
           identification.is_bootstrapped ? "parametric bootstrap" : "profile likelihood");
  page.set("quantum", number(identification.data.quantum));
  page.set("noise", number(identification.fit.noise_std));
  page.set("rows", std::to_string(identification.data.rows()));
  mustache::data notes(mustache::data::type::list);
  const auto note = [&](const std::string& text) {
    mustache::data entry;
    entry.set("text", text);
    notes << entry;
  };
  if (!identification.is_converged) note("The fit did not converge.");
  if (!identification.holds()) note("The held-out records disagree with the fit.");
  for (const std::string& text : identification.notes) note(text);
  page.set("notes", notes);
  mustache::data toc(mustache::data::type::list);
  const auto contents = [&](const char* href, const char* label) {
    mustache::data entry;
    entry.set("href", href);
    entry.set("label", label);
    toc << entry;
  };
  contents("parameters", "Parameters");
  contents("errors", "Errors");
  contents("fit", "Fit and residuals");
  page.set("parameters", parameter_rows(identification));
  page.set("errors", error_rows(identification));
  page.set("charts", fit_charts(identification));
  const bool has_profiles =
      std::any_of(identification.parameters.begin(), identification.parameters.end(),
                  [](const ParameterEstimate& estimate) { return estimate.profile.size() >= 3; });
  if (has_profiles) contents("profiles", "Profiles of the likelihood");
  page.set("has_profiles", has_profiles);
  page.set("profiles", profile_charts(identification));
  page.set("toc", toc);
  return html_page("identified", page, PageCharts::drawn);
}

}  // namespace breakwater
