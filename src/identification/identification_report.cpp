#include <breakwater/identification/identification_report.h>

#include <fmt/format.h>

#include <cmath>

#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/axis_parameters.h>
#include <breakwater/identification/identification_outputs.h>
#include <breakwater/pages/page_chart.h>

namespace breakwater {
namespace {

constexpr double kNormal99 = 2.5758293035489;

PageData figure(const std::string& caption, const std::string& note, const PageChart& chart) {
  PageData figure = {{"caption", caption}, {"note", note}, {"charts", PageData::array()}};
  figure["charts"].push_back(chart.json());
  return figure;
}

PageData parameters(const Identification& identification) {
  auto rows = PageData::array();
  for (const ParameterEstimate& estimate : identification.parameters) {
    // The ends of a narrow interval differ in their last digits.
    const auto shown = [&estimate](double value) {
      return estimate.is_identifiable ? fmt::format("{:.7g}", value) : "-";
    };
    PageData answer = {{"value", identifiable_text(identification, estimate)}};
    if (!estimate.is_identifiable) {
      answer["lines"].push_back(
          {{"text", fmt::format("{}. This would help: {}", estimate.reason, estimate.excitation)},
           {"kind", "spread"}});
    }
    rows.push_back(PageData::array({parameter_key(estimate.parameter), shown(estimate.value),
                                    shown(estimate.low), shown(estimate.high),
                                    parameter_unit(estimate.parameter), answer}));
  }
  return {{"label", "Parameters"},
          {"columns", {"parameter", "value", "low", "high", "unit", "identifiable"}},
          {"rows", rows}};
}

PageData errors(const Identification& identification) {
  auto rows = PageData::array();
  const auto add = [&](const char* name, const FitErrors& of) {
    rows.push_back(PageData::array({name, of.rms, of.plain_rms, of.normalised}));
  };
  add("records of the fit", identification.errors);
  if (identification.held_out) add("held-out records", *identification.held_out);
  return {{"label", "Errors"},
          {"columns", PageData::array({"", "RMS error [rad]", "of a plain model [rad]",
                                       "relative to what is explained"})},
          {"rows", rows}};
}

PageData fit_figures(const Identification& identification) {
  auto figures = PageData::array();
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
    const std::string number = std::to_string(++count);
    const std::string which =
        identification.data.stretches.size() > 1 ? ", stretch " + number : std::string();
    PageChart position{.id = "position-" + number, .group = "stretch-" + number};
    position.title = "position";
    position.series = {
        {.label = "measured",
         .unit = "rad",
         .values = {stretch.times_s, stretch.positions},
         .identity = 0},
        {.label = "fitted", .unit = "rad", .values = {stretch.times_s, fitted}, .identity = 1}};
    PageChart residual{.id = "residuals-" + number, .group = position.group, .title = "residual"};
    residual.series = {{.label = "residual",
                        .unit = "rad",
                        .values = {stretch.times_s, residuals},
                        .identity = 0}};
    residual.lines = {-identification.data.quantum, identification.data.quantum};
    figures.push_back(figure("Position" + which, "Measured, and the fit above it.", position));
    figures.push_back(figure("Residuals" + which,
                             "Measured minus fitted. The dashed lines are one count.", residual));
  }
  const double band = kNormal99 / std::sqrt(static_cast<double>(positions.size()));
  PageChart chart{.id = "correlation", .group = "correlation", .title = "correlation"};
  chart.x_title = "lag [rows]";
  chart.lines = {-band, 0.0, band};
  chart.series = {{.label = "correlation", .identity = 0, .marks = "dot"}};
  for (const double r : identification.whiteness.correlations) {
    Series& values = chart.series[0].values;
    values.times_s.push_back(static_cast<double>(values.times_s.size() + 1));
    values.values.push_back(r);
  }
  figures.push_back(figure(
      "Correlation of the residuals",
      fmt::format("Scores of the likelihood. White ones stay between the dashed lines (99 % each). "
                  "Ljung and Box: {:.4g}, limit {:.4g}: {}.",
                  identification.whiteness.statistic, identification.whiteness.limit,
                  identification.whiteness.is_white() ? "white" : "not white"),
      chart));
  return figures;
}

PageData profile_figures(const Identification& identification) {
  auto figures = PageData::array();
  for (const ParameterEstimate& estimate : identification.parameters) {
    if (estimate.profile.size() < 3 || !estimate.is_identifiable) continue;
    const std::string name = parameter_key(estimate.parameter);
    PageChart chart{.id = "profile-" + name, .group = "profile-" + name};
    chart.title = "rise of −2 ln L";
    chart.x_title = fmt::format("change [{}]", parameter_unit(estimate.parameter));
    chart.lines = {kChiSquare95};
    chart.series = {{.label = name, .identity = 0, .marks = "dot"}};
    // The differences fit the axis better than many equal digits.
    for (const auto& [value, rise] : estimate.profile) {
      chart.series[0].values.times_s.push_back(value - estimate.value);
      chart.series[0].values.values.push_back(rise);
    }
    figures.push_back(figure(
        name,
        fmt::format("Estimate {}. The interval ends at the dashed line.", text_of(estimate.value)),
        chart));
  }
  return figures;
}

}  // namespace

std::string parameter_table(const Identification& identification, std::size_t width) {
  return printed_table(parameters(identification), width);
}

PageData identification_result(const Identification& identification,
                               const std::vector<std::string>& warnings,
                               const std::string& command) {
  const bool is_axis = identification.data.model == &friction_axis();
  PageData lead = {
      {{"text", fmt::format("Inertia, friction and delay of one axis from recorded data. {} rows; "
                            "one count is {:.6g} rad, and the noise before the encoder is {:.6g} "
                            "rad.",
                            identification.data.rows(), identification.data.quantum,
                            identification.fit.noise_std)}}};
  const auto find = [&](const std::string& text) { lead.push_back(PageData{{"finding", text}}); };
  if (!identification.is_converged) find("The fit did not converge.");
  if (!identification.holds()) find("The held-out records disagree with the fit.");
  for (const std::string& text : identification.notes) find(text);
  for (const std::string& text : warnings) find(text);
  lead.push_back(PageData{{"command", command}});
  auto sections = PageData::array();
  const auto add = [&](const char* id, const char* heading, const PageData& blocks) {
    sections.push_back({{"id", id}, {"heading", heading}, {"blocks", blocks}});
  };
  add("parameters", "Parameters",
      {{{"table", parameters(identification)}},
       {{"text", fmt::format("From low to high: 95 %, by {}.", identification.is_bootstrapped
                                                                   ? "parametric bootstrap"
                                                                   : "profile likelihood")}}});
  add("errors", "Errors",
      {{{"table", errors(identification)}},
       {{"text",
         "The plain model has inertia and viscous friction alone. Noise, encoder and the "
         "intervals explain an error of 1; above 2 the held-out records disagree."}}});
  add("fit", "Fit and residuals", {{{"figures", fit_figures(identification)}}});
  const PageData profiles = profile_figures(identification);
  if (!profiles.empty()) {
    add("profiles", "Profiles of the likelihood", {{{"figures", profiles}}});
  }
  return {{"title", is_axis ? "Identification of an axis" : "Identification of a motor and a load"},
          {"lead", lead},
          {"sections", sections}};
}

}  // namespace breakwater
