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
namespace mustache = kainjow::mustache;
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

// A page and a terminal have their own forms of a number.
std::string in_words(const std::optional<double>& value, std::string (*form)(double)) {
  return value ? form(*value) : "does not end";
}

struct Row {
  const char* name;
  const char* unit;
  std::optional<double> simulated;
  std::optional<double> measured;
};

std::array<Row, 3> rows_of(const ImpactComparison& comparison) {
  const ImpactPulse& s = comparison.simulated();
  const ImpactPulse& m = comparison.measured();
  return {Row{"peak", "N", s.peak_N, m.peak_N}, Row{"duration", "s", s.duration_s, m.duration_s},
          Row{"impulse", "N s", s.impulse_Ns, m.impulse_Ns}};
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

std::string ImpactComparison::text(std::size_t width) const {
  Table table({"first contact", "unit", "simulated", "measured", "difference"});
  for (const Row& row : rows_of(*this)) {
    table.add({row.name, row.unit, in_words(row.simulated, in_digits),
               in_words(row.measured, in_digits),
               differences_in_words({row.simulated, row.measured}).back()});
  }
  table.add({"RMSE", "N", in_digits(rmse_N_), "", ""});
  return table.print(width);
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
  mustache::data page;
  mustache::data rows(mustache::data::type::list);
  for (const Row& row : rows_of(*this)) {
    mustache::data entry;
    entry.set("name", row.name);
    entry.set("unit", row.unit);
    entry.set("simulated", in_words(row.simulated, format_number));
    entry.set("measured", in_words(row.measured, format_number));
    entry.set("difference", differences_in_words({row.simulated, row.measured}).back());
    rows << entry;
  }
  PageChart chart;
  chart.id = "forces";
  chart.group = chart.axis = "measured";
  chart.title = "force since the first contact";
  chart.from_s = -0.25 * window_s_;
  chart.to_s = 1.5 * window_s_;
  chart.series = {{.label = "simulated", .unit = "N", .description = signal_, .values = simulated_},
                  {.label = "measured", .unit = "N", .description = file_, .values = measured_}};
  mustache::data charts(mustache::data::type::list);
  charts << chart_data(chart);
  page.set("title", "measured and simulated impact");
  page.set("run", run_);
  page.set("file", file_);
  page.set("signal", signal_);
  page.set("rmse", format_number(rmse_N_));
  page.set("toc", mustache::data(mustache::data::type::list));
  page.set("rows", rows);
  page.set("charts", charts);
  return html_page("measured", page);
}

}  // namespace breakwater
