#include <breakwater/pages/measured_impact.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <breakwater/pages/compare.h>
#include <breakwater/pages/html_page.h>
#include <breakwater/shell/digits.h>
#include <breakwater/shell/table.h>

namespace breakwater {
namespace {

ImpactPulse pulse_of(const Series& force, const std::string& whose,
                     const std::optional<double>& contact_s = {}) {
  try {
    return first_pulse(force, contact_s);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(whose + ": " + error.what());
  }
}

Series since(Series series, double begin_s) {
  for (double& time_s : series.times_s) time_s -= begin_s;
  return series;
}

Series until(Series series, double end_s) {
  const auto end = std::upper_bound(series.times_s.begin(), series.times_s.end(), end_s);
  series.values.resize(static_cast<std::size_t>(end - series.times_s.begin()));
  series.times_s.resize(series.values.size());
  return series;
}

// The last instant before the first contact, by the true contact force, if the log has it.
std::optional<double> contact_s(const SavedRun& run) {
  for (const char* name : {"physics/force_true_N", "force_true_N"}) {
    if (!run.has_signal(name)) continue;
    const Series force = run.signal(name);
    const auto first = std::find_if(force.values.begin(), force.values.end(),
                                    [](double force_N) { return force_N > 0.0; });
    if (first == force.values.begin() || first == force.values.end()) continue;
    return force.times_s[static_cast<std::size_t>(first - force.values.begin()) - 1];
  }
  return {};
}

}  // namespace

ImpactComparison::ImpactComparison(const SavedRun& run, const std::string& signal,
                                   const std::string& file)
    : run_(run.folder().string()), signal_(signal), file_(file) {
  if (!run.has_signal(signal)) {
    throw std::invalid_argument(run_ + ": the log has no signal " + signal +
                                ": say with --signal which one is the force");
  }
  const Series simulated = run.signal(signal);
  const Series measured = read_measured_force(file);
  const std::optional<double> contact = contact_s(run);
  const bool is_fine = signal.starts_with("physics/");
  const std::string whose =
      run_ + ": " + signal +
      (is_fine ? " (logged from record.fine_from_s to record.fine_to_s)" : "");
  measured_pulse_ = pulse_of(measured, file);
  simulated_pulse_ = pulse_of(simulated, whose, contact);
  if (simulated_pulse_.duration_s && measured_pulse_.duration_s) {
    window_s_ = std::max(*simulated_pulse_.duration_s, *measured_pulse_.duration_s);
  } else {
    window_s_ = std::min(measured.times_s.back() - measured_pulse_.begin_s,
                         simulated.times_s.back() - simulated_pulse_.begin_s);
    if (!simulated_pulse_.duration_s) {
      const Series beside = until(simulated, simulated_pulse_.begin_s + window_s_);
      simulated_pulse_ = pulse_of(beside, whose, contact);
    }
  }
  simulated_ = since(simulated, simulated_pulse_.begin_s);
  measured_ = since(measured, measured_pulse_.begin_s);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < measured_.times_s.size(); ++i) {
    const double time_s = measured_.times_s[i];
    if (time_s < 0.0 || time_s > window_s_) continue;
    sum += std::pow(simulated_.at(time_s) - measured_.values[i], 2);
    ++count;
  }
  rmse_N_ = std::sqrt(sum / static_cast<double>(count));
}

PageData ImpactComparison::table() const {
  const ImpactPulse &s = simulated_pulse_, &m = measured_pulse_;
  auto rows = PageData::array();
  const auto add = [&rows](const char* name, const char* unit, const std::optional<double>& one,
                           const std::optional<double>& other) {
    const auto shown = [](const std::optional<double>& value) {
      return value ? PageData(*value) : PageData("does not end");
    };
    rows.push_back(PageData::array(
        {name, unit, shown(one), shown(other), differences_in_words({one, other}).back()}));
  };
  add("peak", "N", s.peak_N, m.peak_N);
  add("duration", "s", s.duration_s, m.duration_s);
  add("impulse", "N s", s.impulse_Ns, m.impulse_Ns);
  rows.push_back(PageData::array({"RMSE", "N", rmse_N_, "", ""}));
  return {{"label", "First contact"},
          {"columns",
           PageData::array({"first contact", "unit", "simulated", "measured", "difference"})},
          {"rows", rows}};
}

std::string ImpactComparison::text(std::size_t width) const {
  return printed_table(table(), width);
}

std::string ImpactComparison::json() const {
  nlohmann::ordered_json json;
  for (const auto& [name, pulse] :
       {std::pair("simulated", simulated_pulse_), std::pair("measured", measured_pulse_)}) {
    json[name] = {
        {"peak_N", pulse.peak_N}, {"duration_s", nullptr}, {"impulse_Ns", pulse.impulse_Ns}};
    if (pulse.duration_s) json[name]["duration_s"] = *pulse.duration_s;
  }
  json["rmse_N"] = rmse_N_;
  return json.dump(2) + "\n";
}

std::string ImpactComparison::html() const {
  PageChart chart;
  chart.id = "forces";
  chart.group = chart.axis = "measured";
  chart.title = "force since the first contact";
  chart.from_s = -0.25 * window_s_;
  chart.to_s = 1.5 * window_s_;
  chart.series = {{.label = "simulated", .unit = "N", .description = signal_, .values = simulated_},
                  {.label = "measured", .unit = "N", .description = file_, .values = measured_}};
  PageData figure = {{"charts", PageData::array({chart.json()})}};
  auto sections = PageData::array();
  sections.push_back({{"id", "signals"},
                      {"heading", "Force"},
                      {"blocks", {{{"figures", PageData::array({figure})}}}}});
  sections.push_back(
      {{"id", "numbers"}, {"heading", "First contact"}, {"blocks", {{{"table", table()}}}}});
  return html_page("measured", {{"title", "measured and simulated impact"},
                                {"lead",
                                 {{{"about", fmt::format("Run {}, signal {}, and {}, aligned at "
                                                         "the first contact.",
                                                         run_, signal_, file_)}}}},
                                {"sections", sections}});
}

}  // namespace breakwater
