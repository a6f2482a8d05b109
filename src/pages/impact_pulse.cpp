#include <breakwater/pages/impact_pulse.h>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include <breakwater/config/column_table.h>

namespace breakwater {
namespace {

// The time at which a straight line between two samples has a value.
double crossing_s(const Series& force, std::size_t after, double value) {
  const double part =
      (value - force.values[after - 1]) / (force.values[after] - force.values[after - 1]);
  return force.times_s[after - 1] + part * (force.times_s[after] - force.times_s[after - 1]);
}

// The first sample from `from` on that is above the threshold, or not.
std::size_t first_where(const Series& force, std::size_t from, double threshold, bool is_above) {
  while (from < force.values.size() && (force.values[from] > threshold) != is_above) ++from;
  return from;
}

}  // namespace

ImpactPulse first_pulse(const Series& force, const std::optional<double>& contact_s) {
  std::size_t first = 0;
  while (contact_s && first + 1 < force.values.size() && force.times_s[first + 1] <= *contact_s) {
    ++first;
  }
  const double largest_N =
      force.values.empty()
          ? 0.0
          : *std::max_element(force.values.begin() + static_cast<std::ptrdiff_t>(first),
                              force.values.end());
  if (!(largest_N > 0.0)) {
    throw std::invalid_argument(force.values.empty()
                                    ? "the force has no samples"
                                    : fmt::format("the force is never positive from {} to {} s",
                                                  force.times_s.front(), force.times_s.back()));
  }
  const double threshold = kContactShare * largest_N;
  const std::size_t rise = first_where(force, first, threshold, true);
  const std::size_t fall = first_where(force, rise, threshold, false);
  if (rise == 0) throw std::invalid_argument("the force begins in contact");
  ImpactPulse pulse;
  pulse.begin_s = rise > first ? crossing_s(force, rise, threshold) : force.times_s[first];
  if (fall < force.values.size()) {
    pulse.duration_s = crossing_s(force, fall, threshold) - pulse.begin_s;
  }
  for (std::size_t i = std::max(rise, first + 1); i <= fall && i < force.values.size(); ++i) {
    pulse.peak_N = std::max(pulse.peak_N, force.values[i]);
    pulse.impulse_Ns +=
        0.5 * (force.values[i - 1] + force.values[i]) * (force.times_s[i] - force.times_s[i - 1]);
  }
  return pulse;
}

Series read_measured_force(const std::string& file) {
  ColumnTable table = read_columns(file, {{"time_s"}, {"force_N"}});
  check_rising(file, table, table.columns[0], "time_s must rise");
  return {std::move(table.columns[0]), std::move(table.columns[1])};
}

}  // namespace breakwater
